/* Ways down of LANES configurations at once to where a pose is nearest to a target, by second derivatives, within
   limits; one that has come to its end makes room for the next, and where it ends does not depend on the others.

   Python's `second_order` is the reference, and says what is derived how. Comes after descents.h.
*/

/* See `second_order`. */
#define WAY_STEP 0.6
#define WAY_CAUTION 0.1
#define WAY_PIVOT 1e-16
#define WAY_INDEFINITE 0.03
#define WAY_TRIES 4
#define WAY_SHRINK 0.25
#define WAY_NOISE 1e-15
#define WAY_STUCK 1e8
#define WAY_HOPELESS 1e20

/* f's parts, f, its gradient and the right half of its Hessian, at x. */
typedef struct {
    double place[LANES], turn[LANES], f[LANES], x[MOST_MOVED][LANES], gradient[MOST_MOVED][LANES];
    double H[MOST_MOVED][MOST_MOVED][LANES];
} Slope;

/* What is kept of the ways of all lanes. */
typedef struct {
    Slope here, there;
    double low[MOST_MOVED][LANES], high[MOST_MOVED][LANES];
    double weight[LANES], damping[LANES], growth[LANES], longest[LANES], definite[LANES];
    int made[LANES];
    ptrdiff_t place[LANES];
} Ways;

/* How the tools of all lanes move, in sizes, and what their poses lack: e = p - t, a half the vector of the skew part
   of M, the found rotation times the transpose of the wished one. */
typedef struct {
    double J[MOST_MOVED][6][LANES], e[3][LANES], a[3][LANES], M[3][3][LANES], trace[LANES];
} Moved;

/* The tools at values x [rad | size], for targets W; and half of the squared distance, and 1 - cos of the angle. */
static void moved_tools(const Chain *chain, double x[MOST_MOVED][LANES], double W[12][LANES], double size, Moved *to,
                        double place[LANES], double turn[LANES]) {
    double axes[MOST_JOINTS][6][LANES], q[LANES * MOST_JOINTS];
    int n = chain->n;
    Frame F;
    for (int i = 0; i < n; i++)
        for (int l = 0; l < LANES; l++)
            q[n * l + i] = chain->revolute[i] ? x[i][l] : x[i][l] * size;
    followed(chain, q, LANES, axes, &F);
    double per = 1.0 / size;
    for (int i = 0; i < n; i++)
        FOR_PARTS {
            const Part none = {0.0};
            Part z[3], lever[3];
            int slides = !chain->revolute[i];
            for (int r = 0; r < 3; r++) {
                z[r] = PART(axes[i][r]);
                lever[r] = (PART(F.v[9 + r]) - PART(axes[i][3 + r])) * per;
            }
            for (int r = 0; r < 3; r++) {
                int s = (r + 1) % 3, t = (r + 2) % 3;
                PART(to->J[i][r]) = slides ? z[r] : (Part)(z[s] * lever[t] - z[t] * lever[s]);
                PART(to->J[i][3 + r]) = slides ? none : z[r];
            }
        }
    FOR_PARTS {
        Part away = {0.0}, turned = {0.0};
        for (int r = 0; r < 3; r++) {
            Part off = (PART(F.v[9 + r]) - PART(W[9 + r])) * per;
            PART(to->e[r]) = off;
            away += off * off;
        }
        for (int j = 0; j < 9; j++) {
            Part off = PART(F.v[j]) - PART(W[j]);
            turned += off * off;
        }
        for (int r = 0; r < 3; r++)
            for (int k = 0; k < 3; k++)
                PART(to->M[r][k]) =
                    PART(F.v[r]) * PART(W[k]) + PART(F.v[3 + r]) * PART(W[3 + k]) + PART(F.v[6 + r]) * PART(W[6 + k]);
        PART(to->trace) = PART(to->M[0][0]) + PART(to->M[1][1]) + PART(to->M[2][2]);
        for (int r = 0; r < 3; r++) {
            int s = (r + 1) % 3, t = (r + 2) % 3;
            PART(to->a[r]) = 0.5 * (PART(to->M[t][s]) - PART(to->M[s][t]));
        }
        PART(place) = 0.5 * away;
        PART(turn) = 0.25 * turned;
    }
}

/* f's gradient, and the right half of its Hessian, of tools that are off by e from their places. */
static void curved(int n, Moved *at, double e[3][LANES], const double weight[LANES], double gradient[MOST_MOVED][LANES],
                   double H[MOST_MOVED][MOST_MOVED][LANES]) {
    double U[MOST_MOVED][6][LANES];
    FOR_PARTS {
        Part w = CONSTANT(weight);
        for (int i = 0; i < n; i++) {
            Part along = {0.0}, about = {0.0};
            for (int r = 0; r < 3; r++) {
                int s = (r + 1) % 3, t = (r + 2) % 3;
                Part axis = PART(at->J[i][3 + r]);
                Part mixed = PART(at->J[i][3]) * PART(at->M[0][r]) + PART(at->J[i][4]) * PART(at->M[1][r]) +
                             PART(at->J[i][5]) * PART(at->M[2][r]);
                PART(U[i][r]) =
                    PART(at->J[i][r]) + (PART(e[s]) * PART(at->J[i][3 + t]) - PART(e[t]) * PART(at->J[i][3 + s]));
                PART(U[i][3 + r]) = (0.5 * w) * (PART(at->trace) * axis - mixed);
                along += PART(at->J[i][r]) * PART(e[r]);
                about += axis * PART(at->a[r]);
            }
            PART(gradient[i]) = along + w * about;
        }
        for (int i = 0; i < n; i++)
            for (int j = i; j < n; j++) {
                Part sum = {0.0};
                for (int r = 0; r < 6; r++)
                    sum += PART(U[i][r]) * PART(at->J[j][r]);
                PART(H[i][j]) = sum;
            }
    }
}

/* f and its derivatives at `to`'s x, for targets W. */
static void sloped(const Chain *chain, double W[12][LANES], double size, const double weight[LANES], Slope *to) {
    Moved at;
    moved_tools(chain, to->x, W, size, &at, to->place, to->turn);
    curved(chain->n, &at, at.e, weight, to->gradient, to->H);
    FOR_PARTS PART(to->f) = PART(to->place) + CONSTANT(weight) * PART(to->turn);
}

/* dx with (H + damping) dx = -gradient of the joints that are not held, and where that matrix is positive definite. */
static void way_solved(int n, const Slope *here, double held[MOST_MOVED][LANES], const double damping[LANES],
                       double dx[MOST_MOVED][LANES], double definite[LANES]) {
    double A[MOST_MOVED][MOST_MOVED][LANES];
    const Part zero = {0.0}, none = HUGE_VAL * ONE;
    FOR_PARTS {
        Bits all = zero == zero;
        for (int i = 0; i < n; i++) {
            Bits still = CONSTANT(held[i]) != zero;
            PART(dx[i]) = chosen(still, zero, -CONSTANT(here->gradient[i]));
            PART(A[i][i]) = chosen(still, ONE, CONSTANT(here->H[i][i]) + CONSTANT(damping));
            for (int j = i + 1; j < n; j++)
                PART(A[i][j]) = chosen(still | (CONSTANT(held[j]) != zero), zero, CONSTANT(here->H[i][j]));
        }
        /* What is not positive is made infinite: nothing is taken from the rows below it, and nothing grows. */
        for (int k = 0; k < n; k++) {
            Bits positive = PART(A[k][k]) > WAY_PIVOT * ONE;
            Part D = chosen(positive, PART(A[k][k]), none);
            all &= positive & (D < none);
            PART(A[k][k]) = ONE / D;
            for (int i = k + 1; i < n; i++) {
                Part f = PART(A[k][i]) * PART(A[k][k]);
                for (int j = i; j < n; j++)
                    PART(A[i][j]) -= f * PART(A[k][j]);
                PART(dx[i]) -= f * PART(dx[k]);
            }
        }
        for (int k = n - 1; k >= 0; k--) {
            Part value = PART(dx[k]) * PART(A[k][k]);
            PART(dx[k]) = value;
            for (int i = 0; i < k; i++)
                PART(dx[i]) -= PART(A[i][k]) * value;
        }
        PART(definite) = chosen(all, ONE, zero);
    }
}

static inline Part lesser(Part a, Part b) { return chosen(a < b, a, b); }

static inline Part absolute(Part a) { return chosen(a < 0.0 * ONE, -a, a); }

/* The next steps of all lanes: `there` is where they lead. */
static void way_step(const Chain *chain, Ways *at) {
    double held[MOST_MOVED][LANES], dx[MOST_MOVED][LANES], definite[LANES];
    const Slope *here = &at->here;
    const Part zero = {0.0};
    int n = chain->n, every = 0;
    for (int i = 0; i < n; i++)
        FOR_PARTS {
            Part x = CONSTANT(here->x[i]), g = CONSTANT(here->gradient[i]);
            Bits out = ((x <= PART(at->low[i])) & (g > zero)) | ((x >= PART(at->high[i])) & (g < zero));
            PART(held[i]) = chosen(out, ONE, zero);
        }
    for (int tried = 0; tried < WAY_TRIES && !every; tried++) {
        way_solved(n, here, held, at->damping, dx, definite);
        every = 1;
        for (int l = 0; l < LANES; l++) {
            if (definite[l] != 0.0)
                continue;
            double more = WAY_INDEFINITE * (sqrt(2.0 * here->place[l]) + at->weight[l]);
            at->damping[l] = 8.0 * at->damping[l] > more ? 8.0 * at->damping[l] : more;
            every &= at->place[l] < 0;
        }
    }
    FOR_PARTS {
        Bits sure = PART(definite) != zero;
        Part longest = WAY_STEP * ONE, greatest = zero;
        for (int i = 0; i < n; i++) {
            Part step = chosen(sure, PART(dx[i]), zero), far = absolute(step);
            if (!chain->revolute[i])
                far = far / greater(absolute(CONSTANT(here->x[i])), ONE);
            PART(dx[i]) = step;
            longest = greater(far, longest);
        }
        Part factor = (WAY_STEP * ONE) / longest;
        for (int i = 0; i < n; i++) {
            Part step = PART(dx[i]) * factor;
            greatest = greater(absolute(step), greatest);
            PART(at->there.x[i]) =
                lesser(greater(CONSTANT(here->x[i]) + step, PART(at->low[i])), PART(at->high[i]));
        }
        PART(at->longest) = greatest;
        PART(at->definite) = PART(definite);
    }
}

/* Which lanes' steps are taken, and how the next ones are damped; arrived: the lanes that have come to their end. */
static void judged(int n, Ways *at, double still, double least, long long taken[LANES], long long arrived[LANES]) {
    const Slope *now = &at->here, *after = &at->there;
    const Part zero = {0.0};
    double dx[MOST_MOVED][LANES];
    for (int i = 0; i < n; i++)
        FOR_PARTS PART(dx[i]) = CONSTANT(after->x[i]) - CONSTANT(now->x[i]);
    FOR_PARTS {
        Part foretold = zero;
        for (int i = 0; i < n; i++) {
            Part product = zero;
            for (int j = 0; j < n; j++)
                product += (i < j ? CONSTANT(now->H[i][j]) : CONSTANT(now->H[j][i])) * PART(dx[j]);
            foretold -= PART(dx[i]) * (CONSTANT(now->gradient[i]) + 0.5 * product);
        }
        Part before = CONSTANT(now->f), f = CONSTANT(after->f), noise = WAY_NOISE * before + DBL_MIN;
        Part ratio = (before - f + noise) / (greater(foretold, zero) + noise);
        Bits better = (PART(at->definite) != zero) & (f <= before + noise) & (ratio > 1e-4 * ONE);
        Part part = 2.0 * lesser(ratio, ONE) - ONE, shrunk = greater(ONE - part * part * part, WAY_SHRINK * ONE);
        Part damping = chosen(better, shrunk, PART(at->growth)) * PART(at->damping);
        damping = lesser(greater(damping, least * ONE), WAY_HOPELESS * ONE);
        PART(at->damping) = damping;
        PART(at->growth) = chosen(better, 4.0 * ONE, 2.0 * PART(at->growth));
        BITS(taken) = better;
        BITS(arrived) = (better & (PART(at->longest) < still * ONE)) | ~(damping <= WAY_STUCK * ONE);
    }
}

/* What is known where the steps lead becomes what is known here, in the lanes that take them. */
static void taken_over(int n, Ways *at, const long long taken[LANES]) {
    Slope *here = &at->here, *there = &at->there;
    FOR_PARTS {
        Bits which = ((const Bits *)taken)[h];
#define TAKE(what) PART(here->what) = chosen(which, PART(there->what), PART(here->what))
        TAKE(place);
        TAKE(turn);
        TAKE(f);
        for (int i = 0; i < n; i++) {
            TAKE(x[i]);
            TAKE(gradient[i]);
            for (int j = i; j < n; j++)
                TAKE(H[i][j]);
        }
#undef TAKE
    }
}

/* Ways from values x (m, n) [rad | size] to targets T (m, 12), the columns x, y, z, p, within low and high, of which there
   is a row (n,) for each, or `own` is 0 and one is for all.

   weight: (m,) that of the orientation. x becomes where the ways end, and left (m, 2) is what f's parts are there. */
void NAMED(gone_down)(const Chain *chain, const double *T, double *x, ptrdiff_t m, double size, const double *low,
                      const double *high, int own, const double *weight, int steps, double still, double least,
                      double *left) {
    Ways at;
    double W[12][LANES];
    long long taken[LANES], arrived[LANES];
    ptrdiff_t next = 0, going = 0;
    int n = chain->n, over[LANES];
    if (!m)
        return;
    memset(&at, 0, sizeof at);
    for (int l = 0; l < LANES; l++) {
        at.place[l] = -2;
        over[l] = 1;
    }
    for (;;) {
        for (int l = 0; l < LANES; l++) {
            ptrdiff_t row = at.place[l];
            if (!over[l])
                continue;
            if (row >= 0) {
                for (int i = 0; i < n; i++)
                    x[n * row + i] = at.here.x[i][l];
                left[2 * row] = at.here.place[l];
                left[2 * row + 1] = at.here.turn[l];
                going--;
            }
            if (next >= m && row != -2) {
                at.place[l] = -1;
                over[l] = 0;
                at.made[l] = 0;
                continue;
            }
            /* Where there are fewer than lanes some are the first once more, and nobody's. */
            ptrdiff_t from = next < m ? next : 0;
            at.place[l] = next < m ? next++ : -1;
            going += at.place[l] >= 0;
            over[l] = 0;
            at.made[l] = 0;
            at.weight[l] = weight[from];
            at.damping[l] = WAY_CAUTION * weight[from] + least;
            at.growth[l] = 4.0;
            for (int j = 0; j < 12; j++)
                W[j][l] = T[12 * from + j];
            for (int i = 0; i < n; i++) {
                at.low[i][l] = low[own * n * from + i];
                at.high[i][l] = high[own * n * from + i];
                at.there.x[i][l] = clipped(x[n * from + i], at.low[i][l], at.high[i][l]);
            }
        }
        if (!going)
            return;
        sloped(chain, W, size, at.weight, &at.there);
        /* Of a lane that has just begun nothing is judged: what it was damped by before is put back. */
        double damping[LANES], growth[LANES];
        memcpy(damping, at.damping, sizeof damping);
        memcpy(growth, at.growth, sizeof growth);
        judged(n, &at, still, least, taken, arrived);
        for (int l = 0; l < LANES; l++) {
            if (at.made[l] == 0) {
                taken[l] = -1;
                arrived[l] = 0;
                at.damping[l] = damping[l];
                at.growth[l] = growth[l];
            }
            over[l] = at.place[l] >= 0 && (arrived[l] || at.made[l] >= steps);
        }
        taken_over(n, &at, taken);
        way_step(chain, &at);
        for (int l = 0; l < LANES; l++)
            at.made[l]++;
    }
}
