/* Newton's steps of a chain towards targets, for LANES configurations at once; one that has come to its end makes room
   for the next, and where it ends does not depend on the others.

   Python's `least_squares` and `pose_correction` are the reference, and say what is derived how: descents with damped
   steps within limits, and steps of the shortest length onto curves of configurations. Comes after lanes.h.
*/

/* Rows of equations: those of the pose, of a plane, and of joints that are held. */
#define MOST_ROWS (6 + 1 + MOST_MOVED)

/* See `least_squares`. */
#define DESCENT_STEP 0.6
#define DESCENT_DAMPING 1e-2
#define DESCENT_FLOOR 1e-13
#define DESCENT_ARRIVED 1e-26

/* See `pose_correction`. */
#define CORRECTION_CLOSES 5e-10
#define CORRECTION_LONGEST 0.3
#define IDLE 0.02
#define IDLE_STEPS 4
#define PLAIN 1e-3
#define TRIFLE 1e-13
#define NO_TRIFLE 1e4

/* Sweeps of Jacobi's rotations, which take some eight, and the cosine of columns that are at right angles. */
#define MOST_SWEEPS 60
#define RIGHT_ANGLE 1e-15

/* A configuration's joint values [rad | size] in lane l, in the chain's own unit. */
static void put_values(const Chain *chain, const double *x, double size, double *q) {
    for (int i = 0; i < chain->n; i++)
        q[i] = chain->revolute[i] ? x[i] : x[i] * size;
}

/* The errors and Jacobians J (n, 6, LANES) of all lanes at values q. */
static void looked_at(const Chain *chain, const double *q, double W[12][LANES], double size, double e[6][LANES],
                      double J[][6][LANES]) {
    double axes[MOST_JOINTS][6][LANES];
    Frame F;
    followed(chain, q, LANES, axes, &F);
    for (int i = 0; i < chain->n; i++)
        column(chain, i, axes[i], &F, size, J[i]);
    pose_errors(&F, W, LANES, size, e);
}

/* y with A y = b in the place of b (n, LANES), for symmetric definite A (n, n, LANES), which is overwritten. */
static void definite_solved(int n, double A[MOST_MOVED][MOST_MOVED][LANES], double b[MOST_MOVED][LANES]) {
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++)
            FOR_PARTS {
                Part f = PART(A[k][i]) / PART(A[k][k]);
                for (int j = i; j < n; j++)
                    PART(A[i][j]) -= f * PART(A[k][j]);
                PART(b[i]) -= f * PART(b[k]);
            }
    for (int k = n - 1; k >= 0; k--)
        FOR_PARTS {
            Part sum = PART(b[k]);
            for (int j = k + 1; j < n; j++)
                sum -= PART(A[k][j]) * PART(b[j]);
            PART(b[k]) = sum / PART(A[k][k]);
        }
}

/* What is kept of the descents of all lanes. */
typedef struct {
    double x[LANES][MOST_MOVED], best[LANES][MOST_MOVED], left[LANES][6];
    double far[LANES], least[LANES];
    int made[LANES];
    ptrdiff_t place[LANES];
} Descents;

/* The damped step of all lanes from errors e and Jacobians J, which is overwritten: y (n, LANES). */
static void damped_step(int n, const Descents *at, const double *low, const double *high, double e[6][LANES],
                        double J[][6][LANES], double y[MOST_MOVED][LANES]) {
    double A[MOST_MOVED][MOST_MOVED][LANES], trust[LANES], held[MOST_MOVED][LANES];
    for (int l = 0; l < LANES; l++) {
        double squared = 0.0;
        for (int r = 0; r < 6; r++)
            squared += e[r][l] * e[r][l];
        trust[l] = DESCENT_DAMPING * squared < 1.0 ? DESCENT_DAMPING * squared : 1.0;
    }
    for (int i = 0; i < n; i++) {
        FOR_PARTS {
            Part sum = {0.0};
            for (int r = 0; r < 6; r++)
                sum += PART(J[i][r]) * PART(e[r]);
            PART(y[i]) = sum;
        }
        for (int l = 0; l < LANES; l++) {
            double x = at->x[l][i];
            int out = (x <= low[i] && y[i][l] < 0.0) || (x >= high[i] && y[i][l] > 0.0);
            held[i][l] = out ? 1.0 : 0.0;
            for (int r = 0; r < 6; r++)
                J[i][r][l] = out ? 0.0 : J[i][r][l];
            y[i][l] = out ? 0.0 : y[i][l];
        }
    }
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++)
            FOR_PARTS {
                Part sum = {0.0};
                for (int r = 0; r < 6; r++)
                    sum += PART(J[i][r]) * PART(J[j][r]);
                PART(A[i][j]) = sum;
            }
    for (int i = 0; i < n; i++)
        for (int l = 0; l < LANES; l++)
            A[i][i][l] += trust[l] + DESCENT_FLOOR * (held[i][l] != 0.0 ? 1.0 : A[i][i][l]);
    definite_solved(n, A, y);
    for (int l = 0; l < LANES; l++) {
        double longest = DESCENT_STEP;
        for (int i = 0; i < n; i++)
            longest = fabs(y[i][l]) > longest ? fabs(y[i][l]) : longest;
        for (int i = 0; i < n; i++)
            y[i][l] *= DESCENT_STEP / longest;
    }
}

static double clipped(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

/* Descents from values x (m, n) [rad | size] to targets T (m, 4, 4) within low and high (n,).

   far: (m,) the unit of lengths of each. x becomes what was best, and error (m, 6) is what is left there. */
void NAMED(descended)(const Chain *chain, const double *T, const double *far, double *x, ptrdiff_t m, double size,
                      const double *low, const double *high, int steps, double *error) {
    Descents at;
    double J[MOST_JOINTS][6][LANES], e[6][LANES], W[12][LANES], y[MOST_MOVED][LANES], q[LANES * MOST_JOINTS];
    ptrdiff_t next = 0, going = 0;
    int n = chain->n;
    if (!m)
        return;
    for (int l = 0; l < LANES; l++)
        at.place[l] = -2;
    for (;;) {
        for (int l = 0; l < LANES; l++) {
            if (at.place[l] >= 0 && at.made[l] >= 0)
                continue;
            if (at.place[l] >= 0) {
                memcpy(x + n * at.place[l], at.best[l], (size_t)n * sizeof(double));
                memcpy(error + 6 * at.place[l], at.left[l], sizeof at.left[l]);
                going--;
            }
            if (next >= m && at.place[l] != -2) {
                at.place[l] = -1;
                continue;
            }
            /* Where there are fewer than lanes some are the first once more, and nobody's. */
            ptrdiff_t from = next < m ? next : 0;
            at.place[l] = next < m ? next++ : -1;
            going += at.place[l] >= 0;
            at.made[l] = 0;
            at.far[l] = far[from];
            at.least[l] = HUGE_VAL;
            for (int r = 0; r < 6; r++)
                at.left[l][r] = 0.0;
            for (int i = 0; i < n; i++)
                at.best[l][i] = at.x[l][i] = clipped(x[n * from + i], low[i], high[i]);
            put_target(T + 16 * from, l, W);
        }
        if (!going)
            return;
        for (int l = 0; l < LANES; l++)
            put_values(chain, at.x[l], size, q + n * l);
        looked_at(chain, q, W, size, e, J);
        for (int l = 0; l < LANES; l++) {
            double squared = 0.0;
            for (int r = 0; r < 3; r++)
                e[r][l] /= at.far[l];
            for (int i = 0; i < n; i++)
                for (int r = 0; r < 6; r++) {
                    J[i][r][l] /= r < 3 ? at.far[l] : 1.0;
                    J[i][r][l] *= chain->revolute[i] ? 1.0 : at.far[l];
                }
            for (int r = 0; r < 6; r++)
                squared += e[r][l] * e[r][l];
            if (squared <= at.least[l]) {
                at.least[l] = squared;
                memcpy(at.best[l], at.x[l], (size_t)n * sizeof(double));
                for (int r = 0; r < 6; r++)
                    at.left[l][r] = e[r][l] * (r < 3 ? at.far[l] : 1.0);
            }
            /* Also one that ran away to where there are no numbers has come to its end. */
            if (!(squared >= DESCENT_ARRIVED / (at.far[l] * at.far[l])) || at.made[l] >= steps)
                at.made[l] = -1;
        }
        damped_step(n, &at, low, high, e, J, y);
        for (int l = 0; l < LANES; l++) {
            if (at.made[l] < 0)
                continue;
            for (int i = 0; i < n; i++)
                at.x[l][i] = clipped(at.x[l][i] + y[i][l] * (chain->revolute[i] ? 1.0 : at.far[l]), low[i], high[i]);
            at.made[l]++;
        }
    }
}

/* Columns w (c, p) at right angles that rotations V (c, c) make of those of A or of its rows: one-sided Jacobi. */
static void jacobi(int p, int c, double w[][MOST_ROWS], double V[][MOST_ROWS]) {
    for (int i = 0; i < c; i++)
        for (int j = 0; j < c; j++)
            V[i][j] = i == j;
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        int turned = 0;
        for (int i = 0; i < c; i++)
            for (int j = i + 1; j < c; j++) {
                double a = 0.0, b = 0.0, d = 0.0;
                for (int r = 0; r < p; r++) {
                    a += w[i][r] * w[i][r];
                    b += w[j][r] * w[j][r];
                    d += w[i][r] * w[j][r];
                }
                if (!(fabs(d) > RIGHT_ANGLE * sqrt(a) * sqrt(b)) || !(fabs(d) > 1e-290))
                    continue;
                turned = 1;
                double zeta = (b - a) / (2.0 * d), t = 1.0 / (fabs(zeta) + sqrt(1.0 + zeta * zeta));
                t = zeta < 0.0 ? -t : t;
                double cosine = 1.0 / sqrt(1.0 + t * t), sine = cosine * t;
                for (int r = 0; r < p; r++) {
                    double u = w[i][r], v = w[j][r];
                    w[i][r] = cosine * u - sine * v;
                    w[j][r] = sine * u + cosine * v;
                }
                for (int r = 0; r < c; r++) {
                    double u = V[i][r], v = V[j][r];
                    V[i][r] = cosine * u - sine * v;
                    V[j][r] = sine * u + cosine * v;
                }
            }
        if (!turned)
            return;
    }
}

/* The shortest dx with A dx = b of one lane, singular values up to `zero` left out. A: (row, joint). */
static void shortest(int rows, int n, double A[MOST_ROWS][MOST_MOVED][LANES], double b[MOST_ROWS][LANES], int l,
                     double zero, double *dx) {
    double w[MOST_ROWS][MOST_ROWS], V[MOST_ROWS][MOST_ROWS];
    int wide = rows < n, c = wide ? rows : n, p = wide ? n : rows;
    for (int i = 0; i < c; i++)
        for (int r = 0; r < p; r++)
            w[i][r] = wide ? A[i][r][l] : A[r][i][l];
    jacobi(p, c, w, V);
    for (int i = 0; i < n; i++)
        dx[i] = 0.0;
    for (int j = 0; j < c; j++) {
        double squared = 0.0, part = 0.0;
        for (int r = 0; r < p; r++)
            squared += w[j][r] * w[j][r];
        if (!(sqrt(squared) > zero))
            continue;
        /* Of a wide A the columns that came of its rows are in joints, of a high one those of V. */
        for (int r = 0; r < rows; r++)
            part += (wide ? V[j][r] : w[j][r]) * b[r][l];
        part /= squared;
        for (int i = 0; i < n; i++)
            dx[i] += part * (wide ? w[j][i] : V[j][i]);
    }
}

/* The shortest solutions of A dx = b: dx (LANES, n), of the lanes that are wanted. */
static void shortest_steps(int rows, int n, double A[MOST_ROWS][MOST_MOVED][LANES], double b[MOST_ROWS][LANES],
                           double zero, const int wanted[LANES], double dx[LANES][MOST_MOVED]) {
    double G[MOST_MOVED][MOST_MOVED][LANES], trifle[LANES], size[LANES], y[MOST_MOVED][LANES], z[MOST_MOVED][LANES];
    int wide = rows < n, k = wide ? rows : n, p = wide ? n : rows;
    for (int i = 0; i < k; i++)
        for (int j = i; j < k; j++)
            FOR_PARTS {
                Part sum = {0.0};
                for (int r = 0; r < p; r++)
                    sum += wide ? PART(A[i][r]) * PART(A[j][r]) : PART(A[r][i]) * PART(A[r][j]);
                PART(G[i][j]) = PART(G[j][i]) = sum;
            }
    for (int l = 0; l < LANES; l++) {
        double trace = 0.0;
        for (int i = 0; i < k; i++)
            trace += G[i][i][l];
        trifle[l] = TRIFLE * trace + TRIFLE;
        size[l] = 0.0;
        for (int i = 0; i < k; i++)
            G[i][i][l] += trifle[l];
    }
    /* The inverse in the place of G: it is definite, and needs no interchanges. */
    for (int i = 0; i < k; i++)
        FOR_PARTS {
            Part over = ONE / PART(G[i][i]);
            PART(G[i][i]) = ONE;
            for (int j = 0; j < k; j++)
                PART(G[i][j]) *= over;
            for (int r = 0; r < k; r++) {
                if (r == i)
                    continue;
                Part f = PART(G[r][i]);
                PART(G[r][i]) = (Part){0.0};
                for (int j = 0; j < k; j++)
                    PART(G[r][j]) -= f * PART(G[i][j]);
            }
        }
    for (int i = 0; i < k; i++)
        FOR_PARTS {
            Part sum = {0.0};
            if (wide)
                sum = PART(b[i]);
            for (int r = 0; !wide && r < rows; r++)
                sum += PART(A[r][i]) * PART(b[r]);
            PART(y[i]) = sum;
        }
    for (int i = 0; i < k; i++)
        FOR_PARTS {
            Part sum = {0.0}, squared = PART(size);
            for (int j = 0; j < k; j++) {
                sum += PART(G[i][j]) * PART(y[j]);
                squared += PART(G[i][j]) * PART(G[i][j]);
            }
            PART(z[i]) = sum;
            PART(size) = squared;
        }
    for (int i = 0; i < n; i++)
        FOR_PARTS {
            Part sum = {0.0};
            if (!wide)
                sum = PART(z[i]);
            for (int r = 0; wide && r < rows; r++)
                sum += PART(A[r][i]) * PART(z[r]);
            for (int l = 0; l < 4; l++)
                dx[4 * h + l][i] = sum[l];
        }
    for (int l = 0; l < LANES; l++) {
        double least = NO_TRIFLE * trifle[l];
        least = least > PLAIN * PLAIN ? least : PLAIN * PLAIN;
        if (wanted[l] && !(size[l] * least * least < 1.0))
            shortest(rows, n, A, b, l, zero, dx[l]);
    }
}

/* The greatest |e| of a lane, no number where there is none in it. */
static double greatest_of(double e[6][LANES], int l) {
    double out = 0.0;
    for (int r = 0; r < 6; r++)
        out = fabs(e[r][l]) > out || e[r][l] != e[r][l] ? fabs(e[r][l]) : out;
    return out;
}

/* What is kept of the corrections of all lanes: where each is, and where its next step leads from. */
typedef struct {
    double here[LANES][MOST_MOVED], new[LANES][MOST_MOVED], before[LANES], factor[LANES];
    int made[LANES], idle[LANES];
    ptrdiff_t place[LANES];
} Corrections;

/* Steps of the shortest length from values x (m, n) [rad | size] onto configurations that reach T (m, 4, 4), in planes
   at right angles to normals (m, extra, n); at most `most` (m,) of each.

   x becomes where they lead; off (m,) and jacobian (m, 6, n) are what is left there and the Jacobian. */
void NAMED(corrected)(const Chain *chain, const double *T, const double *normals, int extra, const double *most,
                      double *x, ptrdiff_t m, double size, double settled, double zero, double *off,
                      double *jacobian) {
    Corrections at;
    double J[MOST_JOINTS][6][LANES], e[6][LANES], W[12][LANES], q[LANES * MOST_JOINTS], dx[LANES][MOST_MOVED];
    double A[MOST_ROWS][MOST_MOVED][LANES], b[MOST_ROWS][LANES];
    ptrdiff_t next = 0, going = 0;
    int n = chain->n;
    if (!m)
        return;
    memset(A, 0, sizeof A);
    memset(b, 0, sizeof b);
    for (int l = 0; l < LANES; l++)
        at.place[l] = -2;
    for (;;) {
        for (int l = 0; l < LANES; l++) {
            if (at.place[l] >= 0 && at.made[l] >= 0)
                continue;
            going -= at.place[l] >= 0;
            if (next >= m && at.place[l] != -2) {
                at.place[l] = -1;
                continue;
            }
            /* Where there are fewer than lanes some are the first once more, and nobody's. */
            ptrdiff_t from = next < m ? next : 0;
            at.place[l] = next < m ? next++ : -1;
            going += at.place[l] >= 0;
            at.made[l] = at.idle[l] = 0;
            at.factor[l] = 1.0;
            memcpy(at.new[l], x + n * from, (size_t)n * sizeof(double));
            put_target(T + 16 * from, l, W);
            for (int k = 0; k < extra; k++)
                for (int i = 0; i < n; i++)
                    A[6 + k][i][l] = normals[(extra * from + k) * n + i];
        }
        if (!going)
            return;
        for (int l = 0; l < LANES; l++)
            put_values(chain, at.new[l], size, q + n * l);
        looked_at(chain, q, W, size, e, J);
        for (int l = 0; l < LANES; l++) {
            ptrdiff_t row = at.place[l];
            double after = greatest_of(e, l), before = at.before[l];
            int first = at.made[l] == 0;
            /* Once close, a step that gains nothing is rounding; it would only wander. */
            int better = first || after < before || before > CORRECTION_CLOSES, on;
            if (row < 0)
                continue;
            if (better) {
                for (int r = 0; r < 6; r++) {
                    for (int i = 0; i < n; i++) {
                        A[r][i][l] = J[i][r][l];
                        jacobian[6 * n * row + r * n + i] = J[i][r][l];
                    }
                    b[r][l] = e[r][l];
                }
                memcpy(at.here[l], at.new[l], (size_t)n * sizeof(double));
                memcpy(x + n * row, at.new[l], (size_t)n * sizeof(double));
                off[row] = at.before[l] = after;
            }
            if (first) {
                on = after > settled && most[row] > 0.0;
            } else {
                /* What is left of an error in directions that are left out stays as it is. */
                at.idle[l] = fabs(after - before) < IDLE * before ? at.idle[l] + 1 : 0;
                on = better ? after > settled && at.idle[l] < IDLE_STEPS : at.factor[l] > 1.0;
                on = on && at.made[l] < most[row];
                /* At a double root each step halves the distance and leaves a fourth of the error. */
                at.factor[l] = after > 0.2 * before && after < 0.3 * before ? 2.0 : 1.0;
            }
            at.made[l] = on ? at.made[l] + 1 : -1;
        }
        int on[LANES], any = 0;
        for (int l = 0; l < LANES; l++)
            any |= on[l] = at.place[l] >= 0 && at.made[l] >= 0;
        if (!any)
            continue;
        shortest_steps(6 + extra, n, A, b, zero, on, dx);
        for (int l = 0; l < LANES; l++) {
            double longest = CORRECTION_LONGEST;
            if (!on[l])
                continue;
            for (int i = 0; i < n; i++)
                longest = fabs(dx[l][i]) > longest ? fabs(dx[l][i]) : longest;
            for (int i = 0; i < n; i++)
                at.new[l][i] = at.here[l][i] + dx[l][i] * (CORRECTION_LONGEST / longest) * at.factor[l];
        }
    }
}

/* The shortest solutions (m, n) of A (m, rows, n) dx = b (m, rows), singular values up to `zero` left out. */
void NAMED(shortest_of)(const double *A, const double *b, ptrdiff_t m, int rows, int n, double zero, double *dx) {
    double a[MOST_ROWS][MOST_MOVED][LANES], right[MOST_ROWS][LANES], y[LANES][MOST_MOVED];
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        int count = m - first < LANES ? (int)(m - first) : LANES, wanted[LANES];
        for (int l = 0; l < LANES; l++) {
            ptrdiff_t from = first + (l < count ? l : 0);
            wanted[l] = l < count;
            for (int r = 0; r < rows; r++) {
                right[r][l] = b[from * rows + r];
                for (int i = 0; i < n; i++)
                    a[r][i][l] = A[(from * rows + r) * n + i];
            }
        }
        shortest_steps(rows, n, a, right, zero, wanted, y);
        for (int l = 0; l < count; l++)
            memcpy(dx + (first + l) * n, y[l], (size_t)n * sizeof(double));
    }
}

/* Steps by singular values from q (m, n) towards T (m, 4, 4), with the errors (m, 6), those there first: see
   `second_look.closing_at_last`. */
void NAMED(finely_closed)(const Chain *chain, const double *T, double *q, ptrdiff_t m, double size, int steps,
                          double longest, double zero, double enough, double *error) {
    int n = chain->n, c = n < 6 ? n : 6, p = n < 6 ? 6 : n, wide = n > 6;
    for (ptrdiff_t k = 0; k < m; k++) {
        double *here = q + n * k, *left = error + 6 * k, J[6 * MOST_MOVED], next[6 * MOST_MOVED];
        double w[MOST_ROWS][MOST_ROWS], V[MOST_ROWS][MOST_ROWS], e[6], ahead[MOST_MOVED], values[MOST_ROWS];
        double off = 0.0, greatest = 0.0;
        for (int r = 0; r < 6; r++)
            off = fabs(left[r]) > off ? fabs(left[r]) : off;
        if (off > enough)
            NAMED(errors)(chain, T + 16 * k, here, 1, size, left, J);
        for (int step = 0; off > enough && step < steps; step++) {
            double dx[MOST_MOVED] = {0.0}, length = longest, after = 0.0, before = 0.0;
            for (int i = 0; i < c; i++)
                for (int r = 0; r < p; r++)
                    w[i][r] = wide ? J[n * i + r] : J[n * r + i];
            jacobi(p, c, w, V);
            greatest = 0.0;
            for (int j = 0; j < c; j++) {
                double squared = 0.0;
                for (int r = 0; r < p; r++)
                    squared += w[j][r] * w[j][r];
                values[j] = sqrt(squared);
                greatest = values[j] > greatest ? values[j] : greatest;
            }
            for (int j = 0; j < c; j++) {
                double part = 0.0;
                if (!(values[j] > zero * greatest))
                    continue;
                for (int r = 0; r < 6; r++)
                    part += (wide ? V[j][r] : w[j][r]) * left[r];
                part /= values[j] * values[j];
                for (int i = 0; i < n; i++)
                    dx[i] += part * (wide ? w[j][i] : V[j][i]);
            }
            for (int i = 0; i < n; i++)
                length = fabs(dx[i]) > length ? fabs(dx[i]) : length;
            for (int i = 0; i < n; i++)
                ahead[i] = here[i] + dx[i] * (longest / length) * (chain->revolute[i] ? 1.0 : size);
            NAMED(errors)(chain, T + 16 * k, ahead, 1, size, e, next);
            for (int r = 0; r < 6; r++) {
                after = fabs(e[r]) > after ? fabs(e[r]) : after;
                before = fabs(left[r]) > before ? fabs(left[r]) : before;
            }
            if (!(after < before))
                break;
            memcpy(here, ahead, (size_t)n * sizeof(double));
            memcpy(left, e, sizeof e);
            memcpy(J, next, (size_t)(6 * n) * sizeof(double));
            off = after;
        }
    }
}
