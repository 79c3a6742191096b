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

/* A new array (m, width), or (m,) where the width is 0. */
static PyObject *made(npy_intp m, npy_intp width) {
    const npy_intp shape[] = {m, width};
    return PyArray_EMPTY(width ? 2 : 1, shape, NPY_DOUBLE, 0);
}

static double *numbers_of(PyObject *array) { return PyArray_DATA((PyArrayObject *)array); }

/* Newton's steps on a loop, of real values or complex ones. */
static PyObject *on_loop(PyObject *const *args, int is_complex) {
    PyObject *copies[2] = {NULL, NULL}, *values = NULL, *off = NULL, *both = NULL;
    double longest = is_complex ? PyFloat_AsDouble(args[4]) : 0.0;
    int steps = PyErr_Occurred() ? -1 : steps_of(args[3]);
    const Chain *known = steps < 0 ? NULL : loop(args[0]);
    npy_intp m = -1;
    if (!known)
        return NULL;
    const double *closing = table(args[1], is_complex ? 32 : 16, &m, &copies[0]);
    const double *from = closing ? table(args[2], is_complex ? 12 : 6, &m, &copies[1]) : NULL;
    for (int i = 0; !is_complex && i < 6; i++)
        if (from && !known->revolute[i]) {
            PyErr_SetString(PyExc_ValueError, "expected a loop of turning joints");
            goto end;
        }
    values = from ? made(m, is_complex ? 12 : 6) : NULL;
    off = values ? made(m, is_complex ? 0 : 2) : NULL;
    if (!off)
        goto end;
    double *to = numbers_of(values), *left = numbers_of(off);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from, (size_t)m * (is_complex ? 12 : 6) * sizeof(double));
    if (is_complex)
        lanes.complex_refined(known, closing, to, m, steps, longest, left);
    else
        lanes.refined(known, closing, to, m, steps, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, values, off);
end:
    Py_XDECREF(values);
    Py_XDECREF(off);
    Py_XDECREF(copies[0]);
    Py_XDECREF(copies[1]);
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
    static const npy_intp widths[] = {14, 14, 2, 12};
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
    for (int i = 0; i < 4; i++)
        if (!(from[i] = table(args[1 + i], widths[i], &m, &copies[i])))
            goto end;
    values = made(m, 12);
    left = values ? made(m, 3) : NULL;
    if (!left)
        goto end;
    double *to = numbers_of(values), *ends = numbers_of(left);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from[3], (size_t)m * 12 * sizeof(double));
    lanes.tracked(known, from[0], from[1], from[2], m, to, ends);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, values, left);
end:
    for (int i = 0; i < 4; i++)
        Py_XDECREF(copies[i]);
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
    const double *T = table(args[1], 16, &m, &copies[0]), *far = T ? table(args[2], 1, &m, &copies[1]) : NULL;
    const double *from = far ? table(args[3], n, &m, &copies[2]) : NULL;
    const double *low = from ? table(args[5], 1, &n, &copies[3]) : NULL;
    const double *high = low ? table(args[6], 1, &n, &copies[4]) : NULL;
    x = high ? made(m, n) : NULL;
    error = x ? made(m, 6) : NULL;
    if (!error)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(error);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from, (size_t)(m * n) * sizeof(double));
    lanes.descended(known, T, far, to, m, size, low, high, steps, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, x, error);
end:
    for (int i = 0; i < 5; i++)
        Py_XDECREF(copies[i]);
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
    dx = made(m, n);
    if (dx)
        lanes.shortest_of(PyArray_DATA(A), PyArray_DATA(b), m, (int)rows, (int)n, zero, numbers_of(dx));
end:
    Py_XDECREF(copies[0]);
    Py_XDECREF(copies[1]);
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
    double given[4];
    static const int places[] = {4, 6, 7, 8};
    for (int i = 0; i < 4 && !PyErr_Occurred(); i++)
        given[i] = PyFloat_AsDouble(args[places[i]]);
    const Chain *known = PyErr_Occurred() ? NULL : moved_chain(args[0]);
    npy_intp m = -1, n = known ? known->n : 0;
    if (!known)
        return NULL;
    const double *T = table(args[1], 16, &m, &copies[0]), *from = T ? table(args[2], n, &m, &copies[1]) : NULL;
    const double *off = from ? table(args[3], 6, &m, &copies[2]) : NULL;
    q = off ? made(m, n) : NULL;
    error = q ? made(m, 6) : NULL;
    if (!error)
        goto end;
    memcpy(numbers_of(q), from, (size_t)(m * n) * sizeof(double));
    memcpy(numbers_of(error), off, (size_t)(m * 6) * sizeof(double));
    Py_BEGIN_ALLOW_THREADS
    lanes.finely_closed(known, T, numbers_of(q), m, given[0], steps, given[1], given[2], given[3], numbers_of(error));
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, q, error);
end:
    for (int i = 0; i < 3; i++)
        Py_XDECREF(copies[i]);
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
    const double *T = table(args[1], 16, &m, &copies[0]), *from = T ? table(args[2], n, &one, &copies[1]) : NULL;
    const double *ahead = from ? table(args[3], n, &one, &copies[2]) : NULL;
    const double *limits = ahead ? table(args[4], n, &four, &copies[3]) : NULL;
    rows = limits ? made(m, n) : NULL;
    last = rows ? made(1, n) : NULL;
    if (!last)
        goto end;
    npy_intp followed = 0;
    memcpy(numbers_of(last), ahead, (size_t)n * sizeof(double));
    double *to = numbers_of(rows), *moved = numbers_of(last);
    Py_BEGIN_ALLOW_THREADS
    followed = lanes.followed_rows(known, T, m, size, opened, limits, from, moved, spare, listed, to);
    Py_END_ALLOW_THREADS
    all = Py_BuildValue("nOO", (Py_ssize_t)followed, rows, last);
end:
    for (int i = 0; i < 4; i++)
        Py_XDECREF(copies[i]);
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
    const double *T = table(args[1], 12, &m, &copies[0]), *from = T ? table(args[2], n, &m, &copies[1]) : NULL;
    /* Limits of each, or one row for all. */
    npy_intp bounds = -1;
    const double *low = from ? table(args[4], n, &bounds, &copies[2]) : NULL;
    const double *high = low ? table(args[5], n, &bounds, &copies[3]) : NULL;
    if (high && bounds != 1 && bounds != m) {
        PyErr_SetString(PyExc_ValueError, "arrays of a descent do not fit each other");
        goto end;
    }
    const double *weight = high ? table(args[6], 1, &m, &copies[4]) : NULL;
    x = weight ? made(m, n) : NULL;
    parts = x ? made(m, 2) : NULL;
    if (!parts)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(parts);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from, (size_t)(m * n) * sizeof(double));
    lanes.gone_down(known, T, to, m, size, low, high, bounds == m, weight, steps, still, least, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, x, parts);
end:
    for (int i = 0; i < 5; i++)
        Py_XDECREF(copies[i]);
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
    const double *T = table(args[1], 12, &m, &copies[0]), *from = T ? table(args[2], n, &m, &copies[1]) : NULL;
    const double *low = from ? table(args[4], n, &m, &copies[2]) : NULL;
    const double *high = low ? table(args[5], n, &m, &copies[3]) : NULL;
    x = high ? made(m, n) : NULL;
    parts = x ? made(m, 2) : NULL;
    if (!parts)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(parts);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from, (size_t)(m * n) * sizeof(double));
    lanes.turned(known, T, to, m, size, low, high, steps, left);
    Py_END_ALLOW_THREADS
    both = PyTuple_Pack(2, x, parts);
end:
    for (int i = 0; i < 4; i++)
        Py_XDECREF(copies[i]);
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
    const double *T = table(args[1], 16, &m, &copies[0]), *normals = T ? table(args[2], extra * n, &m, &copies[1]) : NULL;
    const double *most = normals ? table(args[4], 1, &m, &copies[2]) : NULL;
    const double *from = most ? table(args[5], n, &m, &copies[3]) : NULL;
    if (from && !are_within(most, m, MOST_CORRECTION_STEPS))
        goto end;
    x = from ? made(m, n) : NULL;
    off = x ? made(m, 0) : NULL;
    const npy_intp shape[] = {m, 6, n};
    J = off ? PyArray_EMPTY(3, shape, NPY_DOUBLE, 0) : NULL;
    if (!J)
        goto end;
    double *to = numbers_of(x), *left = numbers_of(off), *jacobians = numbers_of(J);
    Py_BEGIN_ALLOW_THREADS
    memcpy(to, from, (size_t)(m * n) * sizeof(double));
    lanes.corrected(known, T, normals, extra, most, to, m, size, settled, zero, left, jacobians);
    Py_END_ALLOW_THREADS
    all = PyTuple_Pack(3, x, off, J);
end:
    for (int i = 0; i < 4; i++)
        Py_XDECREF(copies[i]);
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
    const npy_intp wide = 3 * n + FRONT_NUMBERS, point = 1 + 2 * n;
    F.targets = table(args[1], 16, &m, &copies[0]);
    F.steps_of = F.targets ? table(args[2], 1, &m, &copies[1]) : NULL;
    F.low = F.steps_of ? table(args[3], n, &m, &copies[2]) : NULL;
    F.high = F.low ? table(args[4], n, &m, &copies[3]) : NULL;
    const double *from = F.high ? table(args[5], wide, &m, &copies[4]) : NULL;
    npy_intp half = m / 2;
    const double *closed = from ? table(args[6], 1, &half, &copies[5]) : NULL;
    const double *left = closed ? table(args[7], 1, &half, &copies[6]) : NULL;
    if (!left)
        goto end;
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
        if (!(parts[i] = made(i ? half : m, widths_of[i])))
            goto end;
        *places[i] = numbers_of(parts[i]);
    }
    memcpy(F.state, from, (size_t)(m * wide) * sizeof(double));
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
    if (!(parts[4] = made(F.used, point)))
        goto end;
    if (F.used)
        memcpy(numbers_of(parts[4]), F.history, (size_t)(F.used * point) * sizeof(double));
    all = PyTuple_Pack(5, parts[0], parts[1], parts[2], parts[3], parts[4]);
end:
    free(space);
    free(F.history);
    for (int i = 0; i < 7; i++)
        Py_XDECREF(copies[i]);
    for (int i = 0; i < 5; i++)
        Py_XDECREF(parts[i]);
    return all;
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
