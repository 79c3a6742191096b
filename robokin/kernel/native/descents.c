/* Newton's steps for blocks of starts, and paths of a homotopy, as methods of the module. */

#include "module.h"

#include <stdlib.h>
#include <string.h>

/* Steps of a call at most, and of a correction: callers want 500 and 40. Whatever the numbers are they soon end. */
#define MOST_STEPS_ASKED 1000
#define MOST_CORRECTION_STEPS 100

/* A chain that is a loop of six joints. */
static const Chain *loop(PyObject *capsule) {
    const Chain *known = PyCapsule_GetPointer(capsule, CHAIN);
    if (known && known->n != 6) {
        PyErr_SetString(PyExc_ValueError, "expected a loop of six joints");
        return NULL;
    }
    return known;
}

/* The number of steps of a call; -1 and an error where it is none. */
static int steps_of(PyObject *object) {
    long steps = PyLong_AsLong(object);
    if (steps == -1 && PyErr_Occurred())
        return -1;
    if (steps < 0 || steps > MOST_STEPS_ASKED) {
        PyErr_SetString(PyExc_ValueError, "expected a number of steps");
        return -1;
    }
    return (int)steps;
}

/* Whether numbers are from 0 to `most`; an error where one is not. */
static int are_within(const double *numbers, npy_intp m, double most) {
    for (npy_intp k = 0; k < m; k++)
        if (!(numbers[k] >= 0.0 && numbers[k] <= most)) {
            PyErr_SetString(PyExc_ValueError, "expected a number of steps");
            return 0;
        }
    return 1;
}

/* Newton's steps on a loop, of real values or complex ones. */
static PyObject *on_loop(PyObject *const *args, int is_complex) {
    PyObject *copies[2] = {NULL, NULL}, *values = NULL, *off = NULL, *both = NULL;
    double longest = is_complex ? PyFloat_AsDouble(args[4]) : 0.0;
    int steps = PyErr_Occurred() ? -1 : steps_of(args[3]);
    const Chain *known = steps < 0 ? NULL : loop(args[0]);
    npy_intp m = -1;
    if (!known)
        return NULL;
    const Given given[] = {{1, is_complex ? 32 : 16, &m}, {2, is_complex ? 12 : 6, &m}};
    const double *from[2];
    if (!all_tables(args, given, 2, from, copies))
        goto end;
    for (int i = 0; !is_complex && i < 6; i++)
        if (!known->revolute[i]) {
            PyErr_SetString(PyExc_ValueError, "expected a loop of turning joints");
            goto end;
        }
    values = new_numbers(m, is_complex ? 12 : 6);
    off = values ? new_numbers(m, is_complex ? 0 : 2) : NULL;
    if (!off)
        goto end;
    double *to = numbers_of(values), *left = numbers_of(off);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[1], (size_t)m * (is_complex ? 12 : 6) * sizeof(double));
    if (is_complex)
        lanes.complex_refined(known, from[0], to, m, steps, longest, left);
    else
        lanes.refined(known, from[0], to, m, steps, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, values, off);
end:
    Py_XDECREF(values);
    Py_XDECREF(off);
    let_go(copies, 2);
    return both;
}

static PyObject *refined(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    if (count == 4)
        return on_loop(args, 0);
    PyErr_SetString(PyExc_TypeError, "refined(loop, closing, values, steps)");
    return NULL;
}

static PyObject *complex_refined(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    if (count == 5)
        return on_loop(args, 1);
    PyErr_SetString(PyExc_TypeError, "complex_refined(loop, closing, values, steps, longest)");
    return NULL;
}

static PyObject *tracked(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    const double *from[4];
    PyObject *copies[4] = {NULL, NULL, NULL, NULL}, *values = NULL, *left = NULL, *both = NULL;
    (void)self;
    if (count != 5) {
        PyErr_SetString(PyExc_TypeError, "tracked(loop, start, target, bend, values)");
        return NULL;
    }
    const Chain *known = loop(args[0]);
    npy_intp m = -1;
    if (!known)
        return NULL;
    const Given given[] = {{1, 14, &m}, {2, 14, &m}, {3, 2, &m}, {4, 12, &m}};
    if (!all_tables(args, given, 4, from, copies))
        goto end;
    values = new_numbers(m, 12);
    left = values ? new_numbers(m, 3) : NULL;
    if (!left)
        goto end;
    double *to = numbers_of(values), *ends = numbers_of(left);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[3], (size_t)m * 12 * sizeof(double));
    lanes.tracked(known, from[0], from[1], from[2], m, to, ends);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, values, left);
end:
    let_go(copies, 4);
    Py_XDECREF(values);
    Py_XDECREF(left);
    return both;
}

/* A chain that is short enough for steps. */
static const Chain *moved_chain(PyObject *capsule) {
    const Chain *known = PyCapsule_GetPointer(capsule, CHAIN);
    if (known && known->n > MOST_MOVED) {
        PyErr_SetString(PyExc_ValueError, "expected a chain of fewer joints");
        return NULL;
    }
    return known;
}

static PyObject *descended(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[5] = {NULL, NULL, NULL, NULL, NULL}, *x = NULL, *error = NULL, *both = NULL;
    (void)self;
    if (count != 8) {
        PyErr_SetString(PyExc_TypeError, "descended(chain, T, far, x, size, low, high, steps)");
        return NULL;
    }
    double size = PyFloat_AsDouble(args[4]);
    int steps = PyErr_Occurred() ? -1 : steps_of(args[7]);
    const Chain *known = steps < 0 ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    const Given given[] = {{1, 16, &m}, {2, 1, &m}, {3, n, &m}, {5, 1, &n}, {6, 1, &n}};
    const double *from[5];
    x = all_tables(args, given, 5, from, copies) ? new_numbers(m, n) : NULL;
    error = x ? new_numbers(m, 6) : NULL;
    if (!error)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(error);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[2], (size_t)(m * n) * sizeof(double));
    lanes.descended(known, from[0], from[1], to, m, size, from[3], from[4], steps, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, x, error);
end:
    let_go(copies, 5);
    Py_XDECREF(x);
    Py_XDECREF(error);
    return both;
}

static PyObject *shortest(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[2] = {NULL, NULL}, *dx = NULL;
    (void)self;
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "shortest(A, b, zero)");
        return NULL;
    }
    double zero = PyFloat_AsDouble(args[2]);
    PyArrayObject *A = PyErr_Occurred() ? NULL : doubles(args[0], 3, &copies[0]);
    PyArrayObject *b = A ? doubles(args[1], 2, &copies[1]) : NULL;
    if (!b)
        goto end;
    npy_intp m = PyArray_DIM(A, 0), rows = PyArray_DIM(A, 1), n = PyArray_DIM(A, 2);
    if (PyArray_NDIM(A) != 3 || PyArray_NDIM(b) != 2 || PyArray_DIM(b, 0) != m || PyArray_DIM(b, 1) != rows ||
        n > MOST_MOVED || rows > 7 || !n || !rows) {
        PyErr_SetString(PyExc_ValueError, "arrays of a descent do not fit each other");
        goto end;
    }
    dx = new_numbers(m, n);
    if (dx)
        lanes.shortest_of(PyArray_DATA(A), PyArray_DATA(b), m, (int)rows, (int)n, zero, numbers_of(dx));
end:
    let_go(copies, 2);
    return dx;
}

static PyObject *finely_closed(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[3] = {NULL, NULL, NULL}, *q = NULL, *error = NULL, *both = NULL;
    (void)self;
    if (count != 9) {
        PyErr_SetString(PyExc_TypeError, "finely_closed(chain, T, q, error, size, steps, longest, zero, enough)");
        return NULL;
    }
    int steps = steps_of(args[5]);
    double told[4];
    static const int places[] = {4, 6, 7, 8};
    for (int i = 0; i < 4 && !PyErr_Occurred(); i++)
        told[i] = PyFloat_AsDouble(args[places[i]]);
    const Chain *known = PyErr_Occurred() ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    const Given given[] = {{1, 16, &m}, {2, n, &m}, {3, 6, &m}};
    const double *from[3];
    q = all_tables(args, given, 3, from, copies) ? new_numbers(m, n) : NULL;
    error = q ? new_numbers(m, 6) : NULL;
    if (!error)
        goto end;
    memcpy(numbers_of(q), from[1], (size_t)(m * n) * sizeof(double));
    memcpy(numbers_of(error), from[2], (size_t)(m * 6) * sizeof(double));
    Py_BEGIN_ALLOW_THREADS
    lanes.finely_closed(known, from[0], numbers_of(q), m, told[0], steps, told[1], told[2], told[3], numbers_of(error));
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, q, error);
end:
    let_go(copies, 3);
    Py_XDECREF(q);
    Py_XDECREF(error);
    return both;
}

static PyObject *followed_rows(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[4] = {NULL, NULL, NULL, NULL}, *rows = NULL, *last = NULL, *all = NULL;
    (void)self;
    if (count != 9) {
        PyErr_SetString(PyExc_TypeError, "followed_rows(chain, T, x, ahead, limits, size, opened, spare, listed)");
        return NULL;
    }
    double size = PyFloat_AsDouble(args[5]);
    int opened = PyErr_Occurred() ? -1 : steps_of(args[6]);
    int spare = opened < 0 ? -1 : PyObject_IsTrue(args[7]), listed = spare < 0 ? -1 : PyObject_IsTrue(args[8]);
    const Chain *known = listed < 0 ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0, one = 1, four = 4;
    if (!known)
        return NULL;
    if (opened > n) {
        PyErr_SetString(PyExc_ValueError, "expected fewer open joints");
        return NULL;
    }
    const Given given[] = {{1, 16, &m}, {2, n, &one}, {3, n, &one}, {4, n, &four}};
    const double *from[4];
    rows = all_tables(args, given, 4, from, copies) ? new_numbers(m, n) : NULL;
    last = rows ? new_numbers(1, n) : NULL;
    if (!last)
        goto end;
    npy_intp followed = 0;
    memcpy(numbers_of(last), from[2], (size_t)n * sizeof(double));
    double *to = numbers_of(rows), *moved = numbers_of(last);
    Py_BEGIN_ALLOW_THREADS
    followed = lanes.followed_rows(known, from[0], m, size, opened, from[3], from[1], moved, spare, listed, to);
    Py_END_ALLOW_THREADS
    all = Py_BuildValue("nOO", (Py_ssize_t)followed, rows, last);
end:
    let_go(copies, 4);
    Py_XDECREF(rows);
    Py_XDECREF(last);
    return all;
}

static PyObject *gone_down(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[5] = {NULL, NULL, NULL, NULL, NULL}, *x = NULL, *parts = NULL, *both = NULL;
    (void)self;
    if (count != 10) {
        PyErr_SetString(PyExc_TypeError, "gone_down(chain, T, x, size, low, high, weight, steps, still, least)");
        return NULL;
    }
    double size = PyFloat_AsDouble(args[3]), still = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(args[8]);
    double least = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(args[9]);
    int steps = PyErr_Occurred() ? -1 : steps_of(args[7]);
    const Chain *known = steps < 0 ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    npy_intp bounds = -1; /* limits of each, or one row for all */
    const Given given[] = {{1, 12, &m}, {2, n, &m}, {4, n, &bounds}, {5, n, &bounds}, {6, 1, &m}};
    const double *from[5];
    if (!all_tables(args, given, 5, from, copies))
        goto end;
    if (bounds != 1 && bounds != m) {
        PyErr_SetString(PyExc_ValueError, "arrays of a descent do not fit each other");
        goto end;
    }
    x = new_numbers(m, n);
    parts = x ? new_numbers(m, 2) : NULL;
    if (!parts)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(parts);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[1], (size_t)(m * n) * sizeof(double));
    lanes.gone_down(known, from[0], to, m, size, from[2], from[3], bounds == m, from[4], steps, still, least, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, x, parts);
end:
    let_go(copies, 5);
    Py_XDECREF(x);
    Py_XDECREF(parts);
    return both;
}

static PyObject *turned(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[4] = {NULL, NULL, NULL, NULL}, *x = NULL, *parts = NULL, *both = NULL;
    (void)self;
    if (count != 7) {
        PyErr_SetString(PyExc_TypeError, "turned(chain, T, x, size, low, high, steps)");
        return NULL;
    }
    double size = PyFloat_AsDouble(args[3]);
    int steps = PyErr_Occurred() ? -1 : steps_of(args[6]);
    const Chain *known = steps < 0 ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    const Given given[] = {{1, 12, &m}, {2, n, &m}, {4, n, &m}, {5, n, &m}};
    const double *from[4];
    x = all_tables(args, given, 4, from, copies) ? new_numbers(m, n) : NULL;
    parts = x ? new_numbers(m, 2) : NULL;
    if (!parts)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(parts);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[1], (size_t)(m * n) * sizeof(double));
    lanes.turned(known, from[0], to, m, size, from[2], from[3], steps, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, x, parts);
end:
    let_go(copies, 4);
    Py_XDECREF(x);
    Py_XDECREF(parts);
    return both;
}

static PyObject *corrected(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[4] = {NULL, NULL, NULL, NULL}, *x = NULL, *off = NULL, *J = NULL, *all = NULL;
    (void)self;
    if (count != 9) {
        PyErr_SetString(PyExc_TypeError, "corrected(chain, T, normals, extra, most, x, size, settled, zero)");
        return NULL;
    }
    double size = PyFloat_AsDouble(args[6]), settled = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(args[7]);
    double zero = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(args[8]);
    int extra = PyErr_Occurred() ? -1 : steps_of(args[3]);
    const Chain *known = extra < 0 ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    if (extra > 1 + n) {
        PyErr_SetString(PyExc_ValueError, "expected fewer normals");
        return NULL;
    }
    const Given given[] = {{1, 16, &m}, {2, extra * n, &m}, {4, 1, &m}, {5, n, &m}};
    const double *from[4];
    if (!all_tables(args, given, 4, from, copies) || !are_within(from[2], m, MOST_CORRECTION_STEPS))
        goto end;
    x = new_numbers(m, n);
    off = x ? new_numbers(m, 0) : NULL;
    const npy_intp shape[] = {m, 6, n};
    J = off ? PyArray_EMPTY(3, shape, NPY_DOUBLE, 0) : NULL;
    if (!J)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(off), *jacobians = numbers_of(J);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[3], (size_t)(m * n) * sizeof(double));
    lanes.corrected(known, from[0], from[1], extra, from[2], to, m, size, settled, zero, left, jacobians);
    Py_END_ALLOW_THREADS
    all = PyTuple_Pack(3, x, off, J);
end:
    let_go(copies, 4);
    Py_XDECREF(x);
    Py_XDECREF(off);
    Py_XDECREF(J);
    return all;
}

static PyObject *advanced(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[7] = {NULL, NULL, NULL, NULL, NULL, NULL, NULL}, *parts[5] = {NULL, NULL, NULL, NULL, NULL};
    PyObject *all = NULL;
    Fronts F;
    void *space = NULL;
    int whole = 0;
    (void)self;
    memset(&F, 0, sizeof F);
    if (count != 10) {
        PyErr_SetString(PyExc_TypeError, "advanced(chain, T, most, low, high, state, closed, left, size, plain)");
        return NULL;
    }
    F.size = PyFloat_AsDouble(args[8]);
    F.plain_steps = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(args[9]);
    const Chain *known = PyErr_Occurred() ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    if (n > 7) {
        PyErr_SetString(PyExc_ValueError, "expected a chain of fewer joints");
        return NULL;
    }
    F.n = (int)n;
    const npy_intp wide = 3 * n + FRONT_NUMBERS, point = 2 + 2 * n;
    const Given of_fronts[] = {{1, 16, &m}, {2, 1, &m}, {3, n, &m}, {4, n, &m}, {5, wide, &m}};
    const double *from[5], *of_curves[2];
    if (!all_tables(args, of_fronts, 5, from, copies))
        goto end;
    npy_intp half = m / 2;
    const Given rest[] = {{6, 1, &half}, {7, 1, &half}};
    if (!all_tables(args, rest, 2, of_curves, copies + 5))
        goto end;
    const double *closed = of_curves[0], *left = of_curves[1];
    F.targets = from[0];
    F.steps_of = from[1];
    F.low = from[2];
    F.high = from[3];
    if (!are_within(left, half, MOST_STEPS_ASKED) || !are_within(F.steps_of, m, MOST_CORRECTION_STEPS))
        goto end;
    if (m % 2) {
        PyErr_SetString(PyExc_ValueError, "arrays of a descent do not fit each other");
        goto end;
    }
    F.s = half;
    const npy_intp widths_of[] = {wide, 0, 0, 0};
    double **places[] = {&F.state, &F.closed, &F.left, &F.waits};
    for (int i = 0; i < 4; i++) {
        if (!(parts[i] = new_numbers(i ? half : m, widths_of[i])))
            goto end;
        *places[i] = numbers_of(parts[i]);
    }
    memcpy(F.state, from[4], (size_t)(m * wide) * sizeof(double));
    memcpy(F.closed, closed, (size_t)half * sizeof(double));
    memcpy(F.left, left, (size_t)half * sizeof(double));
    /* Of each front: T, guess, led, normals, gaps, tangents, three numbers and J; and a row. */
    space = malloc((size_t)(m + 1) * ((size_t)(16 + 5 * n + 3 + 6 * n) * sizeof(double) + sizeof(ptrdiff_t)));
    if (!space) {
        PyErr_NoMemory();
        goto end;
    }
    double *next = space;
    double **room[] = {&F.T, &F.guess, &F.led, &F.normals, &F.gaps, &F.tangents, &F.most, &F.off, &F.seconds, &F.J};
    const npy_intp widths[] = {16, n, n, n, n, n, 1, 1, 1, 6 * n};
    for (int i = 0; i < 10; i++) {
        *room[i] = next;
        next += m * widths[i];
    }
    F.rows = (ptrdiff_t *)next;
    Py_BEGIN_ALLOW_THREADS
    whole = lanes.advanced(known, &F);
    Py_END_ALLOW_THREADS
    if (!whole) {
        PyErr_NoMemory();
        goto end;
    }
    if (!(parts[4] = new_numbers(F.used, point)))
        goto end;
    if (F.used)
        memcpy(numbers_of(parts[4]), F.history, (size_t)(F.used * point) * sizeof(double));
    all = PyTuple_Pack(5, parts[0], parts[1], parts[2], parts[3], parts[4]);
end:
    free(space);
    free(F.history);
    let_go(copies, 7);
    let_go(parts, 5);
    return all;
}

static PyObject *least_values(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *least = NULL;
    (void)self;
    if (count != 1) {
        PyErr_SetString(PyExc_TypeError, "least_values(J)");
        return NULL;
    }
    PyArrayObject *J = doubles(args[0], 3, &copy);
    if (!J)
        return NULL;
    npy_intp m = PyArray_DIM(J, 0), n = PyArray_DIM(J, 2);
    if (PyArray_NDIM(J) != 3 || PyArray_DIM(J, 1) != 6 || !n || n > MOST_MOVED)
        PyErr_SetString(PyExc_ValueError, "expected Jacobians (m, 6, n)");
    else if ((least = new_numbers(m, 0)))
        lanes.least_values(PyArray_DATA(J), m, (int)n, numbers_of(least));
    Py_XDECREF(copy);
    return least;
}

PyMethodDef descent_methods[] = {
    {"advanced", (PyCFunction)(void (*)(void))advanced, METH_FASTCALL,
     "advanced(chain, T, most, low, high, state, closed, left, size, plain): state, closed, left, waits, points"},
    {"descended", (PyCFunction)(void (*)(void))descended, METH_FASTCALL,
     "descended(chain, T, far, x, size, low, high, steps): values (m, n) and errors (m, 6)"},
    {"followed_rows", (PyCFunction)(void (*)(void))followed_rows, METH_FASTCALL,
     "followed_rows(chain, T, x, ahead, limits, size, opened, spare, listed): count, rows (m, n), the last move (1, n)"},
    {"gone_down", (PyCFunction)(void (*)(void))gone_down, METH_FASTCALL,
     "gone_down(chain, T, x, size, low, high, weight, steps, still, least): values (m, n) and f's parts (m, 2)"},
    {"turned", (PyCFunction)(void (*)(void))turned, METH_FASTCALL,
     "turned(chain, T, x, size, low, high, steps): values (m, n), and what is left as `gone_down` has it (m, 2)"},
    {"least_values", (PyCFunction)(void (*)(void))least_values, METH_FASTCALL, "least_values(J): (m,) of J (m, 6, n)"},
    {"corrected", (PyCFunction)(void (*)(void))corrected, METH_FASTCALL,
     "corrected(chain, T, normals, extra, most, x, size, settled, zero): (m, n), (m,), (m, 6, n)"},
    {"shortest", (PyCFunction)(void (*)(void))shortest, METH_FASTCALL, "shortest(A, b, zero): dx (m, n)"},
    {"finely_closed", (PyCFunction)(void (*)(void))finely_closed, METH_FASTCALL,
     "finely_closed(chain, T, q, error, size, steps, longest, zero, enough): q (m, n) and errors (m, 6)"},
    {"refined", (PyCFunction)(void (*)(void))refined, METH_FASTCALL,
     "refined(loop, closing, values, steps): values (m, 6) and what they lack (m, 2)"},
    {"complex_refined", (PyCFunction)(void (*)(void))complex_refined, METH_FASTCALL,
     "complex_refined(loop, closing, values, steps, longest): values (m, 12) and residuals (m,)"},
    {"tracked", (PyCFunction)(void (*)(void))tracked, METH_FASTCALL,
     "tracked(loop, start, target, bend, values): values (m, 12) and u, speed, lost (m, 3)"},
    {NULL, NULL, 0, NULL},
};
