/* Closed forms as methods of the module: a handle made of a tape, solutions for one target and for many.

   What a tape says is checked when the handle is made, so that no register, root or level beyond the memory for it is
   ever asked for.
*/

#include "module.h"

#include <math.h>
#include <string.h>

/* Of a solution's row. */
#define COLUMNS (SIX + 4)

static const char *FORM = "robokin.form";

/* Error of a rotation that is rounding, how far the last row may be from 0 0 0 1, and the origin from the base. */
#define RIGID 1e-14
#define BOTTOM 1e-9
#define FARTHEST_TARGET 1e12

static const char *SIGNS = "robokin.signs";

static void freed_signs(PyObject *capsule) { PyMem_Free(PyCapsule_GetPointer(capsule, SIGNS)); }

static void freed_form(PyObject *capsule) { PyMem_Free(PyCapsule_GetPointer(capsule, FORM)); }

/* Whether a target is a rigid pose to the last digits; what is no number is none. */
static int plain_pose(const double *T) {
    const double *a = T, *b = T + 4, *c = T + 8;
    double error = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double off = fabs(a[i] * a[j] + b[i] * b[j] + c[i] * c[j] - (i == j));
            if (!(off <= RIGID))
                return 0;
            error = off > error ? off : error;
        }
    double determinant = (a[0] * b[1] - b[0] * a[1]) * c[2] + (b[0] * c[1] - c[0] * b[1]) * a[2] +
                         (c[0] * a[1] - a[0] * c[1]) * b[2];
    return determinant > 0.0 && fabs(a[3]) <= FARTHEST_TARGET && fabs(b[3]) <= FARTHEST_TARGET &&
           fabs(c[3]) <= FARTHEST_TARGET && fabs(T[12]) <= BOTTOM && fabs(T[13]) <= BOTTOM && fabs(T[14]) <= BOTTOM &&
           fabs(T[15] - 1.0) <= BOTTOM;
}

/* A whole number from 0 to below `end`, or -1. */
static int whole(double value, int end) { return value >= 0.0 && value < end && value == floor(value) ? (int)value : -1; }

/* A place as two numbers say it, within the registers. */
static int placed(const double *from, Place *place) {
    place->slot = whole(from[0], MOST_SLOTS);
    place->level = whole(from[1], MOST_LEVELS + 1);
    return place->slot >= 0 && place->level >= 0 && place->slot + (1 << place->level) <= MOST_SLOTS;
}

static int apart(const Place *a, const Place *b) {
    return a->slot + (1 << a->level) <= b->slot || b->slot + (1 << b->level) <= a->slot;
}

/* The steps of a tape (k, 11): operation, and slot and level of out, a, b, c and d. */
#define WIDTH 11

static int taped(Form *form, const double *from) {
    for (int k = 0; k < form->steps; k++, from += WIDTH) {
        Step *step = form->tape + k;
        step->op = whole(from[0], OPERATIONS);
        if (step->op < 0 || !placed(from + 1, &step->out) || !placed(from + 3, &step->a) ||
            !placed(from + 5, &step->b) || !placed(from + 7, &step->c) || !placed(from + 9, &step->d))
            return 0;
        int told = step->op == REAL || step->op == NEEDED || step->op == LEVER || step->op == ENTERED;
        /* What is written is read by no operand of the same step, and is no constant. */
        if (!told && (step->out.slot < form->inputs + form->constants || !apart(&step->out, &step->a) ||
                      !apart(&step->out, &step->b) || !apart(&step->out, &step->c) || !apart(&step->out, &step->d)))
            return 0;
        if ((step->op == ENTERED || step->op == BOTH) && step->out.level < 1)
            return 0;
        if (told && step->out.level > form->levels)
            return 0;
    }
    return 1;
}

/* Whether a tape and its constants are within the memory for them. */
static int has_room(PyArrayObject *tape, PyArrayObject *constants, int inputs) {
    npy_intp steps = PyArray_SIZE(tape) / WIDTH;
    return steps <= MOST_STEPS && PyArray_SIZE(tape) == WIDTH * steps && PyArray_SIZE(constants) <= MOST_SLOTS - inputs;
}

/* A new form of a chain, with constants that have room and steps that are `taped` once its levels are known. */
static Form *new_form(const Chain *chain, PyArrayObject *tape, PyArrayObject *constants, int inputs) {
    npy_intp steps = PyArray_SIZE(tape) / WIDTH;
    Form *made = PyMem_Malloc(sizeof(Form) + (size_t)steps * sizeof(Step));
    if (!made) {
        PyErr_NoMemory();
        return NULL;
    }
    memset(made, 0, sizeof(Form));
    made->chain = *chain;
    made->inputs = inputs;
    made->constants = (int)PyArray_SIZE(constants);
    made->steps = (int)steps;
    memcpy(made->value, PyArray_DATA(constants), (size_t)made->constants * sizeof(double));
    return made;
}

/* The handle of a form whose tape and leaves fit; one that does not, or gets no handle, is given back. */
static PyObject *handle_of(Form *made, int fits, const char *name, PyCapsule_Destructor freed) {
    PyObject *capsule = fits ? PyCapsule_New(made, name, freed) : NULL;
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "a tape asks for what is not there");
    if (!capsule)
        PyMem_Free(made);
    return capsule;
}

static void columns_of(const double *T, double *out) {
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            out[3 * c + r] = T[4 * r + c];
}

/* form(chain, links (2, 4, 4), (unit, size), tape, constants, leaves (r, 6, 2), levels, limits (6, 7)) */
static PyObject *form(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[6] = {NULL}, *capsule = NULL;
    PyArrayObject *sizes, *links, *tape, *constants, *leaves, *limits;
    (void)self;
    double levels = count == 8 ? PyFloat_AsDouble(args[6]) : 0.0;
    const Chain *chain = count == 8 && !PyErr_Occurred() ? PyCapsule_GetPointer(args[0], CHAIN) : NULL;
    if (!chain) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "form(chain, links, sizes, tape, constants, leaves, levels, limits)");
        return NULL;
    }
    links = doubles(args[1], 3, &copies[0]);
    tape = links ? doubles(args[3], 2, &copies[1]) : NULL;
    constants = tape ? doubles(args[4], 1, &copies[2]) : NULL;
    leaves = constants ? doubles(args[5], 3, &copies[3]) : NULL;
    limits = leaves ? doubles(args[7], 2, &copies[4]) : NULL;
    sizes = limits ? doubles(args[2], 1, &copies[5]) : NULL;
    if (!sizes)
        goto end;
    npy_intp roots = PyArray_SIZE(leaves) / (2 * SIX);
    const double *size = PyArray_DATA(sizes);
    int high = whole(levels, MOST_LEVELS + 1), turning = chain->n == SIX;
    for (int i = 0; turning && i < SIX; i++)
        turning = chain->revolute[i];
    if (!turning || PyArray_SIZE(links) != 32 || !has_room(tape, constants, ROWS) || roots < 1 || high < 0 ||
        roots > MOST_ROOTS >> high || PyArray_SIZE(leaves) != 2 * SIX * roots || PyArray_SIZE(limits) != 7 * SIX || PyArray_SIZE(sizes) != 2 ||
        !(size[0] > 0.0 && size[1] > 0.0)) {
        PyErr_SetString(PyExc_ValueError, "arrays of a closed form do not fit each other");
        goto end;
    }
    Form *made = new_form(chain, tape, constants, ROWS);
    if (!made)
        goto end;
    made->unit = size[0];
    made->size = size[1];
    columns_of(PyArray_DATA(links), made->first);
    columns_of((const double *)PyArray_DATA(links) + 16, made->last);
    made->levels = high;
    made->leaves = (int)roots;
    const double *place = PyArray_DATA(leaves), *bound = PyArray_DATA(limits);
    int fits = taped(made, PyArray_DATA(tape));
    for (int k = 0; k < roots; k++)
        for (int i = 0; i < SIX; i++, place += 2)
            fits = fits && placed(place, &made->leaf[k][i]) && made->leaf[k][i].level <= high;
    for (int i = 0; i < SIX; i++, bound += 7) {
        made->low[i] = bound[0];
        made->high[i] = bound[1];
        made->bounded[i] = bound[2] != 0.0;
        made->beyond[i] = bound[3] != 0.0;
        made->wide[i] = bound[4] != 0.0;
        made->wide_low[i] = bound[5];
        made->wide_high[i] = bound[6];
    }
    capsule = handle_of(made, fits, FORM, freed_form);
end:
    let_go(copies, 6);
    return capsule;
}

/* signs(chain, size, tape, constants, places (k, 2)): a handle of the signs that name an arm's postures. */
static PyObject *signs(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[3] = {NULL}, *capsule = NULL;
    PyArrayObject *tape, *constants, *places;
    (void)self;
    double size = count == 5 ? PyFloat_AsDouble(args[1]) : 0.0;
    const Chain *chain = count == 5 && !PyErr_Occurred() ? PyCapsule_GetPointer(args[0], CHAIN) : NULL;
    if (!chain) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "signs(chain, size, tape, constants, places)");
        return NULL;
    }
    tape = doubles(args[2], 2, &copies[0]);
    constants = tape ? doubles(args[3], 1, &copies[1]) : NULL;
    places = constants ? doubles(args[4], 2, &copies[2]) : NULL;
    if (!places)
        goto end;
    npy_intp bits = PyArray_SIZE(places) / 2;
    if (chain->n != SIX || !has_room(tape, constants, AXES) || bits > SIX || PyArray_SIZE(places) != 2 * bits ||
        !(size > 0.0)) {
        PyErr_SetString(PyExc_ValueError, "arrays of signs do not fit each other");
        goto end;
    }
    Form *made = new_form(chain, tape, constants, AXES);
    if (!made)
        goto end;
    made->size = size;
    made->leaves = (int)bits;
    const double *place = PyArray_DATA(places);
    int fits = taped(made, PyArray_DATA(tape));
    for (int k = 0; k < bits; k++, place += 2)
        fits = fits && placed(place, &made->leaf[0][k]) && made->leaf[0][k].level == 0;
    capsule = handle_of(made, fits, SIGNS, freed_signs);
end:
    let_go(copies, 3);
    return capsule;
}

/* sides(signs, q (s, 6)): (s) a number whose bits are the signs of each configuration. */
static PyObject *sides(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *codes = NULL;
    (void)self;
    const Form *known = count == 2 ? PyCapsule_GetPointer(args[0], SIGNS) : NULL;
    PyArrayObject *q = known ? doubles(args[1], 2, &copy) : NULL;
    if (!q) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "sides(signs, q)");
        return NULL;
    }
    npy_intp m = PyArray_DIM(q, 0);
    if (PyArray_NDIM(q) != 2 || PyArray_DIM(q, 1) != SIX)
        PyErr_SetString(PyExc_ValueError, "expected configurations (s, 6)");
    else
        codes = PyArray_EMPTY(1, &m, NPY_INTP, 0);
    if (codes) {
        ptrdiff_t *to = PyArray_DATA((PyArrayObject *)codes);
        const double *from = PyArray_DATA(q);
        if (m < LONG) {
            lanes.sides(known, from, m, to);
        } else {
            Py_BEGIN_ALLOW_THREADS
            lanes.sides(known, from, m, to);
            Py_END_ALLOW_THREADS
        }
    }
    Py_XDECREF(copy);
    return codes;
}

/* What a call asks for: form, limits, and a copy of the wish, or None. */
static const Form *wanted_of(PyObject *const *args, Wanted *wanted, double wish[SIX]) {
    PyObject *copy = NULL;
    wanted->limits = PyObject_IsTrue(args[2]);
    wanted->inside_only = 0;
    wanted->wish = NULL;
    if (wanted->limits < 0)
        return NULL;
    if (args[3] != Py_None) {
        PyArrayObject *near = doubles(args[3], 1, &copy);
        if (near && PyArray_SIZE(near) == SIX) {
            memcpy(wish, PyArray_DATA(near), SIX * sizeof(double));
            wanted->wish = wish;
        } else if (near) {
            PyErr_SetString(PyExc_ValueError, "expected a wish for each joint");
        }
        Py_XDECREF(copy);
        if (!wanted->wish)
            return NULL;
    }
    return PyCapsule_GetPointer(args[0], FORM);
}

/* How many configurations within the limits joint values are equivalent to, themselves included. */
static double equivalents(const Form *form, const double *q) {
    double count = 1.0;
    for (int i = 0; i < SIX; i++)
        if (form->wide[i]) {
            double least = ceil((form->wide_low[i] - q[i]) / TURN), most = floor((form->wide_high[i] - q[i]) / TURN);
            count *= (most > 0.0 ? most : 0.0) - (least < 0.0 ? least : 0.0) + 1.0;
        }
    return count;
}

/* solution(form, T, limits, wish, elimination): a row q, position, angle, inside, equivalents for each solution, the target as
   it was, how many candidates there were, and how many solutions are within the limits, with their equivalents how many;
   None where others are to look at it. No row where there clearly is no solution. */
static PyObject *solution(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    double T[16], wish[SIX], q[MOST_CANDIDATES][SIX], position[MOST_CANDIDATES], angle[MOST_CANDIDATES];
    unsigned char inside[MOST_CANDIDATES];
    int tried = 0;
    Wanted wanted;
    (void)self;
    const Form *known = count == 5 ? wanted_of(args, &wanted, wish) : NULL;
    const Elimination *general = known && args[4] != Py_None ? PyCapsule_GetPointer(args[4], ELIMINATION) : NULL;
    if (!known || PyErr_Occurred()) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "solution(form, T, limits, wish, elimination)");
        return NULL;
    }
    PyArrayObject *given = (PyArrayObject *)args[1];
    if (!PyArray_CheckExact(args[1]) || PyArray_TYPE(given) != NPY_DOUBLE || PyArray_NDIM(given) != 2 ||
        PyArray_DIM(given, 0) != 4 || PyArray_DIM(given, 1) != 4 || !PyArray_ISBEHAVED_RO(given))
        Py_RETURN_NONE;
    const char *from = PyArray_DATA(given);
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++)
            T[4 * r + c] = *(const double *)(from + r * PyArray_STRIDE(given, 0) + c * PyArray_STRIDE(given, 1));
    Solutions out = {q[0], position, angle, inside, 0};
    int plain = plain_pose(T), found = 0;
    if (plain && general)
        found = lanes.listed_elimination(general, known, T, &wanted, &out, &tried);
    else if (plain)
        tried = found = lanes.solution(known, T, &wanted, &out);
    if (!found)
        Py_RETURN_NONE;
    if (found == NONE_AT_ALL)
        tried = found = 0;
    const npy_intp shape[] = {found, COLUMNS}, four[] = {4, 4};
    PyObject *rows = PyArray_EMPTY(2, shape, NPY_DOUBLE, 0);
    PyObject *target = rows ? PyArray_EMPTY(2, four, NPY_DOUBLE, 0) : NULL, *both = NULL;
    if (target) {
        double *to = PyArray_DATA((PyArrayObject *)rows), turns = 0.0;
        int within = 0;
        memcpy(PyArray_DATA((PyArrayObject *)target), T, sizeof(T));
        for (int k = 0; k < found; k++, to += COLUMNS) {
            memcpy(to, q[k], SIX * sizeof(double));
            to[SIX] = position[k];
            to[SIX + 1] = angle[k];
            to[SIX + 2] = inside[k];
            to[SIX + 3] = equivalents(known, q[k]);
            within += inside[k] != 0;
            turns += inside[k] ? to[SIX + 3] : 0.0;
        }
        both = Py_BuildValue("OOiid", rows, target, tried, within, turns);
    }
    Py_XDECREF(rows);
    Py_XDECREF(target);
    return both;
}

/* Rows a target that its answer takes. */
static int rows_of(const Form *form, const Elimination *general) {
    return general ? general->number : form->leaves << form->levels;
}

typedef struct {
    npy_bool *plain, *inside;
    npy_intp *tried, *closing, *within, *listed;
    double *q, *position, *angle;
} Tables;

/* The solutions `from` of a target as they are listed: within the limits where these count, by the greatest move from
   the wish, at most so many of them. May be asked for rows that are where they belong. */
static npy_intp put_in_order(const Solutions *from, const Wanted *wanted, npy_intp most, const Solutions *to,
                             npy_intp *within) {
    double move[MOST_CANDIDATES], q[MOST_CANDIDATES][SIX], position[MOST_CANDIDATES], angle[MOST_CANDIDATES];
    unsigned char inside[MOST_CANDIDATES];
    int order[MOST_CANDIDATES], count = 0;
    for (int k = 0; k < from->listed; k++) {
        if (wanted->limits && !from->inside[k])
            continue;
        int place = count++;
        move[k] = 0.0;
        for (int i = 0; wanted->wish && i < SIX; i++)
            move[k] = fmax(move[k], fabs(from->q[SIX * k + i] - wanted->wish[i]));
        for (; place && move[order[place - 1]] > move[k]; place--)
            order[place] = order[place - 1];
        order[place] = k;
    }
    *within = count;
    if (count > most)
        count = (int)most;
    for (int k = 0; k < count; k++) {
        memcpy(q[k], from->q + SIX * order[k], sizeof q[k]);
        position[k] = from->position[order[k]];
        angle[k] = from->angle[order[k]];
        inside[k] = from->inside[order[k]];
    }
    memcpy(to->q, q, (size_t)count * sizeof q[0]);
    memcpy(to->position, position, (size_t)count * sizeof(double));
    memcpy(to->angle, angle, (size_t)count * sizeof(double));
    memcpy(to->inside, inside, (size_t)count);
    return count;
}

/* No numbers in a target's rows from `first` on. */
static void emptied(const Solutions *rows, npy_intp first, npy_intp end) {
    for (npy_intp k = first; k < end; k++) {
        for (int i = 0; i < SIX; i++)
            rows->q[SIX * k + i] = NAN;
        rows->position[k] = rows->angle[k] = NAN;
        rows->inside[k] = 0;
    }
}

static void next_rows(Solutions *rows, npy_intp by) {
    rows->q += SIX * by;
    rows->position += by;
    rows->angle += by;
    rows->inside += by;
}

/* The answers for targets T (m, 4, 4) by a closed form, in tables of `rows` a target. */
static void by_closed_form(const Form *form, const double *T, npy_intp m, Wanted *wanted, npy_intp most, npy_intp rows,
                           const Tables *to) {
    Solutions at = {to->q, to->position, to->angle, to->inside, 0};
    wanted->inside_only = wanted->limits;
    lanes.solutions(form, T, m, wanted, &at, to->closing, to->listed, to->plain);
    memcpy(to->tried, to->closing, (size_t)m * sizeof(npy_intp));
    memcpy(to->within, to->listed, (size_t)m * sizeof(npy_intp));
    if (!wanted->wish && most >= rows)
        return;
    for (npy_intp i = 0; i < m; i++, next_rows(&at, rows)) {
        at.listed = (int)to->listed[i];
        to->listed[i] = put_in_order(&at, wanted, most, &at, to->within + i);
        emptied(&at, to->listed[i], to->within[i]);
    }
}

/* The same by elimination. */
static void by_elimination(const Elimination *general, const Form *form, const double *T, npy_intp m,
                           const Wanted *wanted, npy_intp most, npy_intp rows, const Tables *to) {
    double q[MOST_CANDIDATES][SIX], position[MOST_CANDIDATES], angle[MOST_CANDIDATES];
    unsigned char inside[MOST_CANDIDATES];
    Solutions at = {to->q, to->position, to->angle, to->inside, 0};
    for (npy_intp i = 0; i < m; i++, next_rows(&at, rows)) {
        Solutions out = {q[0], position, angle, inside, 0};
        int tried = 0, found = lanes.listed_elimination(general, form, T + 16 * i, wanted, &out, &tried);
        int done = found == NONE_AT_ALL || (found > 0 && found <= rows);
        if (found == NONE_AT_ALL || !done)
            tried = found = out.listed = 0;
        to->plain[i] = (npy_bool)done;
        to->tried[i] = tried;
        to->closing[i] = found;
        to->listed[i] = put_in_order(&out, wanted, most, &at, to->within + i);
        emptied(&at, to->listed[i], rows);
    }
}

/* The answers for targets T (m, 4, 4) by elimination, if that is not NULL, else by a closed form. */
static void answered(const Form *form, const Elimination *general, const double *T, npy_intp m, Wanted *wanted,
                     npy_intp most, npy_intp rows, const Tables *to) {
    if (general)
        by_elimination(general, form, T, m, wanted, most, rows, to);
    else
        by_closed_form(form, T, m, wanted, most, rows, to);
}

/* What is held of an arm of `whole` joints: their values, no numbers for the six others. */
typedef struct {
    double value[MOST_JOINTS];
    npy_intp whole;
} Held;

/* Targets whose joint values stay in the nearest memory before they are put between those that are held. */
#define TOGETHER 16

/* The same in tables of an arm of which joints are held. */
static void answered_held(const Form *form, const Elimination *general, const double *T, npy_intp m, Wanted *wanted,
                          npy_intp most, npy_intp rows, const Held *held, const Tables *to) {
    double q[TOGETHER * MOST_CANDIDATES * SIX], *row = to->q;
    for (npy_intp first = 0; first < m; first += TOGETHER) {
        npy_intp some = m - first < TOGETHER ? m - first : TOGETHER, at = first * rows;
        const Tables part = {to->plain + first,  to->inside + at,     to->tried + first,
                             to->closing + first, to->within + first, to->listed + first,
                             q,                   to->position + at,  to->angle + at};
        answered(form, general, T + 16 * first, some, wanted, most, rows, &part);
        const double *from = q;
        for (npy_intp i = 0; i < some; i++)
            for (npy_intp k = 0; k < rows; k++)
                for (npy_intp j = 0; j < held->whole; j++)
                    *row++ = isnan(held->value[j]) ? *from++ : k < part.listed[i] ? held->value[j] : NAN;
    }
}

/* `most` of a call: how many solutions of a target are listed, all for None; -1 and an error for what is no number. */
static npy_intp listed_at_most(PyObject *number) {
    if (number == Py_None)
        return MOST_CANDIDATES;
    npy_intp most = PyNumber_AsSsize_t(number, NULL);
    if (most < 0 && !PyErr_Occurred())
        PyErr_SetString(PyExc_ValueError, "expected how many solutions are listed");
    return PyErr_Occurred() ? -1 : most;
}

/* `pattern` of a call, copied: None where nothing is held; 0 and an error for what is no pattern. */
static int held_by(PyObject *pattern, Held *held) {
    PyObject *copy = NULL;
    npy_intp left = 0;
    held->whole = SIX;
    for (int i = 0; i < SIX; i++)
        held->value[i] = NAN;
    if (pattern == Py_None)
        return 1;
    PyArrayObject *given = doubles(pattern, 1, &copy);
    if (!given)
        return 0;
    int fits = PyArray_NDIM(given) == 1 && PyArray_SIZE(given) <= MOST_JOINTS;
    if (fits) {
        held->whole = PyArray_SIZE(given);
        memcpy(held->value, PyArray_DATA(given), (size_t)held->whole * sizeof(double));
        for (npy_intp i = 0; i < held->whole; i++)
            left += isnan(held->value[i]);
        fits = left == SIX;
    }
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "expected held values that leave six joints");
    Py_XDECREF(copy);
    return fits;
}

/* solutions(form, T, limits, wish, elimination, most, tables, pattern): fill tables (see module.h) for targets T
   (m, 4, 4), rigid ones, by a closed form or by elimination, if that is not None; those of an arm whose held joints have
   the values of `pattern`, which are no numbers elsewhere, if that is not None. Of a form alone (form, T, limits, wish)
   new tables are made and handed over, but for those of candidates and of what counts for the limits. */
static PyObject *solutions(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL, *made[TABLES] = {NULL}, *all = NULL;
    double wish[SIX];
    Wanted wanted;
    Held held;
    Tables to;
    void *at[TABLES];
    npy_intp most = MOST_CANDIDATES;
    (void)self;
    const Form *known = count == 4 || count == 8 ? wanted_of(args, &wanted, wish) : NULL;
    const Elimination *general = known && count == 8 && args[4] != Py_None ? PyCapsule_GetPointer(args[4], ELIMINATION) : NULL;
    int fits = known && !PyErr_Occurred() && held_by(count == 8 ? args[7] : Py_None, &held);
    npy_intp m = 0;
    const double *from = fits ? targets(args[1], &m, &copy) : NULL;
    if (!from) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "solutions(form, T, limits, wish[, elimination, most, tables, pattern])");
        goto end;
    }
    if (count == 8 && (most = listed_at_most(args[5])) < 0)
        goto end;
    const npy_intp rows = rows_of(known, general);
    if (!batch_tables(count == 8 ? args[6] : NULL, m, rows, (int)held.whole, made, at))
        goto end;
    to = (Tables){at[PLAIN], at[INSIDE], at[TRIED], at[CLOSING], at[WITHIN],
                  at[LISTED], at[VALUES], at[POSITION], at[ANGLES]};
    PyThreadState *state = general || m >= LONG ? PyEval_SaveThread() : NULL;
    if (held.whole == SIX)
        answered(known, general, from, m, &wanted, most, rows, &to);
    else
        answered_held(known, general, from, m, &wanted, most, rows, &held, &to);
    if (state)
        PyEval_RestoreThread(state);
    if (count == 4)
        all = PyTuple_Pack(7, made[PLAIN], made[CLOSING], made[LISTED], made[VALUES], made[POSITION], made[ANGLES],
                           made[INSIDE]);
    else {
        Py_INCREF(Py_None);
        all = Py_None;
    }
end:
    let_go(made, TABLES);
    Py_XDECREF(copy);
    return all;
}

/* roots(form, elimination): how many rows a target's answer takes. */
static PyObject *roots(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    (void)self;
    const Form *known = count == 2 ? PyCapsule_GetPointer(args[0], FORM) : NULL;
    const Elimination *general = known && args[1] != Py_None ? PyCapsule_GetPointer(args[1], ELIMINATION) : NULL;
    if (!known || PyErr_Occurred()) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "roots(form, elimination)");
        return NULL;
    }
    return PyLong_FromLong(rows_of(known, general));
}

/* rigid(T): whether all targets of an array (..., 4, 4) are rigid poses to the last digits. */
static PyObject *rigid(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copy = NULL;
    (void)self;
    PyArrayObject *T = count == 1 ? doubles(args[0], 2, &copy) : NULL;
    if (!T) {
        if (!PyErr_Occurred())
            PyErr_SetString(PyExc_TypeError, "rigid(T)");
        return NULL;
    }
    int last = PyArray_NDIM(T) - 1;
    int all = PyArray_DIM(T, last) == 4 && PyArray_DIM(T, last - 1) == 4;
    const double *from = PyArray_DATA(T);
    npy_intp left = all ? PyArray_SIZE(T) / 16 : 0;
    PyThreadState *state = left >= LONG ? PyEval_SaveThread() : NULL;
    for (; all && left; left--, from += 16)
        all = plain_pose(from);
    if (state)
        PyEval_RestoreThread(state);
    Py_XDECREF(copy);
    return PyBool_FromLong(all);
}

PyMethodDef closed_form_methods[] = {
    {"form", (PyCFunction)(void (*)(void))form, METH_FASTCALL,
     "form(chain, links, sizes, tape, constants, leaves, levels, limits): a closed form's handle"},
    {"solution", (PyCFunction)(void (*)(void))solution, METH_FASTCALL, "solution(form, T, limits, wish, elimination)"},
    {"solutions", (PyCFunction)(void (*)(void))solutions, METH_FASTCALL,
     "solutions(form, T, limits, wish[, elimination, most, tables, pattern])"},
    {"roots", (PyCFunction)(void (*)(void))roots, METH_FASTCALL, "roots(form, elimination)"},
    {"signs", (PyCFunction)(void (*)(void))signs, METH_FASTCALL,
     "signs(chain, size, tape, constants, places): a handle of the signs of postures"},
    {"sides", (PyCFunction)(void (*)(void))sides, METH_FASTCALL, "sides(signs, q): their bits"},
    {"rigid", (PyCFunction)(void (*)(void))rigid, METH_FASTCALL, "rigid(T)"},
    {NULL, NULL, 0, NULL},
};
