/* Which solutions are told apart from others, and in which order they are listed, as methods of the module.

   Python's `verify.distinct_and_close` and `complex_newton.distinct` are the reference, and say what is derived how.
*/

#include "module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define FULL_TURN (2.0 * PI)

/* Targets of a call at most: their numbers are counted. */
#define MOST_TARGETS (1 << 24)

/* A row with what it is sorted by: a target, a key, a sum where keys are equal, and else its place. */
typedef struct {
    double key, sum;
    npy_intp target, place;
} Sorted;

/* Whether a number comes before another one; what is none comes last. */
static int before(double a, double b) { return a < b || (a == a && b != b); }

static int ordered(const void *first, const void *second) {
    const Sorted *a = first, *b = second;
    if (a->target != b->target)
        return a->target < b->target ? -1 : 1;
    if (before(a->key, b->key) || before(b->key, a->key))
        return before(a->key, b->key) ? -1 : 1;
    if (before(a->sum, b->sum) || before(b->sum, a->sum))
        return before(a->sum, b->sum) ? -1 : 1;
    return a->place < b->place ? -1 : a->place > b->place;
}

static PyObject *new_places(npy_intp m) { return PyArray_EMPTY(1, &m, NPY_INTP, 0); }

/* The targets (m,) of rows: whole numbers that can be counted. */
static const npy_intp *targets_of(PyObject *object, npy_intp *m, PyObject **copy) {
    *copy = PyArray_Check(object) ? PyArray_FROM_OTF(object, NPY_INTP, NPY_ARRAY_IN_ARRAY) : NULL;
    if (!*copy || PyArray_NDIM((PyArrayObject *)*copy) != 1) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "expected numbers of targets");
        return NULL;
    }
    *m = PyArray_DIM((PyArrayObject *)*copy, 0);
    const npy_intp *index = PyArray_DATA((PyArrayObject *)*copy);
    for (npy_intp i = 0; i < *m; i++)
        if (index[i] < 0 || index[i] >= MOST_TARGETS) {
            PyErr_SetString(PyExc_ValueError, "expected numbers of targets");
            return NULL;
        }
    return index;
}

/* A complex configuration without those that it equals: see `complex_newton.distinct`. */
static PyObject *each_once(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[5] = {NULL, NULL, NULL, NULL, NULL}, *mask = NULL;
    Sorted *rows = NULL;
    (void)self;
    if (count != 6) {
        PyErr_SetString(PyExc_TypeError, "each_once(turning, weights, index, values, apart, compared)");
        return NULL;
    }
    long compared = PyLong_AsLong(args[5]);
    npy_intp six = 6, three = 3, s = -1;
    const double *turning = PyErr_Occurred() ? NULL : table(args[0], 1, &six, &copies[0]);
    const double *weights = turning ? table(args[1], 6, &three, &copies[1]) : NULL;
    const npy_intp *index = weights ? targets_of(args[2], &s, &copies[2]) : NULL;
    const double *values = index ? table(args[3], 12, &s, &copies[3]) : NULL;
    const double *apart = values ? table(args[4], 1, &s, &copies[4]) : NULL;
    mask = apart ? PyArray_EMPTY(1, &s, NPY_BOOL, 0) : NULL;
    rows = mask ? malloc((size_t)(s + 1) * sizeof *rows) : NULL;
    if (!rows) {
        if (mask && !PyErr_Occurred())
            PyErr_NoMemory();
        Py_CLEAR(mask);
        goto end;
    }
    unsigned char *kept = PyArray_DATA((PyArrayObject *)mask);
    for (npy_intp k = 0; k < s; k++) {
        const double *z = values + 12 * k;
        double key = 0.0;
        for (int i = 0; i < 6; i++) {
            key += turning[i] != 0.0 ? sin(z[2 * i]) * weights[i] + cos(z[2 * i]) * weights[6 + i] : z[2 * i] * weights[i];
            key += z[2 * i + 1] * weights[12 + i];
        }
        rows[k] = (Sorted){key, 0.0, index[k], k};
        kept[k] = 1;
    }
    qsort(rows, (size_t)s, sizeof *rows, ordered);
    for (npy_intp k = 0; k < s; k++)
        for (npy_intp j = k + 1; j < s && j - k <= compared && rows[j].target == rows[k].target; j++) {
            const double *a = values + 12 * rows[k].place, *b = values + 12 * rows[j].place;
            double least = fmax(apart[rows[k].place], apart[rows[j].place]), greatest = 0.0;
            if (!(fabs(rows[j].key - rows[k].key) < 24.0 * least))
                continue;
            for (int i = 0; i < 6; i++) {
                double re = b[2 * i] - a[2 * i], im = b[2 * i + 1] - a[2 * i + 1];
                re -= turning[i] != 0.0 ? FULL_TURN * nearbyint(re / FULL_TURN) : 0.0;
                greatest = fmax(greatest, sqrt(re * re + im * im));
            }
            kept[rows[j].place] &= !(greatest < least);
        }
end:
    free(rows);
    let_go(copies, 5);
    return mask;
}

/* What `arranged` is told of solutions and of how they are compared. */
typedef struct {
    npy_intp n;
    const double *q, *off, *turning;
    double size, same, close, half_turn, off_centre;
    const double *cells, *weights;
    double whole;
} Compared;

/* Whether two solutions are the same. */
static int equal(const Compared *of_all, const double *a, const double *b) {
    for (npy_intp i = 0; i < of_all->n; i++) {
        double gap = fabs(a[i] - b[i]) / (of_all->turning[i] != 0.0 ? 1.0 : of_all->size);
        if (of_all->turning[i] != 0.0)
            gap = fmin(gap, FULL_TURN - gap);
        if (!(gap < of_all->same))
            return 0;
    }
    return 1;
}

static int rising(const void *first, const void *second) {
    double a = *(const double *)first, b = *(const double *)second;
    return before(a, b) ? -1 : before(b, a);
}

/* The key by which a configuration is listed, the sum that decides where keys are equal, and that of absolute values. */
static void keyed(const Compared *all, const double *q, double *key, double *sum, double *absolute) {
    *key = *sum = *absolute = 0.0;
    for (npy_intp i = 0; i < all->n; i++) {
        int turns = all->turning[i] != 0.0;
        double part = q[i] / (turns ? PI : all->size);
        *sum += all->weights[i] * part;
        *absolute += all->weights[i] * fabs(part);
        if (i < 4) {
            double half = 0.5 * (all->cells[i] - 1.0);
            part = (turns ? part : part < -1.0 ? -1.0 : part > 1.0 ? 1.0 : part) * half + (half + all->off_centre);
            *key = *key * all->cells[i] + nearbyint(part);
        }
    }
}

/* Which of a target's rows equal none that is more exact; how many do not. */
static npy_intp left_out(const Compared *all, const double *q, Sorted *rows, Sorted *space, npy_intp count,
                         unsigned char *kept) {
    npy_intp out = 0;
    for (npy_intp k = 0; k < count; k++)
        space[k] = (Sorted){all->off[rows[k].place], 0.0, 0, k};
    qsort(space, (size_t)count, sizeof *space, ordered);
    for (npy_intp k = 0; k < count; k++) {
        npy_intp row = space[k].place;
        kept[row] = 1;
        for (npy_intp j = 0; j < k && kept[row]; j++)
            if (kept[space[j].place] && equal(all, q + all->n * rows[row].place, q + all->n * rows[space[j].place].place))
                kept[row] = 0;
        out += !kept[row];
    }
    return out;
}

/* Solutions in the order of the list, each once: see `verify.distinct_and_close`. */
static PyObject *arranged(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[6] = {NULL}, *parts[4] = {NULL}, *wrapped = NULL, *all_parts = NULL;
    Sorted *rows = NULL, *space = NULL;
    double *sums = NULL;
    unsigned char *kept = NULL;
    (void)self;
    if (count != 8) {
        PyErr_SetString(PyExc_TypeError, "arranged(index, q, off, turning, size, cells, weights, thresholds)");
        return NULL;
    }
    Compared all = {0};
    npy_intp m = -1, four = 4, n = -1;
    all.size = PyFloat_AsDouble(args[4]);
    const npy_intp *index = PyErr_Occurred() ? NULL : targets_of(args[0], &m, &copies[0]);
    all.turning = index ? table(args[3], 1, &n, &copies[1]) : NULL;
    all.q = all.turning ? table(args[1], n, &m, &copies[2]) : NULL;
    all.off = all.q ? table(args[2], 1, &m, &copies[3]) : NULL;
    all.cells = all.off ? table(args[5], 1, &four, &copies[4]) : NULL;
    all.weights = all.cells ? table(args[6], 1, &n, &copies[5]) : NULL;
    if (!all.weights)
        goto end;
    if (!PyTuple_Check(args[7])) {
        PyErr_SetString(PyExc_TypeError, "expected a tuple of thresholds");
        goto end;
    }
    if (!PyArg_ParseTuple(args[7], "dddd", &all.same, &all.close, &all.half_turn, &all.off_centre))
        goto end;
    all.n = n;
    for (npy_intp i = 0; i < n; i++)
        all.whole += all.weights[i];
    rows = malloc((size_t)(m + 1) * sizeof *rows);
    space = malloc((size_t)(m + 1) * sizeof *space);
    sums = malloc((size_t)(m + 1) * sizeof *sums);
    kept = malloc((size_t)(m + 1));
    wrapped = new_numbers(m, n);
    if (!rows || !space || !sums || !kept || !wrapped) {
        if (!PyErr_Occurred())
            PyErr_NoMemory();
        goto end;
    }
    double *q = numbers_of(wrapped);
    for (npy_intp k = 0; k < m; k++) {
        for (npy_intp i = 0; i < n; i++) {
            double value = all.q[n * k + i];
            if (all.turning[i] != 0.0) {
                value = -2.0 * PI * nearbyint(value * (0.5 / PI)) + value;
                /* -180 degrees is 180 degrees. */
                value = value < all.half_turn - PI ? value + 2.0 * PI : value;
            }
            q[n * k + i] = value + 0.0;
        }
        keyed(&all, q + n * k, &rows[k].key, &rows[k].sum, &sums[k]);
        rows[k].target = index[k];
        rows[k].place = k;
    }
    qsort(rows, (size_t)m, sizeof *rows, ordered);
    npy_intp listed = 0, equals = 0, near = 0;
    /* Targets of which some are equal, or near to each other, are put down from both ends. */
    parts[1] = new_places(m);
    parts[2] = new_places(m);
    parts[0] = new_places(m);
    if (!parts[0] || !parts[1] || !parts[2])
        goto end;
    npy_intp *order = PyArray_DATA((PyArrayObject *)parts[0]);
    npy_intp *equal_ones = PyArray_DATA((PyArrayObject *)parts[1]), *close = PyArray_DATA((PyArrayObject *)parts[2]);
    for (npy_intp first = 0, last; first < m; first = last) {
        double gap = HUGE_VAL, *mine;
        npy_intp target = rows[first].target;
        for (last = first; last < m && rows[last].target == target; last++)
            kept[last] = 1;
        double few[64];
        mine = last - first <= 64 ? few : malloc((size_t)(last - first) * sizeof *mine);
        if (!mine) {
            PyErr_NoMemory();
            goto end;
        }
        for (npy_intp k = first; k < last; k++)
            mine[k - first] = sums[rows[k].place];
        qsort(mine, (size_t)(last - first), sizeof *mine, rising);
        for (npy_intp k = 1; k < last - first; k++)
            gap = fmin(gap, mine[k] - mine[k - 1]);
        if (mine != few)
            free(mine);
        if (gap < all.close)
            close[near++] = target;
        if (gap < all.same * all.whole && left_out(&all, q, rows + first, space, last - first, kept + first))
            equal_ones[equals++] = target;
        for (npy_intp k = first; k < last; k++)
            if (kept[k])
                order[listed++] = rows[k].place;
    }
    all_parts = Py_BuildValue("OOOOnnn", wrapped, parts[0], parts[1], parts[2], listed, equals, near);
end:
    free(rows);
    free(space);
    free(sums);
    free(kept);
    Py_XDECREF(wrapped);
    let_go(parts, 4);
    let_go(copies, 6);
    return all_parts;
}

/* Which complex values have singular values above what is needed: 1, 0, or -1 where these are to be worked out. */
static PyObject *regular(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[2] = {NULL, NULL}, *answer = NULL;
    npy_intp m = -1;
    (void)self;
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "regular(loop, values, needed)");
        return NULL;
    }
    const Chain *loop = PyCapsule_GetPointer(args[0], CHAIN);
    if (loop && loop->n != 6)
        PyErr_SetString(PyExc_ValueError, "expected a loop of six joints");
    const Given given[] = {{1, 12, &m}, {2, 1, &m}};
    const double *from[2];
    if (loop && loop->n == 6 && all_tables(args, given, 2, from, copies))
        answer = new_numbers(m, 0);
    if (answer)
        lanes.regulars(loop, from[0], from[1], m, numbers_of(answer));
    let_go(copies, 2);
    return answer;
}

PyMethodDef told_apart_methods[] = {
    {"each_once", (PyCFunction)(void (*)(void))each_once, METH_FASTCALL,
     "each_once(turning, weights, index, values, apart, compared): (s,) true for one of those that are equal"},
    {"arranged", (PyCFunction)(void (*)(void))arranged, METH_FASTCALL,
     "arranged(index, q, off, turning, size, cells, weights, thresholds): q, order, targets of equal and close ones"},
    {"regular", (PyCFunction)(void (*)(void))regular, METH_FASTCALL,
     "regular(loop, values, needed): 1, 0, or -1 where it is not known (m,)"},
    {NULL, NULL, 0, NULL},
};
