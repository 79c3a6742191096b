/* The arguments of calls, read, and new arrays for answers: see module.h.

   Shapes and types are looked at so far that memory is safe.
*/

#include "module.h"

/* numpy has no more, whatever its version. */
#define MOST_DIMENSIONS 64

PyArrayObject *doubles(PyObject *object, int least, PyObject **copy) {
    *copy = NULL;
    if (!PyArray_API) {
        PyErr_SetString(PyExc_RuntimeError, "with_arrays() comes first");
        return NULL;
    }
    if (!PyArray_Check(object)) {
        PyErr_SetString(PyExc_TypeError, "expected an array");
        return NULL;
    }
    PyArrayObject *array = (PyArrayObject *)object;
    if (PyArray_NDIM(array) < least) {
        PyErr_Format(PyExc_ValueError, "expected an array of at least %d dimensions, found one of %d", least,
                     PyArray_NDIM(array));
        return NULL;
    }
    if (PyArray_TYPE(array) == NPY_DOUBLE && PyArray_IS_C_CONTIGUOUS(array) && PyArray_ISALIGNED(array) &&
        PyArray_ISNOTSWAPPED(array))
        return array;
    *copy = PyArray_FROM_OTF(object, NPY_DOUBLE, NPY_ARRAY_IN_ARRAY | NPY_ARRAY_ENSUREARRAY);
    return (PyArrayObject *)*copy;
}

const double *table(PyObject *object, npy_intp width, npy_intp *m, PyObject **copy) {
    PyArrayObject *array = doubles(object, 1, copy);
    if (!array)
        return NULL;
    npy_intp size = PyArray_SIZE(array), count = PyArray_DIM(array, 0);
    if ((*m >= 0 && count != *m) || size != count * width) {
        PyErr_Format(PyExc_ValueError, "arrays do not fit each other: found %zd numbers in %zd rows, expected %zd a row%s",
                     (Py_ssize_t)size, (Py_ssize_t)count, (Py_ssize_t)width, *m < 0 ? "" : " and as many rows as before");
        return NULL;
    }
    *m = count;
    return PyArray_DATA(array);
}

int all_tables(PyObject *const *args, const Given *given, int count, const double **from, PyObject **copies) {
    for (int i = 0; i < count; i++)
        if (!(from[i] = table(args[given[i].place], given[i].width, given[i].rows, &copies[i])))
            return 0;
    return 1;
}

const double *targets(PyObject *object, npy_intp *m, PyObject **copy) {
    PyArrayObject *T = doubles(object, 3, copy);
    if (!T)
        return NULL;
    if (PyArray_NDIM(T) != 3 || PyArray_DIM(T, 1) != 4 || PyArray_DIM(T, 2) != 4) {
        PyErr_SetString(PyExc_ValueError, "expected targets (m, 4, 4)");
        return NULL;
    }
    *m = PyArray_DIM(T, 0);
    return PyArray_DATA(T);
}

void let_go(PyObject **objects, int count) {
    for (int i = 0; i < count; i++)
        Py_XDECREF(objects[i]);
}

const Chain *asked(PyObject *capsule, PyObject *object, PyArrayObject **q, PyObject **copy) {
    const Chain *known = PyCapsule_GetPointer(capsule, CHAIN);
    *copy = NULL;
    if (!known)
        return NULL;
    *q = doubles(object, 1, copy);
    if (!*q)
        return NULL;
    if (PyArray_DIM(*q, PyArray_NDIM(*q) - 1) != known->n) {
        PyErr_SetString(PyExc_ValueError, "expected a value for each joint in the last dimension");
        Py_XDECREF(*copy);
        *copy = NULL;
        return NULL;
    }
    return known;
}

PyObject *empty(PyArrayObject *q, int more, const npy_intp *shape) {
    npy_intp dims[MOST_DIMENSIONS];
    int before = PyArray_NDIM(q) - 1;
    if (before + more > MOST_DIMENSIONS) {
        PyErr_SetString(PyExc_ValueError, "too many dimensions");
        return NULL;
    }
    for (int i = 0; i < before; i++)
        dims[i] = PyArray_DIM(q, i);
    for (int i = 0; i < more; i++)
        dims[before + i] = shape[i];
    return PyArray_EMPTY(before + more, dims, NPY_DOUBLE, 0);
}

npy_intp rows(PyArrayObject *q) { return PyArray_SIZE(q) / PyArray_DIM(q, PyArray_NDIM(q) - 1); }

PyObject *new_numbers(npy_intp m, npy_intp width) {
    const npy_intp shape[] = {m, width};
    return PyArray_EMPTY(width ? 2 : 1, shape, NPY_DOUBLE, 0);
}

double *numbers_of(PyObject *array) { return PyArray_DATA((PyArrayObject *)array); }

static const int TABLE_TYPES[TABLES] = {NPY_BOOL, NPY_INTP, NPY_INTP, NPY_INTP, NPY_INTP,
                                        NPY_DOUBLE, NPY_DOUBLE, NPY_DOUBLE, NPY_BOOL};

int batch_tables(PyObject *given, npy_intp m, npy_intp rows, int joints, PyObject **made, void **at) {
    const npy_intp shape[] = {m, rows, joints};
    int fits = !given || (PyTuple_Check(given) && PyTuple_Size(given) == TABLES);
    for (int i = 0; fits && i < TABLES; i++) {
        int dimensions = i < VALUES ? 1 : i == VALUES ? 3 : 2;
        if (!given) {
            made[i] = PyArray_EMPTY(dimensions, shape, TABLE_TYPES[i], 0);
            if (!made[i])
                return 0;
        } else {
            made[i] = PyTuple_GetItem(given, i);
            Py_INCREF(made[i]);
            PyArrayObject *array = (PyArrayObject *)made[i];
            fits = PyArray_CheckExact(made[i]) && PyArray_TYPE(array) == TABLE_TYPES[i] &&
                   PyArray_NDIM(array) == dimensions && PyArray_ISCARRAY(array);
            for (int k = 0; fits && k < dimensions; k++)
                fits = PyArray_DIM(array, k) == shape[k];
        }
        if (fits)
            at[i] = PyArray_DATA((PyArrayObject *)made[i]);
    }
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "tables of a batch do not fit its targets");
    return fits;
}
