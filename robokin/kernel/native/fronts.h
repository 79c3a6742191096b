/* The two ends of curves that are followed, all curves at once, as far as no crossing is met.

   Python's `fronts` is the reference, and says what is derived how. Comes after descents.h.
*/

#include <stdlib.h>

/* See `fronts`. */
#define FRONT_LONGEST 0.15
#define FRONT_SHORTEST 1e-4
#define THIN 1e-7
#define CROSSING 1e-4
#define DODGES 3
#define APPROACH 2e-3
#define GROWTH 1.6
#define STRAIGHT 0.98
#define CORRECTION 0.3
#define MEETS 0.2
#define SAME_PLACE 1e-5

/* Error at which corrections end. */
#define SETTLED 1e-13

/* What is at hand of a front. */
typedef struct {
    double *x, *t, *bend, *h, *second, *moved_on, *count, *alive, *ended;
} Front;

static Front front(const Fronts *all, ptrdiff_t row) {
    double *x = all->state + row * (3 * all->n + FRONT_NUMBERS), *rest = x + 3 * all->n;
    return (Front){x, x + all->n, x + 2 * all->n, rest, rest + 1, rest + 2, rest + 3, rest + 4, rest + 5};
}

static double inner(int n, const double *a, const double *b) {
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Guess k of a correction, of front `row`, in the plane at right angles to its tangent. */
static double *put_guess(const Fronts *all, ptrdiff_t k, ptrdiff_t row) {
    all->rows[k] = row;
    memcpy(all->T + 16 * k, all->targets + 16 * row, 16 * sizeof(double));
    memcpy(all->normals + all->n * k, front(all, row).t, (size_t)all->n * sizeof(double));
    all->most[k] = all->steps_of[row];
    return all->guess + all->n * k;
}

static void correct_guesses(const Chain *chain, const Fronts *all, ptrdiff_t count) {
    memcpy(all->led, all->guess, (size_t)(count * all->n) * sizeof(double));
    NAMED(corrected)(chain, all->T, all->normals, 1, all->most, all->led, count, all->size, SETTLED, THIN, all->off,
                     all->J);
}

/* Whether curve i has steps left, is not on a crossing, and has an end that goes on. */
static int goes_on(const Fronts *all, ptrdiff_t i) {
    return all->left[i] > 0.0 && all->waits[i] == 0.0 &&
           (*front(all, i).alive != 0.0 || *front(all, i + all->s).alive != 0.0);
}

/* Steps shortened so that fronts that face each other meet half way; those that have met are done. */
static void met(const Chain *chain, const Fronts *all) {
    int n = all->n;
    ptrdiff_t landing = 0;
    for (ptrdiff_t i = 0; i < all->s; i++) {
        Front a = front(all, i), b = front(all, i + all->s);
        double gap[MOST_MOVED];
        if (*a.alive == 0.0 || *b.alive == 0.0 || !goes_on(all, i))
            continue;
        for (int j = 0; j < n; j++) {
            gap[j] = b.x[j] - a.x[j];
            if (chain->revolute[j])
                gap[j] -= 6.28318530717958647692 * nearbyint(gap[j] / 6.28318530717958647692);
        }
        double distance = sqrt(inner(n, gap, gap)), ahead = inner(n, gap, a.t), h = *a.h < *b.h ? *a.h : *b.h;
        if (!(inner(n, a.t, b.t) < -0.9) || *a.count < 2.0 || *b.count < 2.0)
            continue;
        /* Not half and half: of a curve that is symmetric about its seed that may be where it crosses another. */
        if (ahead > 0.8 * distance && ahead < 2.5 * h) {
            *a.h = fmax(fmin(*a.h, 0.6 * ahead), FRONT_SHORTEST);
            *b.h = fmax(fmin(*b.h, 0.4 * ahead), FRONT_SHORTEST);
        }
        if (!(distance < fmax(MEETS * h, 2.0 * FRONT_SHORTEST)))
            continue;
        double *guess = put_guess(all, landing, i);
        for (int j = 0; j < n; j++) {
            guess[j] = a.x[j] + ahead * a.t[j];
            all->gaps[n * landing + j] = gap[j];
        }
        landing++;
    }
    correct_guesses(chain, all, landing);
    for (ptrdiff_t k = 0; k < landing; k++) {
        ptrdiff_t i = all->rows[k];
        Front a = front(all, i), b = front(all, i + all->s);
        int same = all->off[k] <= CORRECTION_CLOSES;
        for (int j = 0; j < n; j++)
            same = same && fabs(all->led[n * k + j] - a.x[j] - all->gaps[n * k + j]) <= 10.0 * SAME_PLACE;
        if (same) {
            all->closed[i] = 1.0;
            *a.alive = *b.alive = 0.0;
        }
    }
}

/* Steps of the inverse iteration for a least singular value, and when it has settled; smaller ones are Jacobi's. */
#define INVERSE_STEPS 24
#define INVERSE_SETTLED 1e-13
#define INVERSE_LEAST 1e-5

/* The null vector t of a Jacobian (6, 7) and its least singular value, by Householder's reflections of its rows and
   inverse iteration on what these leave, a triangle; 0 where that is not sure of itself. */
static int plain_tangent(const double *J, double *t, double *least) {
    double w[6][7], R[6][6], v[6], y[6], over[6], before = 0.0;
    for (int k = 0; k < 6; k++)
        memcpy(w[k], J + 7 * k, 7 * sizeof(double));
    for (int k = 0; k < 6; k++) {
        double length = sqrt(inner(7 - k, w[k] + k, w[k] + k)), squared;
        length = w[k][k] > 0.0 ? -length : length;
        if (!(fabs(length) > 1e-8))
            return 0;
        R[k][k] = length;
        over[k] = 1.0 / length;
        w[k][k] -= length;
        squared = inner(7 - k, w[k] + k, w[k] + k);
        for (int j = k + 1; j < 6; j++) {
            double part = 2.0 * inner(7 - k, w[k] + k, w[j] + k) / squared;
            for (int i = k; i < 7; i++)
                w[j][i] -= part * w[k][i];
            R[k][j] = w[j][k];
        }
    }
    for (int i = 0; i < 7; i++)
        t[i] = i == 6;
    for (int k = 5; k >= 0; k--) {
        double part = 2.0 * inner(7 - k, w[k] + k, t + k) / inner(7 - k, w[k] + k, w[k] + k);
        for (int i = k; i < 7; i++)
            t[i] -= part * w[k][i];
    }
    /* Uneven, so that it is at right angles to nothing that is meant. */
    for (int i = 0; i < 6; i++)
        v[i] = 0.3 + 0.61803398874989 * i - floor(0.61803398874989 * i);
    for (int step = 0; step < INVERSE_STEPS; step++) {
        double length = 1.0 / sqrt(inner(6, v, v)), quotient;
        for (int i = 0; i < 6; i++) {
            double sum = v[i] *= length;
            for (int j = 0; j < i; j++)
                sum -= R[j][i] * y[j];
            y[i] = sum * over[i];
        }
        /* Rayleigh's quotient of the inverse. */
        quotient = inner(6, y, y);
        for (int i = 5; i >= 0; i--) {
            double sum = y[i];
            for (int j = i + 1; j < 6; j++)
                sum -= R[i][j] * v[j];
            v[i] = sum * over[i];
        }
        if (fabs(quotient - before) <= INVERSE_SETTLED * quotient) {
            *least = 1.0 / sqrt(quotient);
            return *least > INVERSE_LEAST;
        }
        before = quotient;
    }
    return 0;
}

/* The null vector of a Jacobian (6, n), on in the direction of `before`, and the second least singular value; 0 where
   that is none and there are several. */
static int tangent_of(int n, const double *J, const double *before, double *t, double *second) {
    double w[MOST_ROWS][MOST_ROWS], V[MOST_ROWS][MOST_ROWS], values[MOST_ROWS];
    int wide = n > 6, c = wide ? 6 : n, p = wide ? n : 6, least = 0;
    if (n == 7 && plain_tangent(J, t, second)) {
        if (inner(n, t, before) < 0.0)
            for (int j = 0; j < n; j++)
                t[j] = -t[j];
        return 1;
    }
    for (int i = 0; i < c; i++)
        for (int r = 0; r < p; r++)
            w[i][r] = wide ? J[n * i + r] : J[n * r + i];
    jacobi(p, c, w, V);
    for (int i = 0; i < c; i++) {
        values[i] = sqrt(inner(p, w[i], w[i]));
        least = values[i] < values[least] ? i : least;
    }
    *second = HUGE_VAL;
    for (int i = 0; i < c; i++)
        if (wide || i != least)
            *second = values[i] < *second ? values[i] : *second;
    if (!(*second > THIN))
        return 0;
    for (int j = 0; j < n; j++)
        t[j] = wide ? before[j] : V[least][j];
    /* Of more joints than equations it is what the rows leave of the tangent before; twice, for the digits. */
    for (int pass = 0; wide && pass < 2; pass++)
        for (int i = 0; i < c; i++) {
            double part = inner(n, w[i], t) / (values[i] * values[i]);
            for (int j = 0; j < n; j++)
                t[j] -= part * w[i][j];
        }
    double length = sqrt(inner(n, t, t));
    if (!(length > 1e-8))
        return 0;
    length = inner(n, t, before) < 0.0 ? -length : length;
    for (int j = 0; j < n; j++)
        t[j] /= length;
    return 1;
}

/* Room for as many points as there are fronts. */
static int has_history(Fronts *all) {
    if (all->room - all->used >= 2 * all->s)
        return 1;
    ptrdiff_t more = 2 * all->room + 16 * all->s;
    double *larger = realloc(all->history, (size_t)(more * (2 + 2 * all->n)) * sizeof(double));
    if (!larger)
        return 0;
    all->history = larger;
    all->room = more;
    return 1;
}

/* What becomes of front `row`, whose guess k was led to `x`, where the tangent is t. */
static void judged_front(Fronts *all, ptrdiff_t k, ptrdiff_t row, const double *ahead, double second) {
    int n = all->n, beyond = 0;
    Front a = front(all, row);
    const double *x = all->led + n * k, *guess = all->guess + n * k;
    double moved = 0.0, length = 0.0;
    for (int j = 0; j < n; j++) {
        moved += (x[j] - guess[j]) * (x[j] - guess[j]);
        length += (x[j] - a.x[j]) * (x[j] - a.x[j]);
    }
    if (!(all->off[k] <= CORRECTION_CLOSES && inner(n, ahead, a.t) >= STRAIGHT && sqrt(moved) <= CORRECTION * *a.h)) {
        *a.h *= 0.5;
        memset(a.bend, 0, (size_t)n * sizeof(double));
        if (*a.h < FRONT_SHORTEST) {
            *a.alive = 0.0;
            *a.ended = FRONT_LOST;
        }
        return;
    }
    /* On a crossing itself Newton's steps are least exact: a little before it there is a better point. */
    if (second < CROSSING && *a.second >= CROSSING && *a.moved_on < DODGES) {
        *a.h *= 0.7;
        *a.moved_on += 1.0;
        return;
    }
    length = fmax(sqrt(length), FRONT_SHORTEST);
    *a.h = fmin(GROWTH * *a.h, FRONT_LONGEST);
    double rate = (*a.second - second) / length;
    if (rate > 0.0 && *a.second > THIN)
        *a.h = fmin(*a.h, fmax(0.5 * (second / rate), APPROACH));
    double *put = all->history + (2 + 2 * n) * all->used++;
    *put++ = (double)row;
    for (int j = 0; j < n; j++) {
        a.bend[j] = (ahead[j] - a.t[j]) / length;
        a.x[j] = put[j] = x[j];
        a.t[j] = put[n + j] = ahead[j];
        beyond |= x[j] < all->low[n * row + j] || x[j] > all->high[n * row + j];
    }
    *a.second = put[2 * n] = second;
    *a.moved_on = 0.0;
    *a.count += 1.0;
    if (beyond) {
        *a.alive = 0.0;
        *a.ended = FRONT_BOUND;
    }
}

/* Steps of all curves, as many as each has left, until they have come to their ends or to a crossing, where they wait.

   0 where there is no memory. */
int NAMED(advanced)(const Chain *chain, Fronts *all) {
    int n = all->n;
    for (ptrdiff_t i = 0; i < all->s; i++)
        all->waits[i] = all->steps_of[i] > all->plain_steps || all->steps_of[i + all->s] > all->plain_steps;
    for (;;) {
        ptrdiff_t count = 0;
        if (!has_history(all))
            return 0;
        met(chain, all);
        for (ptrdiff_t row = 0; row < 2 * all->s; row++) {
            Front a = front(all, row);
            if (*a.alive == 0.0 || !goes_on(all, row % all->s))
                continue;
            double *guess = put_guess(all, count++, row);
            for (int j = 0; j < n; j++)
                guess[j] = a.x[j] + *a.h * a.t[j] + 0.5 * *a.h * *a.h * a.bend[j];
        }
        if (!count)
            return 1;
        correct_guesses(chain, all, count);
        for (ptrdiff_t k = 0; k < count; k++)
            if (!tangent_of(n, all->J + 6 * n * k, front(all, all->rows[k]).t, all->tangents + n * k, all->seconds + k))
                all->waits[all->rows[k] % all->s] = 1.0;
        for (ptrdiff_t i = 0; i < all->s; i++)
            all->left[i] -= goes_on(all, i);
        for (ptrdiff_t k = 0; k < count; k++)
            if (all->waits[all->rows[k] % all->s] == 0.0)
                judged_front(all, k, all->rows[k], all->tangents + n * k, all->seconds[k]);
    }
}

/* The least singular value of each of some Jacobians (m, 6, n) of a rank of six at most. */
void NAMED(least_values)(const double *J, ptrdiff_t m, int n, double *least) {
    double t[7];
    for (ptrdiff_t k = 0; k < m; k++) {
        double w[MOST_ROWS][MOST_ROWS], V[MOST_ROWS][MOST_ROWS];
        const double *own = J + 6 * n * k;
        int wide = n > 6, c = wide ? 6 : n, p = wide ? n : 6;
        if (n == 7 && plain_tangent(own, t, least + k))
            continue;
        for (int i = 0; i < c; i++)
            for (int r = 0; r < p; r++)
                w[i][r] = wide ? own[n * i + r] : own[n * r + i];
        jacobi(p, c, w, V);
        least[k] = HUGE_VAL;
        for (int i = 0; i < c; i++)
            least[k] = fmin(least[k], sqrt(inner(p, w[i], w[i])));
    }
}
