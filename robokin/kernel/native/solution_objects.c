/* Solutions as Python's objects, made of a table's rows: half a microsecond each becomes a few of the machine's steps.

   The class is Python's own, frozen there: fields are put where `object.__setattr__` puts them.
*/

#include "module.h"

#include <math.h>
#include <string.h>

/* After the joint values of a row: what is lacking of the target, and whether it is within the limits. */
#define TOLD 3

enum { ITS_Q, ITS_WITHIN, ITS_POSITION, ITS_ANGLE, ITS_NAME_LATER, ITS_FREE_LATER, ITS_FREE, FIELDS };

static PyObject *field[FIELDS];

static int fields_known(void) {
    static const char *const names[FIELDS] = {"q",     "within_limits", "position_error", "angle_error",
                                              "_name", "_free",         "free"};
    for (int i = 0; i < FIELDS; i++)
        if (!field[i] && !(field[i] = PyUnicode_InternFromString(names[i])))
            return 0;
    return 1;
}

/* What is asked for: copies, since making objects may run other code, which may change what was given. */
typedef struct {
    npy_intp count, joints, whole, width, first;
    npy_intp *rows;
    double *table, *pattern; /* pattern: held values, NaN where the table's follow, or NULL */
    PyObject *name, *free;
} Asked;

/* Set a field to a new reference, which is taken over. */
static int put(PyObject *object, int which, PyObject *value) {
    int done = value ? PyObject_GenericSetAttr(object, field[which], value) : -1;
    Py_XDECREF(value);
    return done == 0;
}

/* A function, and what it is asked. */
static PyObject *later(PyObject *find, npy_intp place) {
    PyObject *number = PyLong_FromSsize_t(place);
    PyObject *both = number ? PyTuple_Pack(2, find, number) : NULL;
    Py_XDECREF(number);
    return both;
}

static PyObject *joint_values(const Asked *asked, const double *row) {
    PyObject *q = PyArray_EMPTY(1, &asked->whole, NPY_DOUBLE, 0);
    if (!q)
        return NULL;
    double *to = PyArray_DATA((PyArrayObject *)q);
    if (!asked->pattern)
        memcpy(to, row, (size_t)asked->joints * sizeof(double));
    else
        for (npy_intp i = 0; i < asked->whole; i++)
            to[i] = isnan(asked->pattern[i]) ? *row++ : asked->pattern[i];
    return q;
}

/* Fill solution k of the answer. */
static int filled(PyObject *one, const Asked *asked, npy_intp k) {
    npy_intp place = asked->rows[k];
    const double *row = asked->table + place * asked->width, *told = row + asked->joints;
    if (!put(one, ITS_Q, joint_values(asked, row)) || !put(one, ITS_WITHIN, PyBool_FromLong(told[2] != 0.0)) ||
        !put(one, ITS_POSITION, PyFloat_FromDouble(told[0])) || !put(one, ITS_ANGLE, PyFloat_FromDouble(told[1])) ||
        !put(one, ITS_NAME_LATER, later(asked->name, asked->first + place)))
        return 0;
    if (PyTuple_CheckExact(asked->free)) {
        Py_INCREF(asked->free);
        return put(one, ITS_FREE, asked->free);
    }
    if (!PyList_CheckExact(asked->free))
        return put(one, ITS_FREE_LATER, later(asked->free, asked->first + place));
    PyObject *own = PyList_GetItem(asked->free, place);
    Py_XINCREF(own);
    return put(one, ITS_FREE, own);
}

/* The rows that are asked for, in their order; with `within` only those within the limits. */
static int chosen(Asked *asked, npy_intp all, PyObject *rows, int within) {
    npy_intp many = rows == Py_None ? all : PyList_CheckExact(rows) ? PyList_Size(rows) : -1;
    if (many < 0) {
        PyErr_SetString(PyExc_TypeError, "expected a list of rows, or None");
        return 0;
    }
    asked->rows = PyMem_Malloc((size_t)(many ? many : 1) * sizeof(npy_intp));
    if (!asked->rows) {
        PyErr_NoMemory();
        return 0;
    }
    asked->count = 0;
    for (npy_intp k = 0; k < many; k++) {
        npy_intp row = k;
        if (rows != Py_None) {
            PyObject *number = PyList_GetItem(rows, k);
            row = number && PyLong_CheckExact(number) ? PyLong_AsSsize_t(number) : -1;
            if (row < 0 || row >= all) {
                PyErr_Clear();
                PyErr_SetString(PyExc_IndexError, "expected numbers of rows");
                return 0;
            }
        }
        if (!within || asked->table[row * asked->width + asked->joints + 2] != 0.0)
            asked->rows[asked->count++] = row;
    }
    return 1;
}

/* The table (k, joints + 3 or more) and the pattern (whole) as copies. */
static int copied(Asked *asked, PyObject *table, PyObject *pattern, npy_intp *all) {
    PyObject *copies[2] = {NULL};
    PyArrayObject *from = doubles(table, 2, &copies[0]), *held = NULL;
    int fits = from != NULL;
    if (fits && pattern != Py_None) {
        held = doubles(pattern, 1, &copies[1]);
        fits = held != NULL;
    }
    if (fits) {
        npy_intp left = 0, size = PyArray_SIZE(from);
        *all = PyArray_DIM(from, 0);
        asked->width = PyArray_DIM(from, 1);
        asked->whole = held ? PyArray_SIZE(held) : asked->joints;
        for (npy_intp i = 0; held && i < asked->whole; i++)
            left += isnan(((const double *)PyArray_DATA(held))[i]);
        fits = PyArray_NDIM(from) == 2 && asked->joints >= 0 && asked->joints <= asked->width - TOLD &&
               (!held || (PyArray_NDIM(held) == 1 && left == asked->joints));
        if (!fits)
            PyErr_SetString(PyExc_ValueError, "a table of solutions does not fit");
        if (fits && !(asked->table = PyMem_Malloc((size_t)(size + (held ? asked->whole : 0) + 1) * sizeof(double)))) {
            PyErr_NoMemory();
            fits = 0;
        }
        if (fits)
            memcpy(asked->table, PyArray_DATA(from), (size_t)size * sizeof(double));
        if (fits && held) {
            asked->pattern = asked->table + size;
            memcpy(asked->pattern, PyArray_DATA(held), (size_t)asked->whole * sizeof(double));
        }
    }
    Py_XDECREF(copies[0]);
    Py_XDECREF(copies[1]);
    return fits;
}

/* Whether objects of a class are made by `object.__new__` alone. */
static newfunc maker_of(PyObject *type) {
    newfunc make = (newfunc)PyType_GetSlot(&PyBaseObject_Type, Py_tp_new);
    if (!PyType_Check(type) || !(PyType_GetFlags((PyTypeObject *)type) & Py_TPFLAGS_HEAPTYPE) ||
        (newfunc)PyType_GetSlot((PyTypeObject *)type, Py_tp_new) != make) {
        PyErr_SetString(PyExc_TypeError, "expected a plain class");
        return NULL;
    }
    return make;
}

/* solution_objects(kind, name, table, joints, free, rows, within, pattern, first): a tuple. */
static PyObject *solution_objects(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    Asked asked = {0};
    PyObject *made = NULL, *nothing = NULL;
    npy_intp all = 0;
    (void)self;
    if (count != 9) {
        PyErr_SetString(PyExc_TypeError,
                        "solution_objects(kind, name, table, joints, free, rows, within, pattern, first)");
        return NULL;
    }
    /* Numbers first: their methods may change what else is given. */
    asked.joints = PyLong_AsSsize_t(args[3]);
    int within = PyErr_Occurred() ? -1 : PyObject_IsTrue(args[6]);
    asked.first = within < 0 ? -1 : PyLong_AsSsize_t(args[8]);
    newfunc make = within < 0 || PyErr_Occurred() ? NULL : maker_of(args[0]);
    if (!make || !fields_known())
        return NULL;
    asked.name = args[1];
    asked.free = args[4];
    if (copied(&asked, args[2], args[7], &all) && chosen(&asked, all, args[5], within))
        made = PyTuple_New(asked.count);
    nothing = made ? PyTuple_New(0) : NULL;
    for (npy_intp k = 0; made && k < asked.count; k++) {
        PyObject *one = nothing ? make((PyTypeObject *)args[0], nothing, NULL) : NULL;
        if (one && !filled(one, &asked, k))
            Py_CLEAR(one);
        if (!one || PyTuple_SetItem(made, k, one) < 0)
            Py_CLEAR(made);
    }
    Py_XDECREF(nothing);
    PyMem_Free(asked.rows);
    PyMem_Free(asked.table);
    return made;
}

PyMethodDef solution_object_methods[] = {
    {"solution_objects", (PyCFunction)(void (*)(void))solution_objects, METH_FASTCALL,
     "solution_objects(kind, name, table, joints, free, rows, within, pattern, first): a tuple of solutions"},
    {NULL, NULL, 0, NULL},
};
