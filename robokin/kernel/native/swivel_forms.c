/* Arms with a spherical shoulder and wrist as methods of the module: a handle, one target, many. */

#include "module.h"
#include "swivel.h"

#include <math.h>
#include <string.h>

static const char *SWIVEL = "robokin.swivel";

/* Of a solution's row: joint values, position, angle, curve. */
#define COLUMNS (SEVEN + 3)

static void freed(PyObject *capsule) { PyMem_Free(PyCapsule_GetPointer(capsule, SWIVEL)); }

static const double *taken(const double *from, double *to, int count) {
    memcpy(to, from, (size_t)count * sizeof(double));
    return from + count;
}

/* Numbers of an arm, in the order of `native_swivel`; `bounds` rows of limits follow them. */
#define NUMBERS (1 + 9 + 3 + 3 + 3 + 9 + 3 + 3 + 9 + 3 + 9 + 3 + 3 + 8 + 24)

/* swivel(chain, numbers, limits (7, 6), equations (b, 11)): a handle. */
static PyObject *swivel(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[3] = {NULL}, *capsule = NULL;
    PyArrayObject *numbers, *limits, *equations;
    (void)self;
    const Chain *chain = count == 4 ? PyCapsule_GetPointer(args[0], CHAIN) : NULL;
    if (!chain) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "swivel(chain, numbers, limits, equations)");
        return NULL;
    }
    numbers = doubles(args[1], 1, &copies[0]);
    limits = numbers ? doubles(args[2], 2, &copies[1]) : NULL;
    equations = limits ? doubles(args[3], 2, &copies[2]) : NULL;
    if (!equations)
        goto end;
    npy_intp bounds = PyArray_DIM(equations, 0);
    int fits = chain->n == SEVEN && PyArray_SIZE(numbers) == NUMBERS && PyArray_SIZE(limits) == 6 * SEVEN &&
               bounds <= MOST_BOUNDS && PyArray_SIZE(equations) == 11 * bounds;
    for (int i = 0; fits && i < SEVEN; i++)
        fits = chain->revolute[i];
    if (!fits) {
        PyErr_SetString(PyExc_ValueError, "arrays of an arm do not fit each other");
        goto end;
    }
    SwivelArm *made = PyMem_Malloc(sizeof(SwivelArm));
    if (!made) {
        PyErr_NoMemory();
        goto end;
    }
    memset(made, 0, sizeof(SwivelArm));
    made->chain = *chain;
    const double *from = taken(PyArray_DATA(numbers), &made->size, 1);
    from = taken(from, made->base, 9);
    from = taken(from, made->origin, 3);
    from = taken(from, made->wrist, 3);
    from = taken(from, made->shoulder, 3);
    from = taken(from, made->hand, 9);
    from = taken(from, made->seen, 3);
    from = taken(from, made->lower, 3);
    from = taken(from, made->forearm, 9);
    from = taken(from, made->forearm_origin, 3);
    from = taken(from, made->next, 9);
    from = taken(from, made->upper, 3);
    from = taken(from, made->elbow, 3);
    from = taken(from, made->k, 2);
    from = taken(from, made->r, 2);
    from = taken(from, made->cos_phi, 2);
    from = taken(from, made->sin_phi, 2);
    from = taken(from, made->u[0][0], 12);
    taken(from, made->v[0][0], 12);
    const double *row = PyArray_DATA(limits);
    for (int i = 0; i < SEVEN; i++, row += 6) {
        made->middle[i] = row[0];
        made->half[i] = row[1];
        made->stops[i] = row[2] != 0.0;
        made->low[i] = row[3];
        made->high[i] = row[4];
        made->rest[i] = row[5];
    }
    made->bounds = (int)bounds;
    row = PyArray_DATA(equations);
    for (int b = 0; b < bounds; b++, row += 11) {
        memcpy(made->matrix[b], row, sizeof made->matrix[b]);
        made->value[b] = row[10];
    }
    prepared_swivel(made);
    capsule = PyCapsule_New(made, SWIVEL, freed);
    if (!capsule)
        PyMem_Free(made);
end:
    let_go(copies, 3);
    return capsule;
}

/* How many solutions of a target are asked for, from 1 to MOST_LISTED; 0 and an error for others. */
static int most_of(PyObject *number) {
    long most = PyLong_AsLong(number);
    if (most >= 1 && most <= MOST_LISTED)
        return (int)most;
    if (!PyErr_Occurred())
        PyErr_SetString(PyExc_ValueError, "too many solutions are asked for");
    return 0;
}

/* swivel_solution(arm, T, most): rows q, position, angle, curve of the solutions for a target (4, 4); pieces as rows
   curve, first, last, whole; the joints, as bits, that move along each curve; how many close, and how many are within
   the limits. None where others are to look at it. */
static PyObject *solution(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *rows = NULL, *pieces = NULL, *moving = NULL, *all = NULL;
    SwivelCurves curves;
    SwivelAnswer answer;
    (void)self;
    int most = count == 3 ? most_of(args[2]) : 0;
    const SwivelArm *arm = most ? PyCapsule_GetPointer(args[0], SWIVEL) : NULL;
    PyArrayObject *T = arm ? doubles(args[1], 2, &copy) : NULL;
    if (!T) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "swivel_solution(arm, T, most)");
        return NULL;
    }
    if (PyArray_NDIM(T) != 2 || PyArray_DIM(T, 0) != 4 || PyArray_DIM(T, 1) != 4) {
        PyErr_SetString(PyExc_ValueError, "expected a target (4, 4)");
        goto end;
    }
    if (!swivel_answer(arm, lanes.poses, PyArray_DATA(T), most, &curves, &answer)) {
        Py_INCREF(Py_None);
        all = Py_None;
        goto end;
    }
    const npy_intp shape[] = {answer.listed, COLUMNS}, other[] = {answer.pieces, 4}, eight[] = {CURVES};
    rows = PyArray_EMPTY(2, shape, NPY_DOUBLE, 0);
    pieces = rows ? PyArray_EMPTY(2, other, NPY_DOUBLE, 0) : NULL;
    moving = pieces ? PyArray_ZEROS(1, eight, NPY_INTP, 0) : NULL;
    if (!moving)
        goto end;
    double *to = PyArray_DATA((PyArrayObject *)rows);
    for (int k = 0; k < answer.listed; k++, to += COLUMNS) {
        memcpy(to, answer.q[k], sizeof answer.q[k]);
        to[SEVEN] = answer.position[k];
        to[SEVEN + 1] = answer.angle[k];
        to[SEVEN + 2] = answer.code[k];
    }
    to = PyArray_DATA((PyArrayObject *)pieces);
    npy_intp *bits = PyArray_DATA((PyArrayObject *)moving);
    for (int i = 0; i < answer.pieces; i++, to += 4) {
        const SwivelPiece *piece = answer.piece + i;
        to[0] = piece->code;
        to[1] = piece->first;
        to[2] = piece->last;
        to[3] = piece->whole;
        if (!i || piece[-1].code != piece->code)
            bits[piece->code] = swivel_moving(arm, &curves, piece->code);
    }
    all = Py_BuildValue("OOOii", rows, pieces, moving, answer.closing, answer.within);
end:
    Py_XDECREF(rows);
    Py_XDECREF(pieces);
    Py_XDECREF(moving);
    Py_XDECREF(copy);
    return all;
}

/* The answers for targets T (m, 4, 4), in tables of `most` rows: see module.h. */
static void answered(const SwivelArm *arm, const double *T, npy_intp m, int most, void *const *at) {
    SwivelCurves curves;
    SwivelAnswer answer;
    npy_bool *plain = at[PLAIN], *inside = at[INSIDE];
    npy_intp *tried = at[TRIED], *closing = at[CLOSING], *within = at[WITHIN], *count = at[LISTED];
    double *q = at[VALUES], *position = at[POSITION], *angle = at[ANGLES];
    for (npy_intp i = 0; i < m; i++, T += 16, q += SEVEN * most, position += most, angle += most, inside += most) {
        plain[i] = (npy_bool)swivel_answer(arm, lanes.poses, T, most, &curves, &answer);
        int listed = plain[i] ? answer.listed : 0;
        tried[i] = closing[i] = plain[i] ? answer.closing : 0;
        within[i] = plain[i] ? answer.within : 0;
        count[i] = listed;
        memcpy(q, answer.q, (size_t)listed * sizeof answer.q[0]);
        memcpy(position, answer.position, (size_t)listed * sizeof(double));
        memcpy(angle, answer.angle, (size_t)listed * sizeof(double));
        for (int k = 0; k < most; k++)
            inside[k] = k < listed;
        for (int k = listed; k < most; k++) {
            for (int j = 0; j < SEVEN; j++)
                q[SEVEN * k + j] = NAN;
            position[k] = angle[k] = NAN;
        }
    }
}

/* swivel_solutions(arm, T, most, tables): fill tables (see module.h) for targets T (m, 4, 4), `most` rows of each. */
static PyObject *solutions(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *made[TABLES] = {NULL}, *all = NULL;
    void *at[TABLES];
    (void)self;
    int most = count == 4 ? most_of(args[2]) : 0;
    const SwivelArm *arm = most ? PyCapsule_GetPointer(args[0], SWIVEL) : NULL;
    npy_intp m = 0;
    const double *from = arm ? targets(args[1], &m, &copy) : NULL;
    if (!from) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "swivel_solutions(arm, T, most, tables)");
        goto end;
    }
    if (!batch_tables(args[3], m, most, SEVEN, made, at))
        goto end;
    Py_BEGIN_ALLOW_THREADS
    answered(arm, from, m, most, at);
    Py_END_ALLOW_THREADS
    Py_INCREF(Py_None);
    all = Py_None;
end:
    let_go(made, TABLES);
    Py_XDECREF(copy);
    return all;
}

PyMethodDef swivel_methods[] = {
    {"swivel", (PyCFunction)(void (*)(void))swivel, METH_FASTCALL, "swivel(chain, numbers, limits, equations): a handle"},
    {"swivel_solution", (PyCFunction)(void (*)(void))solution, METH_FASTCALL, "swivel_solution(arm, T, most)"},
    {"swivel_solutions", (PyCFunction)(void (*)(void))solutions, METH_FASTCALL, "swivel_solutions(arm, T, most, tables)"},
    {NULL, NULL, 0, NULL},
};
