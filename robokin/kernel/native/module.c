/* The native kernel as a module of Python: numpy arrays in, numpy arrays out, or plain numbers.

   Only for calls from robokin.kernel, which has seen to shapes and types: what is checked here keeps memory safe.
*/

#define ROBOKIN_MODULE

#include "module.h"

#ifdef ROBOKIN_AVX2
#include "cpu.h"
#endif

#include <string.h>

/* As robokin.kernel.native_module expects it. */
#define INTERFACE 10

/* Under which name a robot's facts hold its chain. */
#define KEPT_CHAIN "chain at once"

/* In the order of Lanes. */
#define LANES(name)                                                                                                    \
    {poses##name, frames##name, jacobians##name, errors##name, descended##name, corrected##name, gone_down##name,      \
     turned##name, advanced##name, least_values##name, refined##name, complex_refined##name, tracked##name,            \
     regulars##name, shortest_of##name, finely_closed##name, followed_rows##name, solution##name, solutions##name, sides##name,        \
     prepared_elimination##name, eliminated##name, tried_candidates##name, listed_elimination##name}

static const Lanes base = LANES(_base);
#ifdef ROBOKIN_AVX2
static const Lanes avx2 = LANES(_avx2);
#endif

Lanes lanes;

static const char *in_use = "base";

static void freed(PyObject *capsule) { PyMem_Free(PyCapsule_GetPointer(capsule, CHAIN)); }

/* The handle of a chain: of n + 1 constants m, 4 rows of 4 each, of whether its joints turn, and of their offsets. */
static PyObject *built(int n, const double *m, const double *turning, const double *at) {
    Chain *made = PyMem_Malloc(sizeof(Chain));
    if (!made)
        return PyErr_NoMemory();
    memset(made, 0, sizeof(Chain));
    made->n = n;
    for (int i = 0; i <= n; i++, m += 16) {
        double *out = i ? made->links[i - 1].m : made->first;
        for (int c = 0; c < 4; c++)
            for (int r = 0; r < 3; r++)
                out[3 * c + r] = m[4 * r + c];
        if (!i)
            continue;
        Constant *link = &made->links[i - 1];
        made->revolute[i - 1] = turning[i - 1] != 0.0;
        made->offsets[i - 1] = at[i - 1];
        link->shifts = out[9] != 0.0 || out[10] != 0.0 || out[11] != 0.0;
        for (int j = 0; j < 9; j++)
            link->turns |= out[j] != (j % 4 ? 0.0 : 1.0);
    }
    PyObject *capsule = PyCapsule_New(made, CHAIN, freed);
    if (!capsule)
        PyMem_Free(made);
    return capsule;
}

static PyObject *chain(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[3];
    PyArrayObject *C, *revolute, *offsets;
    (void)self;
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "chain(constants, revolute, offsets)");
        return NULL;
    }
    PyObject *capsule = NULL;
    copies[1] = copies[2] = NULL;
    C = doubles(args[0], 3, &copies[0]);
    revolute = C ? doubles(args[1], 1, &copies[1]) : NULL;
    offsets = revolute ? doubles(args[2], 1, &copies[2]) : NULL;
    if (!offsets)
        goto end;
    npy_intp n = PyArray_DIM(revolute, 0);
    if (n < 1 || n > MOST_JOINTS || PyArray_SIZE(revolute) != n || PyArray_SIZE(offsets) != n ||
        PyArray_SIZE(C) != 16 * (n + 1)) {
        PyErr_SetString(PyExc_ValueError, "arrays of a chain do not fit each other");
        goto end;
    }
    capsule = built((int)n, PyArray_DATA(C), PyArray_DATA(revolute), PyArray_DATA(offsets));
end:
    let_go(copies, 3);
    return capsule;
}

/* The array that a caller gives for the answer, or a new one, of q's leading shape and `more` dimensions. */
static PyObject *answer(PyObject *given, PyArrayObject *q, int more, const npy_intp *shape) {
    if (!given)
        return empty(q, more, shape);
    npy_intp size = rows(q);
    for (int i = 0; i < more; i++)
        size *= shape[i];
    PyArrayObject *out = (PyArrayObject *)given;
    if (!PyArray_Check(given) || PyArray_TYPE(out) != NPY_DOUBLE || PyArray_SIZE(out) != size ||
        !PyArray_ISCARRAY(out)) {
        PyErr_SetString(PyExc_ValueError, "expected an array for the answer that is as large as it");
        return NULL;
    }
    Py_INCREF(given);
    return given;
}

/* The frames that joints start from and the tool's, or the tool's alone. */
static PyObject *led_to(PyObject *const *args, Py_ssize_t count, int every) {
    PyArrayObject *q;
    PyObject *copy, *out = NULL;
    const Chain *known = count == 2 || count == 3 ? asked(args[0], args[1], &q, &copy) : NULL;
    if (!known) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "expected a chain and joint values");
        return NULL;
    }
    const npy_intp shape[] = {known->n + 1, 4, 4};
    npy_intp m = rows(q);
    PyObject *given = count == 3 ? args[2] : NULL;
    out = every ? answer(given, q, 3, shape) : answer(given, q, 2, shape + 1);
    if (out) {
        void (*run)(const Chain *, const double *, ptrdiff_t, double *) = every ? lanes.frames : lanes.poses;
        double *to = PyArray_DATA((PyArrayObject *)out);
        const double *from = PyArray_DATA(q);
        if (m < LONG) {
            run(known, from, m, to);
        } else {
            Py_BEGIN_ALLOW_THREADS
            run(known, from, m, to);
            Py_END_ALLOW_THREADS
        }
    }
    Py_XDECREF(copy);
    return out;
}

static PyObject *pose(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    return led_to(args, count, 0);
}

static PyObject *frames(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    return led_to(args, count, 1);
}

static PyObject *jacobian(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyArrayObject *q;
    PyObject *copy, *out = NULL;
    (void)self;
    int asks = count == 4 || count == 5;
    /* Numbers first: their methods may change the arrays. */
    double size = asks ? PyFloat_AsDouble(args[2]) : 0.0;
    int tool = asks && !PyErr_Occurred() ? PyObject_IsTrue(args[3]) : 0;
    const Chain *known = asks && !PyErr_Occurred() ? asked(args[0], args[1], &q, &copy) : NULL;
    if (!known) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "jacobian(chain, q, size, tool[, out])");
        return NULL;
    }
    const npy_intp shape[] = {6, known->n};
    npy_intp m = rows(q);
    out = answer(count == 5 ? args[4] : NULL, q, 2, shape);
    if (out) {
        double *to = PyArray_DATA((PyArrayObject *)out);
        const double *from = PyArray_DATA(q);
        if (m < LONG) {
            lanes.jacobians(known, from, m, size, tool, to);
        } else {
            Py_BEGIN_ALLOW_THREADS
            lanes.jacobians(known, from, m, size, tool, to);
            Py_END_ALLOW_THREADS
        }
    }
    Py_XDECREF(copy);
    return out;
}

static PyObject *errors(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyArrayObject *q, *T = NULL;
    PyObject *copy, *copy_of_T = NULL, *error = NULL, *J = NULL, *both = NULL;
    (void)self;
    double size = count == 4 ? PyFloat_AsDouble(args[3]) : 0.0;
    const Chain *known = count == 4 && !PyErr_Occurred() ? asked(args[0], args[2], &q, &copy) : NULL;
    if (!known) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "errors(chain, T, q, size)");
        return NULL;
    }
    npy_intp m = rows(q);
    T = doubles(args[1], 2, &copy_of_T);
    if (!T)
        goto end;
    if (PyArray_SIZE(T) % 16 || PyArray_SIZE(T) / 16 != m) {
        PyErr_SetString(PyExc_ValueError, "expected a target for each row of joint values");
        goto end;
    }
    const npy_intp six[] = {6}, shape[] = {6, known->n};
    error = empty(q, 1, six);
    J = error ? empty(q, 2, shape) : NULL;
    if (!J)
        goto end;
    double *e = PyArray_DATA((PyArrayObject *)error), *to = PyArray_DATA((PyArrayObject *)J);
    const double *wish = PyArray_DATA(T), *from = PyArray_DATA(q);
    if (m < LONG) {
        lanes.errors(known, wish, from, m, size, e, to);
    } else {
        Py_BEGIN_ALLOW_THREADS
        lanes.errors(known, wish, from, m, size, e, to);
        Py_END_ALLOW_THREADS
    }
    both = PyTuple_Pack(2, error, J);
end:
    Py_XDECREF(error);
    Py_XDECREF(J);
    Py_XDECREF(copy);
    Py_XDECREF(copy_of_T);
    return both;
}

/* The chain that is kept with a robot (`at_once.py`), borrowed; NULL, without an error, for what has none. */
static const Chain *kept(PyObject *robot) {
    static PyObject *facts_name = NULL, *key = NULL;
    const Chain *known = NULL;
    if (!key && (!(facts_name = PyUnicode_InternFromString("_facts")) ||
                 !(key = PyUnicode_InternFromString(KEPT_CHAIN)))) {
        PyErr_Clear();
        return NULL;
    }
    PyObject *facts = PyObject_GetAttr(robot, facts_name);
    if (facts && PyDict_Check(facts)) {
        PyObject *capsule = PyDict_GetItemWithError(facts, key);
        if (capsule)
            known = PyCapsule_GetPointer(capsule, CHAIN);
    }
    /* The robot keeps its facts, and they the chain. */
    Py_XDECREF(facts);
    if (!known)
        PyErr_Clear();
    return known;
}

/* The joint values of a plain call: those of an array, or of a list of floats, which are put into `row`; NULL for what
   Python is to look at. `m` rows. */
static const double *plain_values(const Chain *chain, PyObject *object, double *row, npy_intp *m) {
    *m = 1;
    if (PyArray_CheckExact(object)) {
        PyArrayObject *q = (PyArrayObject *)object;
        int last = PyArray_NDIM(q) - 1;
        if (last < 0 || PyArray_TYPE(q) != NPY_DOUBLE || PyArray_DIM(q, last) != chain->n ||
            !PyArray_ISCARRAY_RO(q))
            return NULL;
        *m = rows(q);
        return PyArray_DATA(q);
    }
    if (!PyList_CheckExact(object) || PyList_Size(object) != chain->n)
        return NULL;
    for (int i = 0; i < chain->n; i++) {
        PyObject *number = PyList_GetItem(object, i);
        if (!PyFloat_CheckExact(number))
            return NULL;
        row[i] = PyFloat_AsDouble(number);
    }
    return row;
}

/* The empty answer of a plain call: q's leading shape, or none of a list, and `more` dimensions. */
static PyObject *plain_answer(PyObject *object, const double *q, const double *row, int more, const npy_intp *shape) {
    return q == row ? PyArray_EMPTY(more, shape, NPY_DOUBLE, 0) : empty((PyArrayObject *)object, more, shape);
}

static PyObject *pose_at_once(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    double row[MOST_JOINTS];
    npy_intp m;
    (void)self;
    const Chain *known = count == 2 && PyArray_API ? kept(args[0]) : NULL;
    const double *q = known ? plain_values(known, args[1], row, &m) : NULL;
    if (!q || m >= LONG)
        Py_RETURN_NONE;
    const npy_intp shape[] = {4, 4};
    PyObject *out = plain_answer(args[1], q, row, 2, shape);
    if (out)
        lanes.poses(known, q, m, PyArray_DATA((PyArrayObject *)out));
    return out;
}

static PyObject *jacobian_at_once(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    double row[MOST_JOINTS];
    npy_intp m;
    (void)self;
    const Chain *known = count == 2 && PyArray_API ? kept(args[0]) : NULL;
    const double *q = known ? plain_values(known, args[1], row, &m) : NULL;
    if (!q || m >= LONG)
        Py_RETURN_NONE;
    const npy_intp shape[] = {6, known->n};
    PyObject *out = plain_answer(args[1], q, row, 2, shape);
    if (out)
        lanes.jacobians(known, q, m, 1.0, 0, PyArray_DATA((PyArrayObject *)out));
    return out;
}

/* `count` numbers of a tuple of floats; 0 and an error for anything else. */
static int numbers(PyObject *tuple, Py_ssize_t count, double *out) {
    if (!PyTuple_CheckExact(tuple) || PyTuple_Size(tuple) != count) {
        PyErr_SetString(PyExc_ValueError, "expected a tuple of another length");
        return 0;
    }
    for (Py_ssize_t i = 0; i < count; i++) {
        PyObject *number = PyTuple_GetItem(tuple, i);
        if (!PyFloat_CheckExact(number)) {
            PyErr_SetString(PyExc_TypeError, "expected floats");
            return 0;
        }
        out[i] = PyFloat_AsDouble(number);
    }
    return 1;
}

static PyObject *plain_chain(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    double constants[16 * (MOST_JOINTS + 1)], turning[MOST_JOINTS], offsets[MOST_JOINTS];
    Py_ssize_t n = count == 3 && PyTuple_CheckExact(args[1]) ? PyTuple_Size(args[1]) : 0;
    (void)self;
    if (n < 1 || n > MOST_JOINTS) {
        PyErr_SetString(PyExc_ValueError, "plain_chain(constants, revolute, offsets)");
        return NULL;
    }
    if (!numbers(args[0], 16 * (n + 1), constants) || !numbers(args[1], n, turning) || !numbers(args[2], n, offsets))
        return NULL;
    return built((int)n, constants, turning, offsets);
}

static PyObject *plain_pose(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    double q[MOST_JOINTS], T[16];
    const Chain *known = count == 2 ? PyCapsule_GetPointer(args[0], CHAIN) : NULL;
    (void)self;
    if (!known) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "plain_pose(chain, q)");
        return NULL;
    }
    if (!numbers(args[1], known->n, q))
        return NULL;
    lanes.poses(known, q, 1, T);
    PyObject *out = PyTuple_New(12);
    for (int i = 0; out && i < 12; i++) {
        PyObject *number = PyFloat_FromDouble(T[i]);
        if (!number || PyTuple_SetItem(out, i, number) < 0)
            Py_CLEAR(out);
    }
    return out;
}

/* Until it is called the functions of arrays refuse: who has numbers alone need not wait for numpy. */
static PyObject *with_arrays(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self, (void)args, (void)count;
    if (!PyArray_API && _import_array() < 0) {
        PyErr_Clear();
        PyErr_SetString(PyExc_ImportError, "the native kernel needs another numpy");
        return NULL;
    }
    Py_RETURN_NONE;
}

/* The instructions that are used, "base" or "avx2"; another set from now on if its name is given, as tests do. */
static PyObject *instructions(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    if (count && args[0] != Py_None) {
        PyObject *text = PyUnicode_Check(args[0]) ? PyUnicode_AsUTF8String(args[0]) : NULL;
        const char *name = text ? PyBytes_AsString(text) : NULL;
        int known = name && !strcmp(name, "base");
        if (known) {
            lanes = base;
            in_use = "base";
        }
#ifdef ROBOKIN_AVX2
        else if (name && !strcmp(name, "avx2") && has_avx2()) {
            lanes = avx2;
            in_use = "avx2";
            known = 1;
        }
#endif
        Py_XDECREF(text);
        if (!known) {
            PyErr_Clear();
            PyErr_SetString(PyExc_ValueError, "this machine has no such instructions");
            return NULL;
        }
    }
    return PyUnicode_FromString(in_use);
}

static PyMethodDef methods[] = {
    {"instructions", (PyCFunction)(void (*)(void))instructions, METH_FASTCALL, "instructions(name=None): the set in use"},
    {"chain", (PyCFunction)(void (*)(void))chain, METH_FASTCALL, "chain(constants, revolute, offsets): a chain's handle"},
    {"pose", (PyCFunction)(void (*)(void))pose, METH_FASTCALL, "pose(chain, q[, out]): the tool's poses (..., 4, 4)"},
    {"frames", (PyCFunction)(void (*)(void))frames, METH_FASTCALL, "frames(chain, q[, out]): (..., n + 1, 4, 4)"},
    {"jacobian", (PyCFunction)(void (*)(void))jacobian, METH_FASTCALL, "jacobian(chain, q, size, tool[, out]): (..., 6, n)"},
    {"with_arrays", (PyCFunction)(void (*)(void))with_arrays, METH_FASTCALL, "with_arrays(): numpy is there from now on"},
    {"plain_chain", (PyCFunction)(void (*)(void))plain_chain, METH_FASTCALL, "plain_chain(constants, revolute, offsets)"},
    {"plain_pose", (PyCFunction)(void (*)(void))plain_pose, METH_FASTCALL, "plain_pose(chain, q): twelve numbers"},
    {"pose_at_once", (PyCFunction)(void (*)(void))pose_at_once, METH_FASTCALL, "pose_at_once(robot, q), or None"},
    {"jacobian_at_once", (PyCFunction)(void (*)(void))jacobian_at_once, METH_FASTCALL,
     "jacobian_at_once(robot, q), or None"},
    {"errors", (PyCFunction)(void (*)(void))errors, METH_FASTCALL, "errors(chain, T, q, size): (..., 6), (..., 6, n)"},
    {NULL, NULL, 0, NULL},
};

/* The methods of other files. */
static PyMethodDef *const more_methods[] = {
    closed_form_methods,
    curve_methods,
    descent_methods,
    elimination_methods,
    number_text_methods,
    solution_object_methods,
    swivel_methods,
    told_apart_methods,
    NULL,
};

static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, "_native", "The native kernel.", -1, methods,
                                    NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__native(void) {
    lanes = base;
#ifdef ROBOKIN_AVX2
    if (has_avx2()) {
        lanes = avx2;
        in_use = "avx2";
    }
#endif
    PyObject *made = PyModule_Create(&module);
    for (int i = 0; made && more_methods[i]; i++)
        if (PyModule_AddFunctions(made, more_methods[i]) < 0)
            Py_CLEAR(made);
    if (made && (PyModule_AddIntConstant(made, "interface", INTERFACE) < 0 ||
                 PyModule_AddIntConstant(made, "most_joints", MOST_JOINTS) < 0 ||
                 PyModule_AddIntConstant(made, "most_moved", MOST_MOVED) < 0 ||
                 PyModule_AddIntConstant(made, "most_slots", MOST_SLOTS) < 0 ||
                 PyModule_AddIntConstant(made, "most_roots", MOST_ROOTS) < 0 ||
                 PyModule_AddStringConstant(made, "sources", ROBOKIN_SOURCES) < 0))
        Py_CLEAR(made);
    return made;
}
