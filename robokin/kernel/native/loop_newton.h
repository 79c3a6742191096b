/* Newton steps on the loop equation J1 L1 ... J6 L6 = 1 of turning joints, for LANES candidates of one target at once.

   Python's `loop_newton` and `complex_newton` are the reference, and say what is derived how. Comes after lanes.h.
*/

/* The longest step of one joint [rad]. */
#define LONGEST 0.5

/* Least damping of a joint, as a part of its squared twist. */
#define FLOOR 1e-15

/* Candidates whose error [size and rad] is less are left alone. */
#define DONE 1e-14

/* A candidate's values, and what is known of them once the steps are done. */
typedef struct {
    int count;
    double q[LANES][6];
    double position[LANES], angle[LANES], determinant[LANES];
} Group;

typedef struct {
    int count;
    double re[6][LANES], im[6][LANES];
    double residual[LANES], determinant[LANES], squared[LANES], step[LANES];
    double dre[6][LANES], dim[6][LANES];
} ComplexGroup;

static void link_of(const Motion *M, Constant *out) {
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            out->m[3 * c + r] = M->R[r][c];
        out->m[9 + r] = M->t[r];
    }
    out->turns = out->shifts = 1;
}

/* The twists (6, 6, LANES): (o x z, z) of each joint. */
static void twists(double axes[][6][LANES], double S[6][6][LANES]) {
    for (int i = 0; i < 6; i++)
        for (int r = 0; r < 3; r++) {
            int a = (r + 1) % 3, b = (r + 2) % 3;
            for (int l = 0; l < LANES; l++) {
                S[i][r][l] = axes[i][3 + a][l] * axes[i][b][l] - axes[i][3 + b][l] * axes[i][a][l];
                S[i][3 + r][l] = axes[i][r][l];
            }
        }
}

/* The error's angle from its sine and cosine, over the sine. */
static inline double angle_over_sine(double sine, double cosine) {
    double squared = sine * sine;
    if (squared < 1e-4 && cosine > 0.0)
        return 1.0 + squared * (1.0 / 6.0 + squared * (3.0 / 40.0 + squared * (15.0 / 336.0)));
    return sine > 0.0 ? atan2(sine, cosine) / sine : 1.0;
}

/* Steps on real candidates until they close, or `steps` were made. */
static void refine(const Chain *loop, const Constant *closing, Group *group, int steps) {
    double axes[MOST_JOINTS][6][LANES], S[6][6][LANES], e[6][LANES], A[6][6][LANES], y[6][LANES], open[LANES];
    double damping[LANES], longest[LANES];
    Frame X;
    for (int step = 0;; step++) {
        int going = 0;
        followed(loop, group->q[0], group->count, axes, &X);
        go_on(&X, closing);
        for (int l = 0; l < LANES; l++) {
            double w[3], lack = 3.0 - ((X.v[0][l] + X.v[4][l]) + X.v[8][l]), sine = 0.0, v = 0.0;
            for (int r = 0; r < 3; r++) {
                int a = (r + 1) % 3, b = (r + 2) % 3;
                w[r] = 0.5 * (X.v[3 * a + b][l] - X.v[3 * b + a][l]);
                sine += w[r] * w[r];
                e[r][l] = X.v[9 + r][l];
                v += e[r][l] * e[r][l];
            }
            sine = sqrt(sine);
            double cosine = 1.0 - 0.5 * lack, factor = angle_over_sine(sine, cosine);
            for (int r = 0; r < 3; r++)
                e[3 + r][l] = w[r] * factor;
            if (sine == 0.0 && cosine < 0.0)
                e[3][l] = 3.14159265358979323846;
            double angle = sine == 0.0 ? fabs(e[3][l]) : sine * factor;
            damping[l] = v + angle * angle;
            open[l] = damping[l] > DONE * DONE ? 1.0 : 0.0;
            group->position[l] = sqrt(v);
            group->angle[l] = angle;
            going |= l < group->count && open[l] != 0.0;
        }
        twists(axes, S);
        for (int i = 0; i < 6; i++) {
            for (int j = i; j < 6; j++)
                for (int l = 0; l < LANES; l++) {
                    double sum = 0.0;
                    for (int r = 0; r < 6; r++)
                        sum += S[i][r][l] * S[j][r][l];
                    A[i][j][l] = sum;
                }
            for (int l = 0; l < LANES; l++) {
                double sum = 0.0;
                for (int r = 0; r < 6; r++)
                    sum += S[i][r][l] * e[r][l];
                y[i][l] = sum;
                A[i][i][l] += damping[l] + FLOOR * A[i][i][l];
            }
        }
        for (int l = 0; l < LANES; l++)
            group->determinant[l] = 1.0;
        for (int k = 0; k < 6; k++) {
            for (int l = 0; l < LANES; l++)
                group->determinant[l] *= A[k][k][l];
            for (int i = k + 1; i < 6; i++)
                for (int l = 0; l < LANES; l++) {
                    double f = A[k][i][l] / A[k][k][l];
                    for (int j = i; j < 6; j++)
                        A[i][j][l] -= f * A[k][j][l];
                    y[i][l] -= f * y[k][l];
                }
        }
        for (int l = 0; l < LANES; l++)
            group->determinant[l] = sqrt(group->determinant[l] > 0.0 ? group->determinant[l] : 0.0);
        if (!going || step == steps)
            return;
        for (int k = 5; k >= 0; k--)
            for (int l = 0; l < LANES; l++) {
                double sum = y[k][l];
                for (int j = k + 1; j < 6; j++)
                    sum -= A[k][j][l] * y[j][l];
                y[k][l] = sum / A[k][k][l];
            }
        for (int l = 0; l < LANES; l++)
            longest[l] = LONGEST;
        for (int k = 0; k < 6; k++)
            for (int l = 0; l < LANES; l++)
                longest[l] = fabs(y[k][l]) > longest[l] ? fabs(y[k][l]) : longest[l];
        for (int l = 0; l < group->count; l++)
            if (open[l] != 0.0)
                for (int k = 0; k < 6; k++)
                    group->q[l][k] -= y[k][l] * (LONGEST / longest[l]);
    }
}

/* Cosines and sines of complex angles. */
static void complex_turns(double re[LANES], double im[LANES], double c[2][LANES], double s[2][LANES]) {
    double sine[LANES], cosine[LANES], e[LANES];
    for (int l = 0; l < LANES; l++)
        e[l] = exp(im[l]);
    FOR_PARTS sine_cosine(PART(re), &PART(sine), &PART(cosine));
    for (int l = 0; l < LANES; l++) {
        double other = 1.0 / e[l], hyperbolic_cosine = 0.5 * (e[l] + other), hyperbolic_sine = 0.5 * (e[l] - other);
        c[0][l] = cosine[l] * hyperbolic_cosine;
        c[1][l] = -sine[l] * hyperbolic_sine;
        s[0][l] = sine[l] * hyperbolic_cosine;
        s[1][l] = cosine[l] * hyperbolic_sine;
    }
}

/* The twists of complex values (joint, entry, LANES), real and imaginary parts, and X. */
static void complex_followed(const Chain *loop, ComplexGroup *g, double Sr[6][6][LANES], double Si[6][6][LANES],
                             Frame *X, Frame *Y, double size[LANES]) {
    double c[2][LANES], s[2][LANES];
    start(loop, X);
    memset(Y, 0, sizeof *Y);
    for (int l = 0; l < LANES; l++)
        size[l] = 0.0;
    for (int i = 0; i < 6; i++) {
        for (int r = 0; r < 3; r++) {
            int a = (r + 1) % 3, b = (r + 2) % 3;
            const double *za = X->v[6 + a], *zb = X->v[6 + b], *oa = X->v[9 + a], *ob = X->v[9 + b];
            const double *Za = Y->v[6 + a], *Zb = Y->v[6 + b], *Oa = Y->v[9 + a], *Ob = Y->v[9 + b];
            for (int l = 0; l < LANES; l++) {
                Sr[i][r][l] = (oa[l] * zb[l] - Oa[l] * Zb[l]) - (ob[l] * za[l] - Ob[l] * Za[l]);
                Si[i][r][l] = (oa[l] * Zb[l] + Oa[l] * zb[l]) - (ob[l] * Za[l] + Ob[l] * za[l]);
                Sr[i][3 + r][l] = X->v[6 + r][l];
                Si[i][3 + r][l] = Y->v[6 + r][l];
            }
        }
        for (int l = 0; l < LANES; l++) {
            double sum = 0.0;
            for (int r = 0; r < 3; r++)
                sum += X->v[6 + r][l] * X->v[6 + r][l] + Y->v[6 + r][l] * Y->v[6 + r][l];
            size[l] = sum > size[l] ? sum : size[l];
        }
        complex_turns(g->re[i], g->im[i], c, s);
        for (int r = 0; r < 3; r++)
            for (int l = 0; l < LANES; l++) {
                double x = X->v[r][l], y = X->v[3 + r][l], u = Y->v[r][l], v = Y->v[3 + r][l];
                X->v[r][l] = (c[0][l] * x - c[1][l] * u) + (s[0][l] * y - s[1][l] * v);
                Y->v[r][l] = (c[0][l] * u + c[1][l] * x) + (s[0][l] * v + s[1][l] * y);
                X->v[3 + r][l] = (c[0][l] * y - c[1][l] * v) - (s[0][l] * x - s[1][l] * u);
                Y->v[3 + r][l] = (c[0][l] * v + c[1][l] * y) - (s[0][l] * u + s[1][l] * x);
            }
        go_on(X, &loop->links[i]);
        go_on(Y, &loop->links[i]);
    }
}

/* What the loop lacks of closing at complex values, relative to the size of its terms, Newton's step, and det S. */
static void complex_look(const Chain *loop, const Constant *closing, ComplexGroup *g) {
    double Sr[6][6][LANES], Si[6][6][LANES], br[6][LANES], bi[6][LANES], size[LANES], dr[LANES], di[LANES];
    Frame X, Y;
    complex_followed(loop, g, Sr, Si, &X, &Y, size);
    go_on(&X, closing);
    go_on(&Y, closing);
    for (int l = 0; l < LANES; l++) {
        double sum = 0.0;
        for (int r = 0; r < 3; r++) {
            int a = (r + 1) % 3, b = (r + 2) % 3;
            br[r][l] = X.v[9 + r][l];
            bi[r][l] = Y.v[9 + r][l];
            br[3 + r][l] = 0.5 * (X.v[3 * a + b][l] - X.v[3 * b + a][l]);
            bi[3 + r][l] = 0.5 * (Y.v[3 * a + b][l] - Y.v[3 * b + a][l]);
        }
        for (int r = 0; r < 6; r++)
            sum += br[r][l] * br[r][l] + bi[r][l] * bi[r][l];
        double p = 3.0 - ((X.v[0][l] + X.v[4][l]) + X.v[8][l]), q = (Y.v[0][l] + Y.v[4][l]) + Y.v[8][l];
        g->residual[l] = sqrt(sum + (p * p + q * q)) / size[l];
        g->squared[l] = 0.0;
        dr[l] = 1.0;
        di[l] = 0.0;
    }
    for (int i = 0; i < 6; i++)
        for (int r = 0; r < 6; r++)
            for (int l = 0; l < LANES; l++)
                g->squared[l] += Sr[i][r][l] * Sr[i][r][l] + Si[i][r][l] * Si[i][r][l];
    /* Elimination on the rows r of S, whose columns are the joints i. */
    for (int k = 0; k < 6; k++) {
        double sign[LANES];
        for (int l = 0; l < LANES; l++)
            sign[l] = 1.0;
        for (int r = k + 1; r < 6; r++) {
            double swap[LANES];
            for (int l = 0; l < LANES; l++) {
                double here = Sr[k][k][l] * Sr[k][k][l] + Si[k][k][l] * Si[k][k][l];
                double there = Sr[k][r][l] * Sr[k][r][l] + Si[k][r][l] * Si[k][r][l];
                swap[l] = there > here ? 1.0 : 0.0;
                sign[l] = there > here ? -sign[l] : sign[l];
            }
            for (int i = k; i < 6; i++)
                for (int l = 0; l < LANES; l++) {
                    double a = Sr[i][k][l], b = Sr[i][r][l], c = Si[i][k][l], d = Si[i][r][l];
                    Sr[i][k][l] = swap[l] != 0.0 ? b : a;
                    Sr[i][r][l] = swap[l] != 0.0 ? a : b;
                    Si[i][k][l] = swap[l] != 0.0 ? d : c;
                    Si[i][r][l] = swap[l] != 0.0 ? c : d;
                }
            for (int l = 0; l < LANES; l++) {
                double a = br[k][l], b = br[r][l], c = bi[k][l], d = bi[r][l];
                br[k][l] = swap[l] != 0.0 ? b : a;
                br[r][l] = swap[l] != 0.0 ? a : b;
                bi[k][l] = swap[l] != 0.0 ? d : c;
                bi[r][l] = swap[l] != 0.0 ? c : d;
            }
        }
        double ir[LANES], ii[LANES];
        for (int l = 0; l < LANES; l++) {
            double a = Sr[k][k][l], b = Si[k][k][l], squared = a * a + b * b, p = dr[l] * sign[l], q = di[l] * sign[l];
            ir[l] = a / squared;
            ii[l] = -b / squared;
            dr[l] = p * a - q * b;
            di[l] = p * b + q * a;
        }
        for (int r = k + 1; r < 6; r++) {
            double fr[LANES], fi[LANES];
            for (int l = 0; l < LANES; l++) {
                fr[l] = Sr[k][r][l] * ir[l] - Si[k][r][l] * ii[l];
                fi[l] = Sr[k][r][l] * ii[l] + Si[k][r][l] * ir[l];
            }
            for (int i = k + 1; i < 6; i++)
                for (int l = 0; l < LANES; l++) {
                    Sr[i][r][l] -= fr[l] * Sr[i][k][l] - fi[l] * Si[i][k][l];
                    Si[i][r][l] -= fr[l] * Si[i][k][l] + fi[l] * Sr[i][k][l];
                }
            for (int l = 0; l < LANES; l++) {
                br[r][l] -= fr[l] * br[k][l] - fi[l] * bi[k][l];
                bi[r][l] -= fr[l] * bi[k][l] + fi[l] * br[k][l];
            }
        }
        /* The inverses of the pivots stand in their place. */
        for (int l = 0; l < LANES; l++) {
            Sr[k][k][l] = ir[l];
            Si[k][k][l] = ii[l];
        }
    }
    for (int l = 0; l < LANES; l++) {
        g->determinant[l] = sqrt(dr[l] * dr[l] + di[l] * di[l]);
        g->step[l] = 0.0;
    }
    for (int k = 5; k >= 0; k--)
        for (int l = 0; l < LANES; l++) {
            double p = br[k][l], q = bi[k][l];
            for (int i = k + 1; i < 6; i++) {
                p -= Sr[i][k][l] * g->dre[i][l] - Si[i][k][l] * g->dim[i][l];
                q -= Sr[i][k][l] * g->dim[i][l] + Si[i][k][l] * g->dre[i][l];
            }
            double x = p * Sr[k][k][l] - q * Si[k][k][l], y = p * Si[k][k][l] + q * Sr[k][k][l];
            double length = sqrt(x * x + y * y);
            g->dre[k][l] = x;
            g->dim[k][l] = y;
            g->step[l] = length > g->step[l] ? length : g->step[l];
        }
}

/* Steps on complex candidates with a residual above `enough`; what is known of all at the end is from `complex_look`. */
static void complex_refine(const Chain *loop, const Constant *closing, ComplexGroup *g, int steps, double enough) {
    complex_look(loop, closing, g);
    for (int step = 0; step < steps; step++) {
        int going = 0;
        for (int l = 0; l < LANES; l++) {
            if (g->residual[l] <= enough || !(g->step[l] < 1e300) || l >= g->count)
                continue;
            going = 1;
            double f = g->step[l] > LONGEST ? LONGEST / g->step[l] : 1.0;
            for (int k = 0; k < 6; k++) {
                g->re[k][l] -= f * g->dre[k][l];
                g->im[k][l] -= f * g->dim[k][l];
            }
        }
        if (!going)
            return;
        complex_look(loop, closing, g);
    }
}

/* A number that the least singular value of S is certainly not below, of candidate l: 1 / |S^-1|. */
static double least_singular(const Chain *loop, ComplexGroup *g, int l) {
    double Sr[6][6][LANES], Si[6][6][LANES], size[LANES], sum = 0.0;
    double complex A[6][12];
    Frame X, Y;
    complex_followed(loop, g, Sr, Si, &X, &Y, size);
    for (int r = 0; r < 6; r++)
        for (int i = 0; i < 6; i++) {
            A[r][i] = Sr[i][r][l] + I * Si[i][r][l];
            A[r][6 + i] = r == i;
        }
    for (int k = 0; k < 6; k++) {
        int best = k;
        for (int r = k + 1; r < 6; r++)
            best = cabs(A[r][k]) > cabs(A[best][k]) ? r : best;
        if (!(cabs(A[best][k]) > 0.0))
            return 0.0;
        for (int j = 0; j < 12; j++) {
            double complex other = A[k][j];
            A[k][j] = A[best][j];
            A[best][j] = other;
        }
        double complex inverse = 1.0 / A[k][k];
        for (int j = k; j < 12; j++)
            A[k][j] *= inverse;
        for (int r = 0; r < 6; r++) {
            double complex f = A[r][k];
            if (r == k)
                continue;
            for (int j = k; j < 12; j++)
                A[r][j] -= f * A[k][j];
        }
    }
    for (int r = 0; r < 6; r++)
        for (int j = 6; j < 12; j++)
            sum += creal(A[r][j]) * creal(A[r][j]) + cimag(A[r][j]) * cimag(A[r][j]);
    return sum > 0.0 && sum < 1e300 ? 1.0 / sqrt(sum) : 0.0;
}
