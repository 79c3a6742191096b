/* Closed forms on LANES targets at a time, or on the LANES roots of one; compiled as lanes.h is, after it.

   A tape gives the joint values of every real root. They are proven by the chain, wrapped, put in order and turned into
   the limits, as robokin.inverse.one_target and verify do it. What is not plain is left to these: a candidate that is
   not exact, an odd number of solutions, solutions near to each other or to limits where the arm may be
   singular. That there is none is an answer where every root is clearly complex.
*/

#include "tape.h"

#include <stdint.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Residual (sizes, radians) up to which a root is a solution as it is. */
#define EXACT_ENOUGH 1e-12
/* Weighted sums of |q| / pi that differ by less: solutions may be about to meet, or be the same. */
#define CLOSE 1e-4
#define SAME 1e-5
/* Angles below this count as half a turn. */
#define LEAST (1e-9 - 3.14159265358979323846)
/* Least singular value of a Jacobian that is singular for the second look: where roots are missing, and where as many
   are found as there are. (residual / SURE)^(1/2) is one, too. */
#define SINGULAR 5e-6
#define TOLD_APART 1e-6
#define SURE 0.05
/* What is outside its limits by no more may stand for a solution inside: where singular, and anywhere. */
#define NEIGHBOURS 4e-3
#define BESIDE 2e-5

/* atan2(y, x): on [0, tan(pi/8)] the polynomial of fdlibm's atan (Sun Microsystems, 1993, freely distributable). */
static inline double arc(double y, double x) {
    double u = fabs(x), v = fabs(y);
    double great = u > v ? u : v, small = u > v ? v : u;
    int big = small > 0.41421356237309503 * great;
    double above = big ? small - great : small, below = big ? small + great : great;
    double t = above / (below > 0.0 ? below : 1.0);
    double z = t * t, w = z * z;
    double even = 3.33333333333329318027e-01 +
                  w * (1.42857142725034663711e-01 +
                       w * (9.09088713343650656196e-02 +
                            w * (6.66107313738753120669e-02 + w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02))));
    double odd = -1.99999999998764832476e-01 +
                 w * (-1.11111104054623557880e-01 +
                      w * (-7.69187620504482999495e-02 + w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02)));
    double a = t - t * (z * even + w * odd);
    a = big ? 7.85398163397448278999e-01 + (a + 3.06161699786838301793e-17) : a;
    a = v > u ? 1.57079632679489655800e+00 - (a - 6.12323399573676603587e-17) : a;
    a = copysign(1.0, x) < 0.0 ? 3.14159265358979311600e+00 - (a - 1.22464679914735317722e-16) : a;
    return copysign(a, y);
}

typedef double Slot[LANES];
typedef long long Truth[LANES];

/* What a tape leaves: its registers, the real roots by level (all in one row where roots are lanes), and the lanes that
   have no answer, a short lever, or a root that is nearly real. */
typedef struct {
    Slot v[MOST_SLOTS];
    Truth real[MOST_LEVELS + 1][MOST_ROOTS];
    Truth lost, near, almost;
} Worked;

#define OVER_LANES for (int l = 0; l < LANES; l++)

static const Bits SIGN = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};

static int all(const Truth truth) {
    long long every = -1;
    OVER_LANES every &= truth[l];
    return every != 0;
}

#define EVERY(body)                                                                                                    \
    for (int k = 0; k < wide; k++)                                                                                     \
        for (int h = 0; h < PARTS; h++) {                                                                              \
            Part x = ((const Part *)a[k & mask_a])[h], y = ((const Part *)b[k & mask_b])[h];                           \
            (void)y;                                                                                                   \
            body;                                                                                                      \
        }                                                                                                              \
    break

#define EACH(expression) EVERY(((Part *)out[k])[h] = (expression))

static __attribute__((noinline)) void square_roots(const double *x, double *out) {
    double taken[LANES];
    OVER_LANES taken[l] = sqrt(x[l]);
    memcpy(out, taken, sizeof taken);
}

static __attribute__((noinline)) void arcs(const double *restrict y, const double *restrict x, double *restrict out) {
    OVER_LANES out[l] = arc(y[l], x[l]);
}

/* Run a tape. With `flat` the lanes are the roots of one target, bit k of a lane choosing the root of level k + 1. */
static inline void run_tape(const Form *form, Worked *at, int flat) {
    int wide = 1;
    for (int k = 0; k <= MOST_LEVELS; k++)
        OVER_LANES at->real[k][0][l] = -1;
    OVER_LANES at->lost[l] = at->near[l] = at->almost[l] = 0;
    for (const Step *step = form->tape, *end = step + form->steps; step < end; step++) {
        Slot *out = at->v + step->out.slot;
        const Slot *a = at->v + step->a.slot, *b = at->v + step->b.slot, *c = at->v + step->c.slot,
                   *d = at->v + step->d.slot;
        int level = step->out.level;
        int mask_a = flat ? 0 : (1 << step->a.level) - 1, mask_b = flat ? 0 : (1 << step->b.level) - 1,
            mask_c = flat ? 0 : (1 << step->c.level) - 1, mask_d = flat ? 0 : (1 << step->d.level) - 1;
        Truth *real = at->real[flat ? 0 : level];
        wide = flat ? 1 : 1 << level;
        switch (step->op) {
        case ADDED:
            EACH(x + y);
        case LESS:
            EACH(x - y);
        case TIMES:
            EACH(x * y);
        case PAIRED:
            EACH(x * y + ((const Part *)c[k & mask_c])[h] * ((const Part *)d[k & mask_d])[h]);
        case CROSSED:
            EACH(x * y - ((const Part *)c[k & mask_c])[h] * ((const Part *)d[k & mask_d])[h]);
        case OVER:
            EACH(x / y);
        case MINUS:
            EACH(-x);
        case MAGNITUDE:
            EACH((Part)((Bits)x & ~SIGN));
        case SIGNED:
            EACH((Part)(((Bits)x & ~SIGN) | ((Bits)y & SIGN)));
        case CLAMPED:
            EACH(chosen(x < -ONE, -ONE, chosen(x > ONE, ONE, x)));
        case GREATER:
            EACH(chosen(x > y, x, y));
        case CHOSEN:
            EACH(chosen(x > 0.0 * ONE, y, ((const Part *)c[k & mask_c])[h]));
        case ROOT:
            for (int k = 0; k < wide; k++)
                square_roots(a[k & mask_a], out[k]);
            break;
        case ANGLE:
            for (int k = 0; k < wide; k++)
                arcs(a[k & mask_a], b[k & mask_b], out[k]);
            break;
        case ENTERED:
            if (!flat)
                for (int k = 0; k < wide; k++)
                    OVER_LANES real[k][l] = at->real[level - 1][k & (wide / 2 - 1)][l];
            break;
        case BOTH:
            if (flat)
                OVER_LANES out[0][l] = (l >> (level - 1)) & 1 ? b[0][l] : a[0][l];
            else
                for (int k = 0; k < wide; k++) {
                    const double *chosen = k >> (level - 1) ? b[k & mask_b] : a[k & mask_a];
                    OVER_LANES out[k][l] = chosen[l];
                }
            break;
        case REAL:
            EVERY(Part off = y - x; /* what is no number, or without end, says nothing */
                  ((Bits *)at->almost)[h] |=
                  ((Bits *)real[k])[h] & ~(x >= y) & ~((off > CLEARLY_COMPLEX * ONE) & (off < INFINITY * ONE));
                  ((Bits *)real[k])[h] &= x >= y);
        case NEEDED:
            EVERY(((Bits *)at->lost)[h] |= ((Bits *)real[k])[h] & ~(x >= y));
        case LEVER:
            EVERY(((Bits *)at->lost)[h] |= ((Bits *)real[k])[h] & ~(x >= LEAST_LEVER * ONE);
                  ((Bits *)at->near)[h] |= ((Bits *)real[k])[h] & ~(x >= y));
        }
    }
}

/* The loop's last link L6 = C6 T^-1 C0 of LANES targets, T's rotation being T^-1's transposed. */
static void closing(const Form *form, const Slot T[12], Slot *L) {
    const double *C = form->last, *E = form->first;
    Slot R[12], P[12];
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            OVER_LANES R[3 * c + r][l] = T[3 * r + c][l];
        OVER_LANES R[9 + r][l] =
            -(T[3 * r][l] * T[9][l] + T[3 * r + 1][l] * T[10][l] + T[3 * r + 2][l] * T[11][l]) / form->unit;
    }
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++) {
            double more = c == 3 ? C[9 + r] : 0.0;
            OVER_LANES P[3 * c + r][l] =
                C[r] * R[3 * c][l] + C[3 + r] * R[3 * c + 1][l] + C[6 + r] * R[3 * c + 2][l] + more;
        }
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) {
            Slot *to = L + 4 * r + c;
            OVER_LANES (*to)[l] = P[r][l] * E[3 * c] + P[3 + r][l] * E[3 * c + 1] + P[6 + r][l] * E[3 * c + 2];
            if (c == 3)
                OVER_LANES (*to)[l] += P[9 + r][l];
        }
}

/* Whether the least singular values of the Jacobians at `count` roots are above `least`: 1 / |J^-1| is less. */
static int regular(const Form *form, double q[SIX][LANES], int count, const double *least) {
    double rows[LANES][SIX], J[LANES][SIX][SIX];
    for (int l = 0; l < count; l++)
        for (int i = 0; i < SIX; i++)
            rows[l][i] = q[i][l];
    NAMED(jacobians)(&form->chain, rows[0], count, form->size, 0, J[0][0]);
    for (int l = 0; l < count; l++) {
        double A[SIX][2 * SIX], sum = 0.0;
        for (int r = 0; r < SIX; r++)
            for (int c = 0; c < SIX; c++) {
                A[r][c] = J[l][r][c];
                A[r][SIX + c] = r == c;
            }
        for (int i = 0; i < SIX; i++) {
            int best = i;
            for (int r = i + 1; r < SIX; r++)
                if (fabs(A[r][i]) > fabs(A[best][i]))
                    best = r;
            if (!(fabs(A[best][i]) > 1e-12))
                return 0;
            for (int c = 0; c < 2 * SIX; c++) {
                double kept = A[i][c];
                A[i][c] = A[best][c];
                A[best][c] = kept;
            }
            double scale = 1.0 / A[i][i];
            for (int c = i; c < 2 * SIX; c++)
                A[i][c] *= scale;
            for (int r = 0; r < SIX; r++) {
                double factor = A[r][i];
                if (r == i || factor == 0.0)
                    continue;
                for (int c = i; c < 2 * SIX; c++)
                    A[r][c] -= factor * A[i][c];
            }
        }
        for (int r = 0; r < SIX; r++)
            for (int c = SIX; c < 2 * SIX; c++)
                sum += A[r][c] * A[r][c];
        if (!(sum * least[l] * least[l] < 0.9))
            return 0;
    }
    return 1;
}

/* How far the poses at q are from a target (4, 4), distances and angles by chords. */
static void proven(const Form *form, const double *T, double q[SIX][LANES], Slot position, Slot angle) {
    double s[MOST_JOINTS][LANES], c[MOST_JOINTS][LANES];
    Frame F;
    for (int i = 0; i < SIX; i++)
        OVER_LANES s[i][l] = q[i][l] + form->chain.offsets[i];
    sines(&form->chain, s, c);
    start(&form->chain, &F);
    for (int i = 0; i < SIX; i++)
        moved(&form->chain, i, &F, s, c);
    FOR_PARTS {
        Part sum[2] = {0.0 * ONE, 0.0 * ONE};
        for (int j = 0; j < 12; j++) {
            Part off = T[4 * (j % 3) + j / 3] - PART(F.v[j]);
            sum[j / 9] += off * off;
        }
        PART(angle) = 0.5 * sum[0];
        PART(position) = sum[1];
    }
    square_roots(angle, angle);
    square_roots(position, position);
}

/* Turn an angle by full turns into its limits, where that can be. */
static int fitted(const Form *form, int i, double *value) {
    double low = form->low[i], high = form->high[i];
    if (low <= *value && *value <= high)
        return 1;
    double least = ceil((low - *value) / TURN), most = floor((high - *value) / TURN);
    if (!(least <= most))
        return 0;
    double by = least > 0.0 ? least : 0.0;
    *value += TURN * (by < most ? by : most);
    return low <= *value && *value <= high;
}

/* Whether some angle is farther outside its limits than `least`, full turns not counted. */
static int outside(const Form *form, double q[SIX][LANES], int l, double least) {
    for (int i = 0; i < SIX; i++) {
        double value = q[i][l], ends[2] = {form->low[i], form->high[i]};
        if (!form->bounded[i] || (ends[0] <= value && value <= ends[1]))
            continue;
        int far = 1;
        for (int k = 0; k < 2; k++) {
            double off = value - ends[k];
            if (fabs(ends[k]) < INFINITY)
                far &= fabs(off - TURN * rint(off / TURN)) > least;
        }
        if (far)
            return 1;
    }
    return 0;
}

/* Turn the angles of `count` solutions next to the wish and into the limits; which are within. 0 where one outside may
   stand for one inside; where that is so only of an arm that is singular there it is a doubt. */
static int limited(const Form *form, const Wanted *wanted, double q[SIX][LANES], int count, Truth inside, int *doubt) {
    if (wanted->wish)
        for (int i = 0; i < SIX; i++)
            for (int l = 0; l < count; l++)
                q[i][l] += TURN * rint((wanted->wish[i] - q[i][l]) / TURN);
    OVER_LANES inside[l] = -1;
    for (int i = 0; i < SIX; i++) {
        Truth fits;
        if (!form->bounded[i])
            continue;
        FOR_PARTS {
            Part x = PART(q[i]);
            BITS(fits) = (x >= form->low[i] * ONE) & (x <= form->high[i] * ONE);
        }
        if ((form->beyond[i] || wanted->wish) && !all(fits))
            for (int l = 0; l < count; l++)
                fits[l] = fitted(form, i, &q[i][l]) ? -1 : 0;
        FOR_PARTS BITS(inside) &= BITS(fits);
    }
    if (wanted->limits && !all(inside))
        for (int l = 0; l < count; l++)
            if (!inside[l] && !outside(form, q, l, NEIGHBOURS)) {
                if (!outside(form, q, l, BESIDE))
                    return 0;
                *doubt = 1;
            }
    return 1;
}

/* Angles in (-pi, pi]; the key of each root for the order; its weighted sum of |q| / pi. */
static void told(double q[SIX][LANES], Slot key, Slot sum) {
    /* 1 + the fractions of multiples of the golden ratio, as verify has them. */
    static const double weights[SIX] = {1.6180339887498949, 1.2360679774997898, 1.8541019662496847,
                                        1.4721359549995796, 1.0901699437494745, 1.7082039324993694};
    FOR_PARTS {
        Part keys = {0.0}, sums = {0.0};
        for (int i = 0; i < SIX; i++) {
            double half = i ? 0.5 * 8191.0 : 0.5 * 16383.0, cells = i ? 8192.0 : 16384.0;
            Part x = PART(q[i]), shift = SHIFT * ONE, away = (Part)((Bits)x & ~SIGN);
            Part turns = chosen(away <= PI * ONE, 0.0 * ONE, (x * (0.5 / PI) + shift) - shift);
            x += turns * -TURN;
            PART(q[i]) = x = chosen(x >= LEAST * ONE, x + 0.0, x + TURN);
            sums += weights[i] * (Part)((Bits)x & ~SIGN);
            if (i < 4)
                keys = keys * cells + ((x / PI * half + (half + 0.31) + shift) - shift);
        }
        PART(key) = keys;
        PART(sum) = sums / PI;
    }
}

/* Whether two roots may be the same: all angles are, but for full turns. */
static int same(double q[SIX][LANES], int k, int l) {
    for (int i = 0; i < SIX; i++)
        if (fabs(remainder(q[i][k] - q[i][l], TURN)) > SAME)
            return 0;
    return 1;
}

/* The place of each of `count` roots in the order of their keys; 0 where two are in one place, or the same root. Whether
   two may be about to meet is a doubt. */
static int ordered(double q[SIX][LANES], const Slot key, const Slot sum, int count, Truth place, int *doubt) {
    Truth close;
    long long places = 0, meeting = 0;
    OVER_LANES place[l] = close[l] = 0;
    for (int k = 0; k < count; k++)
        FOR_PARTS {
            BITS(place) -= key[k] * ONE < CONSTANT(key);
            BITS(close) -= (Part)((Bits)(CONSTANT(sum) - sum[k] * ONE) & ~SIGN) < CLOSE * ONE;
        }
    for (int l = 0; l < count; l++) {
        places += place[l];
        meeting += close[l];
    }
    if (meeting > count) {
        *doubt = 1;
        for (int k = 1; k < count; k++)
            for (int l = 0; l < k; l++)
                if (fabs(sum[l] - sum[k]) < SAME && same(q, k, l))
                    return 0;
    }
    return places == count * (count - 1) / 2;
}

/* The solutions for a target from the joint values q of `count` roots, which are put into `out`; 0 where they are left
   to others. Lanes beyond `count` repeat a root. `doubt` says whether the arm may be singular at one. */
static int finished(const Form *form, const double *T, double q[SIX][LANES], int count, int doubt,
                    const Wanted *wanted, Solutions *out) {
    Slot position, angle, key, sum;
    double least[LANES] = {0.0};
    Truth inside, place, exact;
    proven(form, T, q, position, angle);
    FOR_PARTS BITS(exact) =
        (PART(position) / form->size <= EXACT_ENOUGH * ONE) & (PART(angle) <= EXACT_ENOUGH * ONE);
    if (!all(exact))
        return 0;
    told(q, key, sum);
    if (!ordered(q, key, sum, count, place, &doubt) || !limited(form, wanted, q, count, inside, &doubt))
        return 0;
    if (doubt) {
        for (int l = 0; l < count; l++) {
            double off = fmax(position[l] / form->size, angle[l]);
            least[l] = fmax(count == form->leaves << form->levels ? TOLD_APART : SINGULAR, sqrt(off / SURE));
        }
        if (!regular(form, q, count, least))
            return 0;
    }
    int order[LANES], listed = 0;
    for (int l = 0; l < count; l++)
        order[place[l]] = l;
    for (int k = 0; k < count; k++) {
        int l = order[k];
        if (wanted->inside_only && !inside[l])
            continue;
        for (int i = 0; i < SIX; i++)
            out->q[SIX * listed + i] = q[i][l];
        out->position[listed] = position[l];
        out->angle[listed] = angle[l];
        out->inside[listed++] = inside[l] != 0;
    }
    out->listed = listed;
    return 1;
}

/* The joint values of a target's real roots, from lane `lane` of a tape, or with `flat` from all lanes. */
static int roots_of(const Form *form, const Worked *at, int flat, int lane, double q[SIX][LANES]) {
    int count = 0, every = 1 << form->levels;
    for (int k = 0; k < every; k++) {
        int row = flat ? 0 : k, l = flat ? k : lane;
        if (!at->real[flat ? 0 : form->levels][row][l])
            continue;
        for (int j = 0; j < form->leaves; j++, count++)
            for (int i = 0; i < SIX; i++) {
                Place from = form->leaf[j][i];
                int of = flat ? 0 : k & ((1 << from.level) - 1);
                q[i][count] = at->v[from.slot + of][l] - form->chain.offsets[i];
            }
    }
    for (int k = count; count && k < LANES; k++)
        for (int i = 0; i < SIX; i++)
            q[i][k] = q[i][0];
    return count;
}

static void begun(const Form *form, Worked *at) {
    for (int k = 0; k < form->constants; k++)
        OVER_LANES at->v[form->inputs + k][l] = form->value[k];
}

/* Whether there is clearly no solution for a target of which `count` real roots are known. */
static int nowhere(int count, long long lost, long long near, long long almost) {
    return !count && !lost && !near && !almost;
}

/* Whether a target may be looked at further: its roots are a proper number, none is missing. */
static int sound(const Form *form, int count, int near) {
    int all = form->leaves << form->levels;
    return count && count % 2 == 0 && !(near && count < all);
}

/* The number of solutions for one target T (4, 4), which are put into `out`; 0 where others are to look at it, and
   NONE_AT_ALL. */
int NAMED(solution)(const Form *form, const double *T, const Wanted *wanted, Solutions *out) {
    Worked at;
    Slot wish[12];
    double q[SIX][LANES];
    for (int j = 0; j < 12; j++)
        OVER_LANES wish[j][l] = T[4 * (j % 3) + j / 3];
    begun(form, &at);
    closing(form, wish, at.v);
    run_tape(form, &at, 1);
    long long lost = 0, near = 0, almost = 0;
    OVER_LANES {
        lost |= at.lost[l];
        near |= at.near[l];
        almost |= at.almost[l];
    }
    int count = lost ? 0 : roots_of(form, &at, 1, 0, q);
    if (nowhere(count, lost, near, almost))
        return NONE_AT_ALL;
    if (!sound(form, count, near != 0) || !finished(form, T, q, count, near != 0, wanted, out))
        return 0;
    return count;
}

/* The same for targets T (m, 4, 4), with room for all roots of each: how many solutions each has in `counts`, how many
   of these are put into `out` in `listed`, the rest of its rows being no numbers, and in `plain` whether it is
   answered. */
void NAMED(solutions)(const Form *form, const double *T, ptrdiff_t m, const Wanted *wanted, Solutions *out,
                      ptrdiff_t *counts, ptrdiff_t *listed, unsigned char *plain) {
    Worked at;
    Slot wish[12];
    double q[SIX][LANES];
    int most = form->leaves << form->levels;
    Solutions here = *out;
    begun(form, &at);
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        ptrdiff_t some = m - first < LANES ? m - first : LANES;
        for (int j = 0; j < 12; j++)
            OVER_LANES wish[j][l] = T[16 * (first + (l < some ? l : some - 1)) + 4 * (j % 3) + j / 3];
        closing(form, wish, at.v);
        run_tape(form, &at, 0);
        for (ptrdiff_t l = 0; l < some; l++) {
            int near = at.near[l] != 0, count = at.lost[l] ? 0 : roots_of(form, &at, 0, (int)l, q);
            int none = nowhere(count, at.lost[l], near, at.almost[l]);
            int done = none || (sound(form, count, near) &&
                                finished(form, T + 16 * (first + l), q, count, near, wanted, &here));
            int rows = done && !none ? here.listed : 0;
            plain[first + l] = (unsigned char)done;
            counts[first + l] = done ? count : 0;
            listed[first + l] = rows;
            for (int k = rows; k < most; k++) {
                for (int i = 0; i < SIX; i++)
                    here.q[SIX * k + i] = NAN;
                here.position[k] = here.angle[k] = NAN;
                here.inside[k] = 0;
            }
            here.q += SIX * most;
            here.position += most;
            here.angle += most;
            here.inside += most;
        }
    }
}

/* The signs that name configurations q (m, SIX), a bit for each. */
void NAMED(sides)(const Form *form, const double *q, ptrdiff_t m, ptrdiff_t *codes) {
    Worked at;
    double axes[MOST_JOINTS][6][LANES];
    Frame F;
    begun(form, &at);
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        ptrdiff_t count = m - first < LANES ? m - first : LANES;
        followed(&form->chain, q + first * SIX, count, axes, &F);
        for (int i = 0; i < SIX; i++)
            for (int r = 0; r < 3; r++)
                FOR_PARTS {
                    PART(at.v[3 * i + r]) = PART(axes[i][r]);
                    PART(at.v[3 * SIX + 3 * i + r]) = PART(axes[i][3 + r]) / form->size;
                }
        for (int r = 0; r < 3; r++)
            FOR_PARTS PART(at.v[6 * SIX + r]) = PART(F.v[9 + r]) / form->size;
        run_tape(form, &at, 0);
        for (ptrdiff_t l = 0; l < count; l++) {
            codes[first + l] = 0;
            for (int i = 0; i < form->leaves; i++)
                codes[first + l] |= (ptrdiff_t)(at.v[form->leaf[0][i].slot][l] >= -UNDECIDED) << i;
        }
    }
}
