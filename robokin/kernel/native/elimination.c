/* The elimination of six turning joints as methods of the module: prepared once for an arm, asked for targets. */

#include "module.h"

#include "elimination.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What `elimination` wants of numbers: see `_numbers` in robokin.inverse.elimination.native_elimination. */
#define NUMBERS (12 + 3 + 12 * 21)

static void released(PyObject *capsule) { PyMem_Free(PyCapsule_GetPointer(capsule, ELIMINATION)); }

/* The next whole number of a list, 0 to most. */
static int whole(const double **next, int most, int *sound) {
    double value = *(*next)++;
    if (!(value >= 0.0 && value <= most) || value != (double)(int)value) {
        *sound = 0;
        return 0;
    }
    return (int)value;
}

/* The next rigid motion of a list: rows (3, 4). */
static const double *motion(const double *from, Motion *out) {
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            out->R[r][c] = from[4 * r + c];
        out->t[r] = from[4 * r + 3];
    }
    return from + 12;
}

/* The links as they follow each other in the loop, from J1 on: those of a chain of six joints without offsets. */
static const double *loop_of(const double *from, Chain *loop) {
    loop->n = 6;
    loop->first[0] = loop->first[4] = loop->first[8] = 1.0;
    for (int i = 0; i < 6; i++) {
        Motion link;
        Constant *to = &loop->links[i];
        loop->revolute[i] = 1;
        if (i == 5) {
            to->m[0] = to->m[4] = to->m[8] = 1.0;
            break;
        }
        from = motion(from, &link);
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++)
                to->m[3 * c + r] = link.R[r][c];
            to->m[9 + r] = link.t[r];
        }
        to->turns = to->shifts = 1;
    }
    return from;
}

static PyObject *elimination(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *capsule = NULL;
    (void)self;
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "elimination(chain, numbers)");
        return NULL;
    }
    const Chain *arm = PyCapsule_GetPointer(args[0], CHAIN);
    PyArrayObject *numbers = arm ? doubles(args[1], 1, &copy) : NULL;
    if (!numbers)
        return NULL;
    Elimination *made = PyMem_Malloc(sizeof(Elimination));
    if (!made) {
        PyErr_NoMemory();
        goto end;
    }
    memset(made, 0, sizeof(Elimination));
    int sound = PyArray_NDIM(numbers) == 1 && PyArray_SIZE(numbers) == NUMBERS && arm->n == 6, seen = 0;
    if (sound) {
        const double *next = PyArray_DATA(numbers);
        for (int i = 0; i < 6; i++) {
            made->joints[i] = whole(&next, 5, &sound);
            seen |= 1 << made->joints[i];
            sound &= arm->revolute[i];
        }
        made->backwards = whole(&next, 1, &sound);
        made->target = whole(&next, 5, &sound);
        made->free = whole(&next, 5, &sound);
        made->paired = whole(&next, 3, &sound);
        made->number = whole(&next, MOST_CANDIDATES, &sound);
        made->beside = whole(&next, 8, &sound);
        made->size = *next++;
        made->shift = *next++;
        made->imaginary = *next++;
        for (int i = 0; i < 6; i++)
            next = motion(next, &made->links[i]);
        for (int i = 0; i < 8; i++)
            next = motion(next, &made->away[i]);
        next = motion(next, &made->first);
        next = motion(next, &made->last);
        next = loop_of(next, &made->loop);
        for (int i = 0; i < NUMBERS; i++)
            sound &= isfinite(((const double *)PyArray_DATA(numbers))[i]) != 0;
        /* Rows of the pencil and its order: 4 of each pair, 2 of the rest. */
        sound &= seen == 63 && made->size > 0.0 && 6 - made->free - 2 * made->paired >= 0 && made->paired <= 4;
        sound &= 6 - made->free - made->paired <= 4 || !made->paired;
        sound &= 24 - 4 * (made->free + made->paired) > 0;
    }
    if (!sound) {
        PyErr_SetString(PyExc_ValueError, "numbers of an elimination do not fit each other");
        PyMem_Free(made);
        goto end;
    }
    made->arm = *arm;
    made->zero.R[0][0] = made->zero.R[1][1] = cos(made->shift);
    made->zero.R[1][0] = sin(made->shift);
    made->zero.R[0][1] = -made->zero.R[1][0];
    made->zero.R[2][2] = 1.0;
    lanes.prepared_elimination(made);
    capsule = PyCapsule_New(made, ELIMINATION, released);
    if (!capsule)
        PyMem_Free(made);
end:
    Py_XDECREF(copy);
    return capsule;
}

/* Answers are packed: of each target how many were tried, how many complex solutions are known, how many real ones and
   how many poses next door were asked; of each real solution the joint values and what it lacks. */
#define OF_TARGET 4
#define OF_SOLUTION 8

static void packed(const Eliminated *found, double *counts, double *to) {
    counts[0] = found->tried;
    counts[1] = found->number;
    counts[2] = found->count;
    counts[3] = found->looked;
    for (int k = 0; k < found->count; k++, to += OF_SOLUTION) {
        memcpy(to, found->q[k], sizeof found->q[k]);
        to[6] = found->position[k];
        to[7] = found->angle[k];
    }
}

static PyObject *eliminated(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *counts = NULL, *rows_of_all = NULL, *both = NULL;
    double *all = NULL;
    (void)self;
    const Elimination *known = count == 2 ? PyCapsule_GetPointer(args[0], ELIMINATION) : NULL;
    if (!known) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "eliminated(elimination, T)");
        return NULL;
    }
    PyArrayObject *T = doubles(args[1], 2, &copy);
    if (!T)
        return NULL;
    npy_intp m = PyArray_SIZE(T) / 16, used = 0, room = 0;
    if (PyArray_SIZE(T) % 16) {
        PyErr_SetString(PyExc_ValueError, "expected targets (m, 4, 4)");
        goto end;
    }
    const npy_intp shape[] = {m, OF_TARGET};
    counts = PyArray_EMPTY(2, shape, NPY_DOUBLE, 0);
    if (!counts)
        goto end;
    const double *from = PyArray_DATA(T);
    double *to = PyArray_DATA((PyArrayObject *)counts);
    int short_of_memory = 0;
    Py_BEGIN_ALLOW_THREADS
    for (npy_intp i = 0; i < m; i++) {
        Eliminated found;
        lanes.eliminated(known, from + 16 * i, &found);
        if (room - used < found.count) {
            npy_intp more = 2 * room + MOST_CANDIDATES;
            double *larger = realloc(all, (size_t)more * OF_SOLUTION * sizeof(double));
            if (!larger) {
                short_of_memory = 1;
                break;
            }
            all = larger;
            room = more;
        }
        packed(&found, to + OF_TARGET * i, all + OF_SOLUTION * used);
        used += found.count;
    }
    Py_END_ALLOW_THREADS
    if (short_of_memory) {
        PyErr_NoMemory();
        goto end;
    }
    const npy_intp size[] = {used, OF_SOLUTION};
    rows_of_all = PyArray_EMPTY(2, size, NPY_DOUBLE, 0);
    if (!rows_of_all)
        goto end;
    if (used)
        memcpy(PyArray_DATA((PyArrayObject *)rows_of_all), all, (size_t)used * OF_SOLUTION * sizeof(double));
    both = PyTuple_Pack(2, counts, rows_of_all);
end:
    free(all);
    Py_XDECREF(copy);
    Py_XDECREF(counts);
    Py_XDECREF(rows_of_all);
    return both;
}

/* Rows of some width that grow in number. */
typedef struct {
    double *rows;
    npy_intp used, room, width;
} Growing;

/* Whether there is room for as many rows as a target may have candidates. */
static int has_room(Growing *list) {
    if (list->room - list->used >= MOST_CANDIDATES)
        return 1;
    npy_intp more = 2 * list->room + 8 * MOST_CANDIDATES;
    double *larger = realloc(list->rows, (size_t)(more * list->width) * sizeof(double));
    if (!larger)
        return 0;
    list->rows = larger;
    list->room = more;
    return 1;
}

/* The rows as an array. */
static PyObject *array_of(const Growing *list) {
    const npy_intp shape[] = {list->used, list->width};
    PyObject *array = PyArray_EMPTY(2, shape, NPY_DOUBLE, 0);
    if (array && list->used)
        memcpy(PyArray_DATA((PyArrayObject *)array), list->rows,
               (size_t)(list->used * list->width) * sizeof(double));
    return array;
}

static PyObject *candidates(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *counts = NULL, *real = NULL, *pairs = NULL, *all = NULL;
    Growing of_reals = {NULL, 0, 0, 6}, of_pairs = {NULL, 0, 0, 12};
    (void)self;
    const Elimination *known = count == 2 ? PyCapsule_GetPointer(args[0], ELIMINATION) : NULL;
    npy_intp m = 0;
    const double *from = known ? targets(args[1], &m, &copy) : NULL;
    if (!from) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "candidates(elimination, closing)");
        goto end;
    }
    const npy_intp shape[] = {m, 2};
    counts = PyArray_EMPTY(2, shape, NPY_DOUBLE, 0);
    if (!counts)
        goto end;
    double *to = PyArray_DATA((PyArrayObject *)counts);
    int short_of_memory = 0;
    Py_BEGIN_ALLOW_THREADS
    for (npy_intp i = 0; i < m; i++) {
        int found[2];
        if (!has_room(&of_reals) || !has_room(&of_pairs)) {
            short_of_memory = 1;
            break;
        }
        lanes.tried_candidates(known, from + 16 * i, found, of_reals.rows + 6 * of_reals.used,
                               of_pairs.rows + 12 * of_pairs.used);
        of_reals.used += found[0];
        of_pairs.used += found[1];
        to[2 * i] = found[0];
        to[2 * i + 1] = found[1];
    }
    Py_END_ALLOW_THREADS
    if (short_of_memory) {
        PyErr_NoMemory();
        goto end;
    }
    real = array_of(&of_reals);
    pairs = real ? array_of(&of_pairs) : NULL;
    if (pairs)
        all = PyTuple_Pack(3, counts, real, pairs);
end:
    free(of_reals.rows);
    free(of_pairs.rows);
    Py_XDECREF(copy);
    Py_XDECREF(counts);
    Py_XDECREF(real);
    Py_XDECREF(pairs);
    return all;
}

PyMethodDef elimination_methods[] = {
    {"elimination", (PyCFunction)(void (*)(void))elimination, METH_FASTCALL,
     "elimination(chain, numbers): a prepared elimination's handle"},
    {"eliminated", (PyCFunction)(void (*)(void))eliminated, METH_FASTCALL,
     "eliminated(elimination, T): counts (m, 4) and solutions (s, 8)"},
    {"candidates", (PyCFunction)(void (*)(void))candidates, METH_FASTCALL,
     "candidates(elimination, closing): counts (m, 2), real ones (s, 6), of pairs one (t, 12)"},
    {NULL, NULL, 0, NULL},
};
