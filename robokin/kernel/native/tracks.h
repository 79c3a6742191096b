/* Curves of configurations as functions of a place on each, and their pieces within the joint limits.

   Python's `track` and `arcs` are the reference, and say what is derived how. One curve at a time.
   Comes after module.h.
*/

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Joints of a chain whose curves are looked at here. */
#define MOST_TRACKED 7

/* See `track`. */
#define TRACK_PARTS 8
#define TRACK_NEARLY 2e-3
#define TRACK_KINK 0.03
#define TRACK_ROUNDING 1e-15
#define TRACK_CROSSING 1e-8
#define BESIDE_POINT 2e-4
#define TRACK_DEGREE 8
#define TRACK_CUTS 16
#define TRACK_ROUNDS 12
#define TRACK_STEPS 8.0
#define TRACK_CLOSES 5e-10

/* See `arcs`. */
#define ARC_ON_LIMIT 1e-12
#define ARC_FINE 8
#define ARC_END 1e-5
#define ARC_POINT 1e-9
#define ARC_INNER 5
#define ARC_ROUND 1e-9

#define FULL_TURN 6.28318530717958647692
#define HALF_A_TURN 1e-9

/* Configurations that are made exact at a time. */
#define AT_A_TIME 64

/* A curve at a target, and the limits: its joints that count are those that move. */
typedef struct {
    const Chain *chain;
    int n, closed;
    ptrdiff_t last;
    double size;
    const double *T, *points, *tangents, *low, *high, *tolerance, *middle, *turning, *bounded, *round, *moving;
    double from_nodes[TRACK_DEGREE + 1][TRACK_DEGREE + 1];
} Track;

/* A place on a curve, the configuration there, and its margin. */
typedef struct {
    double u, margin, x[MOST_TRACKED];
} Sample;

/* Numbers that grow in rows. */
typedef struct {
    double *v;
    ptrdiff_t used, room;
    int width;
} Rows;

/* A new row, or NULL where there is no memory. */
static double *new_row(Rows *rows) {
    if (rows->used == rows->room) {
        ptrdiff_t more = 2 * rows->room + 64;
        double *larger = realloc(rows->v, (size_t)(more * rows->width) * sizeof(double));
        if (!larger)
            return NULL;
        rows->v = larger;
        rows->room = more;
    }
    return rows->v + rows->width * rows->used++;
}

/* The nearest whole number, the even one of two, of what is below 2^51: without a call of the C library. */
static double rounded(double x) { return (x + 6755399441055744.0) - 6755399441055744.0; }

static double dot_of(int n, const double *a, const double *b) {
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Values at Chebyshev's places to coefficients. */
static void put_from_nodes(Track *t) {
    const double angle = 3.14159265358979323846 / TRACK_DEGREE;
    for (int j = 0; j <= TRACK_DEGREE; j++)
        for (int k = 0; k <= TRACK_DEGREE; k++) {
            double half = (j % TRACK_DEGREE ? 1.0 : 0.5) * (k % TRACK_DEGREE ? 1.0 : 0.5);
            double sign = j % 2 ? -1.0 : 1.0;
            t->from_nodes[j][k] = sign * 2.0 * half / TRACK_DEGREE * cos(j * k % (2 * TRACK_DEGREE) * angle);
        }
}

/* The point near the curve at place u, and the tangent there. */
static void cubic_at(const Track *t, double u, double *x, double *way) {
    int n = t->n;
    double last = (double)t->last, rounds = t->closed ? floor(u / (last > 1.0 ? last : 1.0)) : 0.0, length = 0.0;
    u -= rounds * last;
    double whole = floor(u), most = last > 1.0 ? last - 1.0 : 0.0;
    whole = whole < 0.0 ? 0.0 : whole > most ? most : whole;
    ptrdiff_t here = (ptrdiff_t)whole, ahead = here + 1 < t->last ? here + 1 : t->last;
    const double *a = t->points + n * here, *b = t->points + n * ahead;
    const double *before = t->tangents + n * here, *after = t->tangents + n * ahead;
    double f = u - whole, chord[MOST_TRACKED];
    for (int i = 0; i < n; i++) {
        chord[i] = b[i] - a[i];
        length += chord[i] * chord[i];
    }
    length = sqrt(length);
    for (int i = 0; i < n; i++) {
        double s = before[i] * length, e = after[i] * length;
        x[i] = a[i] + f * (s + f * (3.0 * chord[i] - 2.0 * s - e + f * (s + e - 2.0 * chord[i])));
        x[i] += rounds * t->round[i];
    }
    if (!way)
        return;
    for (int i = 0; i < n; i++)
        way[i] = (1.0 - f) * before[i] + f * after[i];
    length = sqrt(dot_of(n, way, way));
    length = length > 1e-12 ? length : 1e-12;
    for (int i = 0; i < n; i++)
        way[i] /= length;
}

/* Some configurations that wait to be made exact, each in a plane, and where they are to be put. */
typedef struct {
    int count;
    double T[16 * AT_A_TIME], normals[MOST_TRACKED * AT_A_TIME], most[AT_A_TIME], x[MOST_TRACKED * AT_A_TIME];
    double off[AT_A_TIME], J[6 * MOST_TRACKED * AT_A_TIME];
    double *to[AT_A_TIME];
} Waiting;

/* Make exact what waits, and put it where it belongs. */
static void made_exact(const Track *t, Waiting *w) {
    lanes.corrected(t->chain, w->T, w->normals, 1, w->most, w->x, w->count, t->size, TRACK_ROUNDING, TRACK_CROSSING,
                    w->off, w->J);
    for (int k = 0; k < w->count; k++)
        memcpy(w->to[k], w->x + t->n * k, (size_t)t->n * sizeof(double));
    w->count = 0;
}

static void put_waiting(const Track *t, Waiting *w, const double *x, const double *normal, double *to) {
    int k = w->count++, n = t->n;
    memcpy(w->T + 16 * k, t->T, 16 * sizeof(double));
    memcpy(w->normals + n * k, normal, (size_t)n * sizeof(double));
    memcpy(w->x + n * k, x, (size_t)n * sizeof(double));
    w->most[k] = TRACK_STEPS;
    w->to[k] = to;
}

/* The point at place u into `to`, exactly: now, or with the others that wait. */
static void point_at(const Track *t, Waiting *w, double u, double *to) {
    double x[MOST_TRACKED], way[MOST_TRACKED];
    cubic_at(t, u, x, way);
    if (!(fabs(u - rounded(u)) > BESIDE_POINT) || !t->last) {
        memcpy(to, x, (size_t)t->n * sizeof(double));
        return;
    }
    put_waiting(t, w, x, way, to);
    if (w->count == AT_A_TIME)
        made_exact(t, w);
}

/* The full turns that bring x nearest to the middle of its limits. */
static void turned_of(const Track *t, const double *x, double *turns) {
    for (int i = 0; i < t->n; i++)
        turns[i] = t->turning[i] != 0.0
                       ? -FULL_TURN * ceil((x[i] - t->middle[i] - HALF_A_TURN) / FULL_TURN - 0.5)
                       : 0.0;
}

/* How far joint i, which moves, is within its limits. */
static double room_of(const Track *t, int i, double x) {
    double low = x - t->low[i], high = t->high[i] - x;
    if (t->moving[i] == 0.0)
        return HUGE_VAL;
    return low < high ? low : high;
}

static double margin_with(const Track *t, const double *x, const double *turns) {
    double least = HUGE_VAL;
    for (int i = 0; i < t->n; i++) {
        double room = room_of(t, i, x[i] + turns[i]);
        least = room < least ? room : least;
    }
    return least;
}

static double margin_of(const Track *t, const double *x) {
    double turns[MOST_TRACKED];
    turned_of(t, x, turns);
    return margin_with(t, x, turns);
}

static int inside_with(const Track *t, const double *x, const double *turns) {
    for (int i = 0; i < t->n; i++) {
        double y = x[i] + turns[i];
        if (t->bounded[i] != 0.0 && !(y >= t->low[i] - t->tolerance[i] && y <= t->high[i] + t->tolerance[i]))
            return 0;
    }
    return 1;
}

/* The curve between places a and b, between which no point stands, as polynomials. */
typedef struct {
    double a, b, c[TRACK_DEGREE + 1][MOST_TRACKED];
} Span;

/* Makes `count` spans of their ends. */
static void put_spans(const Track *t, Span *spans, ptrdiff_t count) {
    Waiting w;
    double nodes[TRACK_DEGREE + 1][MOST_TRACKED];
    w.count = 0;
    for (ptrdiff_t s = 0; s < count; s++)
        for (int k = 0; k <= TRACK_DEGREE; k++) {
            double node = 0.5 - 0.5 * cos(3.14159265358979323846 * k / TRACK_DEGREE);
            point_at(t, &w, spans[s].a + (spans[s].b - spans[s].a) * node, spans[s].c[k]);
        }
    if (w.count)
        made_exact(t, &w);
    for (ptrdiff_t s = 0; s < count; s++) {
        memcpy(nodes, spans[s].c, sizeof nodes);
        for (int j = 0; j <= TRACK_DEGREE; j++)
            for (int i = 0; i < t->n; i++) {
                double sum = 0.0;
                for (int k = 0; k <= TRACK_DEGREE; k++)
                    sum += t->from_nodes[j][k] * nodes[k][i];
                spans[s].c[j][i] = sum;
            }
    }
}

/* The point at fraction f of a span. */
static void on_span(const Track *t, const Span *span, double f, double *x) {
    double y = 2.0 * f - 1.0, T[TRACK_DEGREE + 1] = {1.0, y};
    for (int j = 2; j <= TRACK_DEGREE; j++)
        T[j] = T[j - 1] * (2.0 * y) - T[j - 2];
    for (int i = 0; i < t->n; i++)
        x[i] = 0.0;
    for (int j = 0; j <= TRACK_DEGREE; j++)
        for (int i = 0; i < t->n; i++)
            x[i] += T[j] * span->c[j][i];
}

/* The place in a span where the margin, times a sign, is least. */
static double least_in(const Track *t, const Span *span, double sign) {
    double low = 0.0, high = 1.0, best = span->a, x[MOST_TRACKED];
    for (int pass = 0; pass < TRACK_ROUNDS; pass++) {
        double least = HUGE_VAL, width = high - low;
        int at = 0;
        for (int i = 0; i <= TRACK_CUTS; i++) {
            on_span(t, span, low + width * (i / (double)TRACK_CUTS), x);
            double value = sign * margin_of(t, x);
            if (value < least) {
                least = value;
                at = i;
            }
        }
        best = span->a + (span->b - span->a) * (low + width * (at / (double)TRACK_CUTS));
        high = low + width * ((at < TRACK_CUTS ? at + 1 : TRACK_CUTS) / (double)TRACK_CUTS);
        low = low + width * ((at ? at - 1 : 0) / (double)TRACK_CUTS);
    }
    return best;
}

/* The place in a span, inside at its beginning and outside at its end, where joint `joint` meets its limit, or any one
   that moves where that is negative. */
static double zero_in(const Track *t, const Span *span, const double *turns, int joint) {
    double low = 0.0, high = 1.0, x[MOST_TRACKED];
    for (int pass = 0; pass < TRACK_ROUNDS; pass++) {
        double width = high - low;
        int at = 1;
        for (; at < TRACK_CUTS; at++) {
            on_span(t, span, low + width * (at / (double)TRACK_CUTS), x);
            if ((joint < 0 ? margin_with(t, x, turns) : room_of(t, joint, x[joint] + turns[joint])) < 0.0)
                break;
        }
        high = low + width * (at / (double)TRACK_CUTS);
        low = low + width * ((at - 1) / (double)TRACK_CUTS);
    }
    return span->a + (span->b - span->a) * low;
}

static int by_place(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Where two joints or more meet their limits between samples i and i + 1, with given full turns: places into `more`. */
static int meetings_between(const Track *t, const Sample *a, const double *turns, Rows *more) {
    double first[MOST_TRACKED], x[MOST_TRACKED], place;
    int near[MOST_TRACKED], count = 0, n = t->n;
    for (int i = 0; i < n; i++) {
        double here = fabs(room_of(t, i, a[0].x[i] + turns[i])), there = fabs(room_of(t, i, a[1].x[i] + turns[i]));
        near[i] = (here < there ? here : there) <= TRACK_KINK;
        count += near[i];
    }
    if (count < 2)
        return 1;
    Span span = {.a = a[0].u, .b = a[1].u};
    put_spans(t, &span, 1);
    for (int i = 0; i < n; i++)
        first[i] = 0.0;
    for (int part = 0; part <= TRACK_CUTS; part++) {
        on_span(t, &span, part / (double)TRACK_CUTS, x);
        for (int i = 0; i < n; i++) {
            double inside = room_of(t, i, x[i] + turns[i]) >= 0.0;
            if (part && near[i] && inside != first[i]) {
                double f = (part - 1) / (double)TRACK_CUTS, g = part / (double)TRACK_CUTS, width = a[1].u - a[0].u;
                double from = a[0].u + width * f, to = a[0].u + width * g, *row, exact[MOST_TRACKED];
                Span own = {.a = inside != 0.0 ? to : from, .b = inside != 0.0 ? from : to};
                Waiting w;
                put_spans(t, &own, 1);
                place = zero_in(t, &own, turns, i);
                w.count = 0;
                point_at(t, &w, place, exact);
                if (w.count)
                    made_exact(t, &w);
                if (inside_with(t, exact, turns)) {
                    if (!(row = new_row(more)))
                        return 0;
                    *row = place;
                }
            }
            first[i] = inside;
        }
    }
    return 1;
}

/* Places where the margin's sign may depend on more than samples tell: `more`. 0 where there is no memory. */
static int more_places(const Track *t, const Sample *s, ptrdiff_t count, Rows *more) {
    int round = t->closed && count > 1, n = t->n, good = 1;
    double signs[2 * AT_A_TIME];
    Span *spans = malloc(2 * AT_A_TIME * sizeof(Span));
    ptrdiff_t many = 0;
    if (!spans)
        return 0;
    for (ptrdiff_t i = 0; i < count && good; i++) {
        double m = s[i].margin, before = i ? s[i - 1].margin : round ? s[count - 2].margin : m;
        double after = i + 1 < count ? s[i + 1].margin : round ? s[1].margin : m;
        int peak = m >= before && m >= after && m < 0.0 && m > -TRACK_KINK && (m > before || m > after);
        int dip = m <= before && m <= after && m >= 0.0 && m < TRACK_NEARLY && (m < before || m < after);
        for (int side = 0; (peak || dip) && side < 2; side++) {
            if (side ? i + 1 >= count : !i)
                continue;
            spans[many].a = s[side ? i : i - 1].u;
            spans[many].b = s[side ? i + 1 : i].u;
            signs[many++] = peak ? -1.0 : 1.0;
        }
        if (many && (many >= 2 * AT_A_TIME - 1 || i + 1 == count)) {
            put_spans(t, spans, many);
            for (ptrdiff_t k = 0; k < many && good; k++) {
                double *row = new_row(more);
                good = row != NULL;
                if (row)
                    *row = least_in(t, spans + k, signs[k]);
            }
            many = 0;
        }
    }
    free(spans);
    for (ptrdiff_t i = 0; i + 1 < count && good; i++) {
        double a = s[i].margin, b = s[i + 1].margin, turns[MOST_TRACKED], others[MOST_TRACKED];
        int better = a > b, differ = 0;
        if (!((a < b ? a : b) < 0.0) || !((a > b ? a : b) > -TRACK_KINK))
            continue;
        turned_of(t, s[better ? i : i + 1].x, turns);
        turned_of(t, s[better ? i + 1 : i].x, others);
        for (int j = 0; j < n; j++)
            differ |= turns[j] != others[j];
        good = meetings_between(t, s + i, turns, more) && (!differ || meetings_between(t, s + i, others, more));
    }
    return good;
}

/* The samples of a curve by place, and how many; NULL where there is no memory. */
static Sample *samples_of(const Track *t, ptrdiff_t *count) {
    ptrdiff_t m = t->last * TRACK_PARTS + 1;
    Sample *s = malloc((size_t)m * sizeof(Sample)), *all;
    Rows more = {NULL, 0, 0, 1};
    Waiting w;
    if (!s)
        return NULL;
    w.count = 0;
    for (ptrdiff_t i = 0; i < m; i++) {
        s[i].u = (double)i / TRACK_PARTS;
        cubic_at(t, s[i].u, s[i].x, NULL);
        s[i].margin = margin_of(t, s[i].x);
    }
    for (ptrdiff_t i = 0; i < m; i++)
        if (fabs(s[i].margin) <= TRACK_NEARLY && i % TRACK_PARTS)
            point_at(t, &w, s[i].u, s[i].x);
    if (w.count)
        made_exact(t, &w);
    for (ptrdiff_t i = 0; i < m; i++)
        if (fabs(s[i].margin) <= TRACK_NEARLY && i % TRACK_PARTS)
            s[i].margin = margin_of(t, s[i].x);
    *count = m;
    if (!more_places(t, s, m, &more) || !(all = more.used ? malloc((size_t)(m + more.used) * sizeof(Sample)) : s)) {
        free(more.v);
        free(s);
        return NULL;
    }
    if (!more.used)
        return s;
    qsort(more.v, (size_t)more.used, sizeof(double), by_place);
    ptrdiff_t from = 0, k = 0;
    for (ptrdiff_t i = 0; i < m; i++) {
        for (; k < more.used && more.v[k] <= s[i].u; k++) {
            double u = more.v[k];
            if ((k && u == more.v[k - 1]) || u * TRACK_PARTS == rounded(u * TRACK_PARTS))
                continue;
            all[from].u = u;
            point_at(t, &w, u, all[from++].x);
        }
        all[from++] = s[i];
    }
    if (w.count)
        made_exact(t, &w);
    free(more.v);
    free(s);
    *count = from;
    return all;
}

/* Samples in a row within the limits: see `arcs._Run`. */
typedef struct {
    double start, turns[MOST_TRACKED], inside[2], outside[2];
} Run;

/* From sample `start` both ways while the limits hold; its samples are taken out of `depth`. */
static void followed_run(const Track *t, const Sample *s, ptrdiff_t many, ptrdiff_t start, double *depth, Run *run) {
    int closed = t->closed && many > 1, n = t->n;
    ptrdiff_t count = closed ? many - 1 : many;
    run->start = s[start].u;
    turned_of(t, s[start].x, run->turns);
    for (int way = 0; way < 2; way++) {
        ptrdiff_t step = way ? 1 : -1, length = closed ? count + 1 : way ? many - start : start + 1;
        double place = s[start].u, before = place;
        ptrdiff_t k = 0;
        for (; k < length; k++) {
            ptrdiff_t at = start + step * k, rounds = 0;
            double x[MOST_TRACKED];
            if (closed) {
                rounds = at >= 0 ? at / count : -((count - 1 - at) / count);
                at -= rounds * count;
            }
            for (int i = 0; i < n; i++)
                x[i] = s[at].x[i] + (double)rounds * (closed ? t->round[i] : 0.0);
            place = s[at].u + (double)rounds * (double)t->last;
            if (k && !inside_with(t, x, run->turns))
                break;
            depth[at] = -HUGE_VAL;
            before = place;
        }
        run->inside[way] = before;
        run->outside[way] = k < length ? place : before;
    }
    if (closed)
        depth[many - 1] = depth[0] < depth[many - 1] ? depth[0] : depth[many - 1];
}

/* The end of a run one way, exactly. */
static double end_of(const Track *t, const Run *run, int way) {
    double x[2][MOST_TRACKED];
    Waiting w;
    if (run->inside[way] == run->outside[way])
        return run->inside[way];
    w.count = 0;
    point_at(t, &w, run->inside[way], x[0]);
    point_at(t, &w, run->outside[way], x[1]);
    if (w.count)
        made_exact(t, &w);
    if (!(margin_with(t, x[0], run->turns) > ARC_ON_LIMIT) || !(margin_with(t, x[1], run->turns) < 0.0))
        return run->inside[way];
    Span span = {.a = run->inside[way], .b = run->outside[way]};
    put_spans(t, &span, 1);
    return zero_in(t, &span, run->turns, -1);
}

/* An end of a piece, with the joint that ends it at its limit exactly. */
static void put_on_limit(const Track *t, double *x) {
    double worst = -HUGE_VAL, normal[MOST_TRACKED] = {0.0}, new[MOST_TRACKED], zero[MOST_TRACKED] = {0.0};
    int joint = 0, upper = 0, n = t->n;
    Waiting w;
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < n; i++) {
            double beyond = t->moving[i] == 0.0 ? -HUGE_VAL : side ? x[i] - t->high[i] : t->low[i] - x[i];
            if (beyond > worst) {
                worst = beyond;
                joint = i;
                upper = side;
            }
        }
    if (!(fabs(worst) <= ARC_END))
        return;
    memcpy(new, x, (size_t)n * sizeof(double));
    new[joint] = upper ? t->high[joint] : t->low[joint];
    normal[joint] = 1.0;
    w.count = 0;
    put_waiting(t, &w, new, normal, new);
    made_exact(t, &w);
    if (!(w.off[0] <= TRACK_CLOSES) || !inside_with(t, new, zero))
        return;
    for (int i = 0; i < n; i++)
        if (!(fabs(new[i] - x[i]) <= ARC_END))
            return;
    memcpy(x, new, (size_t)n * sizeof(double));
}

/* A piece from `first` to `last`: its row in `pieces`, and its configurations in `points`. */
static int put_piece(const Track *t, int number, const Run *run, double first, double last, Rows *pieces,
                     Rows *points) {
    int whole = t->closed && last - first >= (double)t->last - ARC_ROUND, n = t->n;
    ptrdiff_t begun = points->used;
    double *row = new_row(pieces), from, to;
    if (!row)
        return 0;
    if (whole) {
        /* One round, with the start amid it as far as the limits allow. */
        double length = (double)t->last, amid = run->start - 0.5 * length;
        first = amid > first ? amid : first;
        first = first < last - length ? first : last - length;
        last = first + length;
    }
    from = floor(first * ARC_FINE) + 1.0;
    to = ceil(last * ARC_FINE);
    ptrdiff_t inner = to > from ? (ptrdiff_t)(to - from) : 0, count = inner + 2;
    int short_one = inner < ARC_INNER - 2, point = last - first <= ARC_POINT;
    count = point ? 1 : short_one ? ARC_INNER : count;
    for (ptrdiff_t k = 0; k < count; k++)
        if (!new_row(points))
            return 0;
    Waiting w;
    w.count = 0;
    for (ptrdiff_t k = 0; k < count; k++) {
        double u = !k ? first : k + 1 == count ? last : short_one ? first + (last - first) / (ARC_INNER - 1) * (double)k
                                                                  : (from + (double)(k - 1)) / ARC_FINE;
        point_at(t, &w, point ? 0.5 * (first + last) : u, points->v + n * (begun + k));
    }
    if (w.count)
        made_exact(t, &w);
    for (ptrdiff_t k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            points->v[n * (begun + k) + i] += run->turns[i];
    if (!whole) {
        put_on_limit(t, points->v + n * begun);
        if (count > 1)
            put_on_limit(t, points->v + n * (begun + count - 1));
    }
    row[0] = number;
    row[1] = whole;
    row[2] = (double)count;
    return 1;
}

/* The pieces of a curve within the limits, that with the greatest margin first. 0 where there is no memory. */
static int put_pieces(const Track *t, int number, Rows *pieces, Rows *points) {
    ptrdiff_t many = 0;
    double zero[MOST_TRACKED];
    int good = 1;
    Sample *s = samples_of(t, &many);
    double *depth = s ? malloc((size_t)many * sizeof(double)) : NULL;
    if (!depth) {
        free(s);
        return 0;
    }
    for (ptrdiff_t i = 0; i < many; i++) {
        turned_of(t, s[i].x, zero);
        depth[i] = inside_with(t, s[i].x, zero) ? margin_with(t, s[i].x, zero) : -HUGE_VAL;
    }
    while (good) {
        ptrdiff_t start = 0;
        Run run;
        for (ptrdiff_t i = 1; i < many; i++)
            start = depth[i] > depth[start] ? i : start;
        if (!(depth[start] > -HUGE_VAL))
            break;
        followed_run(t, s, many, start, depth, &run);
        double first = end_of(t, &run, 0);
        good = put_piece(t, number, &run, first, end_of(t, &run, 1), pieces, points);
    }
    free(s);
    free(depth);
    return good;
}
