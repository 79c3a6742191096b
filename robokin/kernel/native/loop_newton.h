/* Newton steps on the loop equation J1 L1 ... J6 L6 = 1 of turning joints, for LANES candidates of one target at once.

   Python's `loop_newton` and `complex_newton` are the reference, and say what is derived how. Comes after
   complex_loop.h.
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

/* X L for an L of each candidate: columns x, y, z, p. */
static void close_up(Frame *X, double L[12][LANES]) {
    Frame Y;
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            FOR_PARTS {
                Part x = PART(X->v[r]), y = PART(X->v[3 + r]), z = PART(X->v[6 + r]);
                Part sum = c < 3 ? PART(L[3 * c]) * x : PART(X->v[9 + r]) + PART(L[9]) * x;
                PART(Y.v[3 * c + r]) = sum + PART(L[3 * c + 1]) * y + PART(L[3 * c + 2]) * z;
            }
    *X = Y;
}

/* What candidates lack of closing, the next step y and whether it is called for. */
static void look(const Chain *loop, double L[12][LANES], Group *group, double y[6][LANES], double open[LANES]) {
    double axes[MOST_JOINTS][6][LANES], S[6][6][LANES], e[6][LANES], A[6][6][LANES], damping[LANES], longest[LANES];
    Frame X;
    followed(loop, group->q[0], LANES, axes, &X);
    close_up(&X, L);
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
    for (int k = 0; k < 6; k++)
        for (int l = 0; l < LANES; l++)
            y[k][l] *= LONGEST / longest[l];
}

/* Steps on real candidates until they close, or `steps` were made. */
static void refine(const Chain *loop, const Constant *closing, Group *group, int steps) {
    double L[12][LANES], y[6][LANES], open[LANES];
    for (int j = 0; j < 12; j++)
        for (int l = 0; l < LANES; l++)
            L[j][l] = closing->m[j];
    for (int l = group->count; l < LANES; l++)
        memcpy(group->q[l], group->q[0], sizeof group->q[l]);
    for (int step = 0;; step++) {
        int going = 0;
        look(loop, L, group, y, open);
        for (int l = 0; l < group->count; l++)
            going |= open[l] != 0.0;
        if (!going || step == steps)
            return;
        for (int l = 0; l < group->count; l++)
            for (int k = 0; open[l] != 0.0 && k < 6; k++)
                group->q[l][k] -= y[k][l];
    }
}

/* Steps on candidates (m, 6) of an L6 (m, 4, 4) each; what they then lack, `off` (m, 2), in size and angle.

   One that has come to its end makes room for the next. */
void NAMED(refined)(const Chain *loop, const double *closing, double *values, ptrdiff_t m, int steps, double *off) {
    Group group;
    double L[12][LANES], y[6][LANES], open[LANES];
    ptrdiff_t place[LANES], next = 0, going = 0;
    int made[LANES];
    if (!m)
        return;
    group.count = LANES;
    for (int l = 0; l < LANES; l++) {
        place[l] = -2;
        made[l] = 0;
        open[l] = 0.0;
    }
    do {
        for (int l = 0; l < LANES; l++) {
            ptrdiff_t row = place[l];
            if (row >= 0 && open[l] != 0.0 && made[l] < steps) {
                for (int k = 0; k < 6; k++)
                    group.q[l][k] -= y[k][l];
                made[l]++;
                continue;
            }
            if (row >= 0) {
                memcpy(values + 6 * row, group.q[l], sizeof group.q[l]);
                off[2 * row] = group.position[l];
                off[2 * row + 1] = group.angle[l];
                going--;
            }
            if (row == -1 || (next >= m && row != -2)) {
                place[l] = -1;
                continue;
            }
            /* Where there are fewer than lanes some are the first once more. */
            ptrdiff_t from = next < m ? next : 0;
            place[l] = next < m ? next++ : -1;
            going += place[l] >= 0;
            made[l] = 0;
            memcpy(group.q[l], values + 6 * from, sizeof group.q[l]);
            for (int c = 0; c < 4; c++)
                for (int r = 0; r < 3; r++)
                    L[3 * c + r][l] = closing[16 * from + 4 * r + c];
        }
        if (going)
            look(loop, L, &group, y, open);
    } while (going);
}

/* The values of four of a group. */
static void values_of(const ComplexGroup *g, int h, Complex q[6]) {
    for (int i = 0; i < 6; i++)
        q[i] = (Complex){CONSTANT(g->re[i]), CONSTANT(g->im[i])};
}

/* What the loop lacks of closing at complex values, relative to the size of its terms, Newton's step, and det S. */
static void complex_look(const Chain *loop, const Constant *closing, ComplexGroup *g) {
    FOR_PARTS {
        Complex q[6], S[6][6], X[4][3], e[1][6], lack;
        Part size, squared = {0.0}, length = {0.0};
        values_of(g, h, q);
        complex_followed(loop, q, S, X, &size);
        complex_go_on(X, closing);
        complex_error(X, e[0], &lack);
        PART(g->residual) = complex_residual(e[0], lack, size);
        for (int i = 0; i < 6; i++)
            for (int r = 0; r < 6; r++)
                squared += absolute_squared(S[i][r]);
        PART(g->squared) = squared;
        PART(g->determinant) = roots(absolute_squared(complex_solved(S, e, 1)));
        for (int i = 0; i < 6; i++) {
            PART(g->dre[i]) = e[0][i].re;
            PART(g->dim[i]) = e[0][i].im;
            length = greater(roots(absolute_squared(e[0][i])), length);
        }
        PART(g->step) = length;
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
static double least_singular(const Chain *loop, const ComplexGroup *g, int l) {
    Complex q[6], S[6][6], X[4][3];
    Part size;
    double sum = 0.0;
    double complex A[6][12];
    values_of(g, l / 4, q);
    complex_followed(loop, q, S, X, &size);
    for (int r = 0; r < 6; r++)
        for (int i = 0; i < 6; i++) {
            A[r][i] = S[i][r].re[l % 4] + I * S[i][r].im[l % 4];
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

/* Whether the least singular value of S at complex values (m, 6) is above what is needed (m,): 1, 0, or -1 for doubt.

   The product of the other five is at most (|S|^2 / 5)^(5/2); 1 / |S^-1| is at most the least one, and a root of six
   times that at least.
*/
void NAMED(regulars)(const Chain *loop, const double *values, const double *needed, ptrdiff_t m, double *answer) {
    for (ptrdiff_t first = 0; first < m; first += 4) {
        int count = m - first < 4 ? (int)(m - first) : 4, open = 0;
        Complex q[6], S[6][6], other[6][6], X[4][3], identity[6][6];
        Part size, squared = {0.0}, inverse = {0.0};
        for (int l = 0; l < 4; l++)
            for (int i = 0; i < 6; i++) {
                const double *z = values + 12 * (first + (l < count ? l : 0)) + 2 * i;
                q[i].re[l] = z[0];
                q[i].im[l] = z[1];
            }
        complex_followed(loop, q, S, X, &size);
        for (int i = 0; i < 6; i++)
            for (int r = 0; r < 6; r++)
                squared += absolute_squared(S[i][r]);
        memcpy(other, S, sizeof S);
        Part determinant = roots(absolute_squared(complex_solved(other, NULL, 0)));
        for (int l = 0; l < count; l++) {
            double others = squared[l] / 5.0, *to = answer + first + l;
            *to = determinant[l] > needed[first + l] * (others * others * sqrt(others)) ? 1.0
                  : is_number(squared[l])                                               ? -1.0
                                                                                        : 0.0;
            open |= *to < 0.0;
        }
        if (!open)
            continue;
        memset(identity, 0, sizeof identity);
        for (int i = 0; i < 6; i++)
            identity[i][i].re = ONE;
        complex_solved(S, identity, 6);
        for (int i = 0; i < 6; i++)
            for (int r = 0; r < 6; r++)
                inverse += absolute_squared(identity[i][r]);
        for (int l = 0; l < count; l++) {
            double least = 1.0 / sqrt(inverse[l]), *to = answer + first + l;
            /* Near rounding the inverse is not known well enough. */
            if (*to < 0.0 && least > 1e-12)
                *to = 0.99 * least > needed[first + l] ? 1.0 : 2.5 * least < needed[first + l] ? 0.0 : -1.0;
        }
    }
}
