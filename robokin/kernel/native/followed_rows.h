/* One branch of a chain along targets, row by row: Newton's steps of least motion from each to the next.

   Python's `Follower` is the reference, which also goes on where these stop. Comes after descents.h.
*/

/* See `follow`. */
#define FOLLOWED_STEPS 30
#define FOLLOWED_LONGEST 0.3
#define FOLLOWED_DAMPING 1e-3
#define FOLLOWED_NEAR 0.1
#define FOLLOWED_CLOSES 1e-10
#define HELD_CLOSES 1e-9
#define HELD_STEPS 40
#define FOLLOWED_SETTLED 1e-14

/* A slide as in `loop_newton.LONG`: steps along limits are left to Python then. */
#define FOLLOWED_LONG 30.0

/* Another solution is about as far as the least singular value; a row may be off where the last ones lead by this part
   of it, and nearer to a singular configuration than the other no row is taken. */
#define FOLLOWED_OFF 0.1
#define FOLLOWED_REGULAR 1e-3

/* A bound of the least singular value from L D Lt, D on the diagonal of A and D Lt right of it: the trace of the inverse
   adds up all inverse squares. */
static double least_value(double A[6][6]) {
    double inverse[6][6], trace = 0.0;
    for (int i = 0; i < 6; i++)
        for (int r = i; r < 6; r++) {
            inverse[r][i] = r == i;
            for (int k = i; k < r; k++)
                inverse[r][i] -= A[k][r] / A[k][k] * inverse[k][i];
            trace += inverse[r][i] * inverse[r][i] / A[r][r];
        }
    return trace > 0.0 ? 1.0 / sqrt(trace) : 0.0;
}

/* The damped step of least motion dx (n,) from an error e and a Jacobian J (6, n); what the least singular value is at
   least where `regular` asks for it. */
static void least_motion(int n, const double *J, const double e[6], double dx[MOST_MOVED], double *regular) {
    double A[6][6], y[6], off = 0.0, length = FOLLOWED_LONGEST;
    for (int r = 0; r < 6; r++)
        off = fabs(e[r]) > off ? fabs(e[r]) : off;
    for (int r = 0; r < 6; r++) {
        for (int c = r; c < 6; c++) {
            A[r][c] = 0.0;
            for (int i = 0; i < n; i++)
                A[r][c] += J[n * r + i] * J[n * c + i];
        }
        A[r][r] += FOLLOWED_DAMPING * (off * off + 1e-9);
        y[r] = e[r];
    }
    for (int k = 0; k < 6; k++) {
        for (int r = k + 1; r < 6; r++) {
            double f = A[k][r] / A[k][k];
            for (int c = r; c < 6; c++)
                A[r][c] -= f * A[k][c];
            y[r] -= f * y[k];
        }
    }
    if (regular)
        *regular = least_value(A);
    for (int k = 5; k >= 0; k--) {
        for (int c = k + 1; c < 6; c++)
            y[k] -= A[k][c] * y[c];
        y[k] /= A[k][k];
    }
    for (int i = 0; i < n; i++) {
        dx[i] = 0.0;
        for (int r = 0; r < 6; r++)
            dx[i] += J[n * r + i] * y[r];
        length = fabs(dx[i]) > length ? fabs(dx[i]) : length;
    }
    for (int i = 0; i < n; i++)
        dx[i] *= FOLLOWED_LONGEST / length;
}

/* The error e of values x (n,) [rad | size] and the Jacobian; the greatest |e|, no number where there is none. */
static double error_at(const Chain *chain, const double *T, const double *x, double size, double e[6], double *J) {
    double q[MOST_MOVED], off = 0.0;
    put_values(chain, x, size, q);
    NAMED(errors)(chain, T, q, 1, size, e, J);
    for (int r = 0; r < 6; r++)
        off = fabs(e[r]) > off || e[r] != e[r] ? fabs(e[r]) : off;
    return off;
}

/* Steps from x (n,) [rad | size] to the pose T; whether they close. `regular`: as `least_motion` has it. */
static int stepped_to(const Chain *chain, const double *T, double *x, double size, double *regular) {
    double e[6], J[6 * MOST_MOVED], dx[MOST_MOVED], next[MOST_MOVED];
    int n = chain->n;
    double off = error_at(chain, T, x, size, e, J);
    for (int step = 0; step < FOLLOWED_STEPS && off > FOLLOWED_CLOSES; step++) {
        least_motion(n, J, e, dx, NULL);
        for (int i = 0; i < n; i++)
            x[i] += dx[i];
        off = error_at(chain, T, x, size, e, J);
    }
    if (!(off <= FOLLOWED_CLOSES))
        return 0;
    least_motion(n, J, e, dx, regular);
    if (off > FOLLOWED_SETTLED) {
        /* A last step, to rounding. */
        for (int i = 0; i < n; i++)
            next[i] = x[i] + dx[i];
        if (error_at(chain, T, next, size, e, J) < off)
            memcpy(x, next, (size_t)n * sizeof(double));
    }
    return 1;
}

static int all_between(int n, const double *x, const double *low, const double *high) {
    int inside = 1;
    for (int i = 0; i < n; i++)
        inside &= x[i] >= low[i] && x[i] <= high[i];
    return inside;
}

static double farthest(int n, const double *x, const double *y) {
    double far = 0.0;
    for (int i = 0; i < n; i++)
        far = fabs(x[i] - y[i]) > far || x[i] != x[i] ? fabs(x[i] - y[i]) : far;
    return far;
}

/* The rows (m, n) [rad | size] that follow x (n,) at targets T (m, 4, 4), as far as that is plain; how many these are.

   opened: the last joints, that many, are no joints of the arm: they turn the tool as the task leaves it open.
   limits (4, n): the least and the greatest values, and these with what is tolerated; a joint that meets its limit is
   held there. ahead (n,): from which values, beside the last ones, steps begin; it becomes the last move of all, where
   joints are not to spare. listed: also each row must be far from other solutions. */
ptrdiff_t NAMED(followed_rows)(const Chain *chain, const double *T, ptrdiff_t m, double size, int opened,
                               const double *limits, const double *x, double *ahead, int spare, int listed,
                               double *out) {
    int n = chain->n, own = n - opened;
    double here[MOST_MOVED], next[MOST_MOVED], led[MOST_MOVED], target[16], regular = 0.0;
    memcpy(here, x, (size_t)n * sizeof(double));
    for (ptrdiff_t k = 0; k < m; k++) {
        int inside = all_between(own, here, limits + 2 * n, limits + 3 * n);
        memcpy(target, T + 16 * k, sizeof target);
        for (int i = own; i < n; i++)
            here[i] = 0.0;
        if (opened) {
            double q[MOST_MOVED], F[16];
            put_values(chain, here, size, q);
            NAMED(poses)(chain, q, 1, F);
            for (int r = 0; r < 3; r++)
                memcpy(target + 4 * r, F + 4 * r, 3 * sizeof(double));
        }
        for (int i = 0; i < n; i++)
            led[i] = here[i] + (i < own ? ahead[i] : 0.0);
        memcpy(next, led, sizeof next);
        if (!stepped_to(chain, target, next, size, listed ? &regular : NULL))
            return k;
        if (inside && !all_between(own, next, limits + 2 * n, limits + 3 * n)) {
            double far = 1.0, error[6];
            memcpy(next, here, sizeof next);
            for (int i = 0; i < n; i++)
                far = !chain->revolute[i] && fabs(here[i]) > far ? fabs(here[i]) : far;
            if (far > FOLLOWED_LONG || listed)
                return k;
            NAMED(descended)(chain, target, &far, next, 1, size, limits, limits + n, HELD_STEPS, error);
            for (int r = 0; r < 6; r++)
                if (!(fabs(error[r]) <= HELD_CLOSES))
                    return k;
        }
        if (!(farthest(own, next, here) <= FOLLOWED_NEAR))
            return k;
        if (listed && !(regular >= FOLLOWED_REGULAR && farthest(own, next, led) <= FOLLOWED_OFF * regular))
            return k;
        for (int i = 0; i < own && !spare; i++)
            ahead[i] = next[i] - here[i];
        memcpy(here, next, sizeof here);
        memcpy(out + n * k, here, (size_t)n * sizeof(double));
    }
    return m;
}
