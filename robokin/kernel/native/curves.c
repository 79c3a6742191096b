/* Curves of configurations that were followed: which configurations are on them, and their pieces within the limits,
   as methods of the module. */

#include "module.h"

#include "tracks.h"

/* See `solution_sets`. */
#define PASS_BESIDE 0.05
#define PASS_SAME 1e-5
#define PASS_ALONG 0.98
#define PASS_STEPS 40.0
#define PASS_SETTLED 1e-13
#define PASS_ZERO 1e-5

/* Curves, each at a target, by their points. */
typedef struct {
    const Chain *chain;
    npy_intp n, curves, all;
    double size;
    const double *T, *points, *tangents, *counts;
} Curves;

/* The arguments that all calls begin with: chain, size, T, points, tangents, counts. */
static int put_curves(PyObject *const *args, Curves *c, PyObject **copies) {
    c->chain = PyCapsule_GetPointer(args[0], CHAIN);
    if (!c->chain)
        return 0;
    c->n = c->chain->n;
    if (c->n > MOST_TRACKED) {
        PyErr_SetString(PyExc_ValueError, "expected a chain of fewer joints");
        return 0;
    }
    c->size = PyFloat_AsDouble(args[1]);
    if (PyErr_Occurred())
        return 0;
    c->curves = c->all = -1;
    c->T = table(args[2], 16, &c->curves, &copies[0]);
    c->points = c->T ? table(args[3], c->n, &c->all, &copies[1]) : NULL;
    c->tangents = c->points ? table(args[4], c->n, &c->all, &copies[2]) : NULL;
    c->counts = c->tangents ? table(args[5], 1, &c->curves, &copies[3]) : NULL;
    if (!c->counts)
        return 0;
    double sum = 0.0;
    for (npy_intp k = 0; k < c->curves; k++) {
        if (!(c->counts[k] >= 1.0 && c->counts[k] <= (double)c->all)) {
            sum = -1.0;
            break;
        }
        sum += floor(c->counts[k]);
    }
    if (sum != (double)c->all) {
        PyErr_SetString(PyExc_ValueError, "expected as many points as the curves have");
        return 0;
    }
    return 1;
}

/* A place where a configuration may be on a curve. */
typedef struct {
    npy_intp pair;
    double off[MOST_TRACKED], t[MOST_TRACKED];
} Foot;

static double circled_at(const Chain *chain, int i, double x) {
    return chain->revolute[i] ? x - FULL_TURN * rounded(x / FULL_TURN) : x;
}

/* The distance of x from the chord that begins at point p, and what part of the chord is next to it. */
static double chord_distance(const Chain *chain, const double *p, const double *x, double *part, double *away) {
    double gap[MOST_TRACKED], chord[MOST_TRACKED], along, distance = 0.0;
    int n = chain->n;
    for (int i = 0; i < n; i++) {
        gap[i] = circled_at(chain, i, x[i] - p[i]);
        chord[i] = p[n + i] - p[i];
    }
    along = dot_of(n, gap, chord) / dot_of(n, chord, chord);
    along = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
    if (away)
        *away = sqrt(dot_of(n, gap, gap));
    for (int i = 0; i < n; i++)
        distance += (gap[i] - along * chord[i]) * (gap[i] - along * chord[i]);
    *part = along;
    return sqrt(distance);
}

/* Whether the configurations at feet are on the curves, and there along the ways: levels of their pairs. */
static void put_levels(const Curves *c, const double *x, const double *ways, const double *pairs, const Foot *feet,
                       Waiting *w, double *levels) {
    double from[MOST_TRACKED * AT_A_TIME];
    int n = (int)c->n, count = w->count;
    for (int k = 0; k < count; k++)
        w->to[k] = from + n * k;
    lanes.corrected(c->chain, w->T, w->normals, 1, w->most, w->x, count, c->size, PASS_SETTLED, PASS_ZERO, w->off,
                    w->J);
    for (int k = 0; k < count; k++) {
        const Foot *foot = feet + k;
        npy_intp row = (npy_intp)pairs[2 * foot->pair + 1];
        double miss = 0.0, off = 0.0;
        int numbers = 1;
        for (int i = 0; i < n; i++) {
            double away = fabs(circled_at(c->chain, i, w->x[n * k + i] - x[n * row + i]));
            numbers = numbers && away == away;
            miss = away > miss ? away : miss;
            off = fabs(foot->off[i]) > off ? fabs(foot->off[i]) : off;
        }
        /* A point of the curve itself needs no correction, which at a crossing would lead astray. */
        if ((numbers && miss <= PASS_SAME && w->off[k] <= TRACK_CLOSES) || off <= PASS_SAME) {
            double level = fabs(dot_of(n, foot->t, ways + n * row)) >= PASS_ALONG ? 2.0 : 1.0;
            levels[foot->pair] = level > levels[foot->pair] ? level : levels[foot->pair];
        }
    }
    w->count = 0;
}

/* Of each pair of a curve and a configuration: 2 where the curve passes through it along its way, 1 where it passes
   through it otherwise, 0 where it does not. */
static int put_passes(const Curves *c, const double *x, const double *ways, const double *pairs, npy_intp m,
                      double *levels) {
    int n = (int)c->n;
    double *length = malloc((size_t)(c->all + 1) * sizeof(double));
    Foot *feet = malloc(AT_A_TIME * sizeof(Foot));
    npy_intp *first = malloc((size_t)(c->curves + 1) * sizeof(npy_intp));
    Waiting *w = malloc(sizeof(Waiting));
    int good = length && feet && first && w;
    if (good) {
        w->count = 0;
        first[0] = 0;
        for (npy_intp k = 0; k < c->curves; k++)
            first[k + 1] = first[k] + (npy_intp)c->counts[k];
        length[0] = 0.0;
        for (npy_intp k = 0; k + 1 < c->all; k++) {
            const double *p = c->points + n * k;
            double squared = 0.0;
            for (int i = 0; i < n; i++)
                squared += (p[n + i] - p[i]) * (p[n + i] - p[i]);
            length[k + 1] = length[k] + sqrt(squared);
        }
    }
    for (npy_intp pair = 0; good && pair < m; pair++) {
        npy_intp curve = (npy_intp)pairs[2 * pair], begin = first[curve], end = first[curve + 1] - 1, k = begin;
        const double *at = x + n * (npy_intp)pairs[2 * pair + 1];
        levels[pair] = 0.0;
        while (k < end) {
            const double *p = c->points + n * k;
            double part, away, other;
            double distance = chord_distance(c->chain, p, at, &part, &away);
            int near = distance <= PASS_BESIDE;
            near = near && (k == begin || distance <= chord_distance(c->chain, p - n, at, &other, NULL));
            if (near && (k + 1 == end || distance <= chord_distance(c->chain, p + n, at, &other, NULL))) {
                Foot *foot = feet + w->count;
                double along = 0.0, squared = 0.0, place[MOST_TRACKED], start[MOST_TRACKED];
                const double *t = c->tangents + n * k;
                foot->pair = pair;
                for (int i = 0; i < n; i++) {
                    foot->t[i] = (1.0 - part) * t[i] + part * t[n + i];
                    squared += foot->t[i] * foot->t[i];
                }
                squared = sqrt(squared) > 1e-12 ? sqrt(squared) : 1e-12;
                for (int i = 0; i < n; i++) {
                    foot->t[i] /= squared;
                    place[i] = p[i] + part * (p[n + i] - p[i]);
                    foot->off[i] = circled_at(c->chain, i, at[i] - place[i]);
                    along += foot->off[i] * foot->t[i];
                }
                for (int i = 0; i < n; i++)
                    start[i] = place[i] + along * foot->t[i];
                int row = w->count++;
                memcpy(w->T + 16 * row, c->T + 16 * curve, 16 * sizeof(double));
                memcpy(w->normals + n * row, foot->t, (size_t)n * sizeof(double));
                memcpy(w->x + n * row, start, (size_t)n * sizeof(double));
                w->most[row] = PASS_STEPS;
                if (w->count == AT_A_TIME)
                    put_levels(c, x, ways, pairs, feet, w, levels);
            }
            /* What is nearer than `away` lies as far along the curve at least. */
            double least = length[k] + away - PASS_BESIDE - 1e-9;
            k++;
            while (k < end && length[k + 1] < least)
                k++;
        }
    }
    if (good && w->count)
        put_levels(c, x, ways, pairs, feet, w, levels);
    free(length);
    free(feet);
    free(first);
    free(w);
    return good;
}

static PyObject *passes(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[7] = {NULL, NULL, NULL, NULL, NULL, NULL, NULL}, *levels = NULL;
    Curves c;
    npy_intp m = -1, p = -1;
    int good = 0;
    (void)self;
    if (count != 9) {
        PyErr_SetString(PyExc_TypeError, "passes(chain, size, T, points, tangents, counts, x, ways, pairs)");
        return NULL;
    }
    if (!put_curves(args, &c, copies))
        goto end;
    const double *x = table(args[6], c.n, &m, &copies[4]), *ways = x ? table(args[7], c.n, &m, &copies[5]) : NULL;
    const double *pairs = ways ? table(args[8], 2, &p, &copies[6]) : NULL;
    for (npy_intp k = 0; pairs && k < p; k++)
        if (!(pairs[2 * k] >= 0.0 && pairs[2 * k] < (double)c.curves && pairs[2 * k + 1] >= 0.0 &&
              pairs[2 * k + 1] < (double)m)) {
            PyErr_SetString(PyExc_ValueError, "expected pairs of a curve and a configuration");
            pairs = NULL;
        }
    levels = pairs ? new_numbers(p, 0) : NULL;
    if (!levels)
        goto end;
    double *to = PyArray_DATA((PyArrayObject *)levels);
    Py_BEGIN_ALLOW_THREADS
    good = put_passes(&c, x, ways, pairs, p, to);
    Py_END_ALLOW_THREADS
    if (!good) {
        Py_CLEAR(levels);
        PyErr_NoMemory();
    }
end:
    for (int i = 0; i < 7; i++)
        Py_XDECREF(copies[i]);
    return levels;
}

static PyObject *pieces_within(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[6] = {NULL, NULL, NULL, NULL, NULL, NULL}, *parts[2] = {NULL, NULL}, *both = NULL;
    Rows pieces = {NULL, 0, 0, 3}, points = {NULL, 0, 0, 1};
    Curves c;
    Track t;
    int good = 1;
    (void)self;
    if (count != 8) {
        PyErr_SetString(PyExc_TypeError, "pieces_within(chain, size, T, points, tangents, counts, limits, curves)");
        return NULL;
    }
    if (!put_curves(args, &c, copies))
        goto end;
    npy_intp six = 6;
    const double *limits = table(args[6], c.n, &six, &copies[4]);
    const double *each = limits ? table(args[7], 1 + 2 * c.n, &c.curves, &copies[5]) : NULL;
    if (!each)
        goto end;
    points.width = (int)c.n;
    t = (Track){.chain = c.chain, .n = (int)c.n, .size = c.size, .low = limits, .high = limits + c.n,
                .tolerance = limits + 2 * c.n, .middle = limits + 3 * c.n, .turning = limits + 4 * c.n,
                .bounded = limits + 5 * c.n, .points = c.points, .tangents = c.tangents};
    Py_BEGIN_ALLOW_THREADS
    put_from_nodes(&t);
    for (npy_intp k = 0; k < c.curves && good; k++) {
        npy_intp number = (npy_intp)c.counts[k];
        const double *own = each + k * (1 + 2 * c.n);
        t.T = c.T + 16 * k;
        t.last = number - 1;
        t.closed = own[0] != 0.0;
        t.round = own + 1;
        t.moving = own + 1 + c.n;
        good = put_pieces(&t, (int)k, &pieces, &points);
        t.points += c.n * number;
        t.tangents += c.n * number;
    }
    Py_END_ALLOW_THREADS
    if (!good) {
        PyErr_NoMemory();
        goto end;
    }
    if (!(parts[0] = new_numbers(pieces.used, 3)) || !(parts[1] = new_numbers(points.used, c.n)))
        goto end;
    if (pieces.used)
        memcpy(PyArray_DATA((PyArrayObject *)parts[0]), pieces.v, (size_t)(3 * pieces.used) * sizeof(double));
    if (points.used)
        memcpy(PyArray_DATA((PyArrayObject *)parts[1]), points.v, (size_t)(c.n * points.used) * sizeof(double));
    both = PyTuple_Pack(2, parts[0], parts[1]);
end:
    free(pieces.v);
    free(points.v);
    for (int i = 0; i < 6; i++)
        Py_XDECREF(copies[i]);
    Py_XDECREF(parts[0]);
    Py_XDECREF(parts[1]);
    return both;
}

/* Distances are told apart to so many parts of a radian: see `spread`. */
#define SPREAD_PARTS 1e7

/* The places of `most` of m configurations x (n, m), each the farthest from those before: see `spread_of_one`. */
static void put_spread(const double *x, npy_intp n, npy_intp m, const double *move, const double *preferred,
                       npy_intp most, double *distance, npy_intp *chosen) {
    npy_intp pick = 0;
    double best = HUGE_VAL, *gap = distance + m;
    for (npy_intp k = 0; k < m; k++) {
        double least = rounded(move[k] * SPREAD_PARTS) - (preferred ? preferred[k] * SPREAD_PARTS : 0.0);
        distance[k] = HUGE_VAL;
        if (least < best) {
            best = least;
            pick = k;
        }
    }
    chosen[0] = pick;
    for (npy_intp count = 1; count < most; count++) {
        npy_intp next = 0;
        best = -HUGE_VAL;
        for (npy_intp i = 0; i < n; i++) {
            const double *row = x + i * m, from = row[pick];
            for (npy_intp k = 0; k < m; k++) {
                double away = fabs(row[k] - from), back = FULL_TURN - away, least = back < away ? back : away;
                gap[k] = i && gap[k] > least ? gap[k] : least;
            }
        }
        for (npy_intp k = 0; k < m; k++) {
            double to = rounded(gap[k] * SPREAD_PARTS);
            distance[k] = to < distance[k] ? to : distance[k];
        }
        distance[pick] = -HUGE_VAL;
        for (npy_intp k = 0; k < m; k++) {
            double value = preferred ? distance[k] + preferred[k] * SPREAD_PARTS : distance[k];
            if (value > best) {
                best = value;
                next = k;
            }
        }
        pick = chosen[count] = next;
    }
}

static PyObject *spread(PyObject *self, PyObject *const *args, Py_ssize_t count) {
    PyObject *copies[3] = {NULL, NULL, NULL}, *chosen = NULL;
    (void)self;
    if (count != 4) {
        PyErr_SetString(PyExc_TypeError, "spread(x, move, most, preferred or None)");
        return NULL;
    }
    long asked = PyLong_AsLong(args[2]);
    PyArrayObject *x = PyErr_Occurred() ? NULL : doubles(args[0], 2, &copies[0]);
    npy_intp n = x ? PyArray_DIM(x, 0) : 0, m = x ? PyArray_DIM(x, 1) : 0;
    const double *move = x ? table(args[1], 1, &m, &copies[1]) : NULL;
    const double *preferred = move && args[3] != Py_None ? table(args[3], 1, &m, &copies[2]) : NULL;
    if (!move || PyErr_Occurred())
        goto end;
    if (PyArray_NDIM(x) != 2 || !m || !n || asked < 1) {
        PyErr_SetString(PyExc_ValueError, "expected configurations (n, m), and a number of them");
        goto end;
    }
    const npy_intp shape[] = {asked < m ? asked : m};
    double *distance = malloc(2 * (size_t)m * sizeof(double));
    chosen = distance ? PyArray_EMPTY(1, shape, NPY_INTP, 0) : PyErr_NoMemory();
    if (chosen)
        put_spread(PyArray_DATA(x), n, m, move, preferred, shape[0], distance,
                   PyArray_DATA((PyArrayObject *)chosen));
    free(distance);
end:
    for (int i = 0; i < 3; i++)
        Py_XDECREF(copies[i]);
    return chosen;
}

PyMethodDef curve_methods[] = {
    {"passes", (PyCFunction)(void (*)(void))passes, METH_FASTCALL,
     "passes(chain, size, T, points, tangents, counts, x, ways, pairs): levels (p,)"},
    {"pieces_within", (PyCFunction)(void (*)(void))pieces_within, METH_FASTCALL,
     "pieces_within(chain, size, T, points, tangents, counts, limits, curves): pieces (p, 3) and points (k, n)"},
    {"spread", (PyCFunction)(void (*)(void))spread, METH_FASTCALL,
     "spread(x, move, most, preferred): places of x (n, m)"},
    {NULL, NULL, 0, NULL},
};
