/* Chains followed for LANES configurations at a time; one configuration gives the same digits as many. */

#include "chain.h"
#include "vectors.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* The frame x, y, z, p of LANES configurations: entry r of column c is at [3 c + r]. */
typedef struct {
    double v[12][LANES];
} Frame;

static void start(const Chain *chain, Frame *F) {
    for (int j = 0; j < 12; j++)
        for (int l = 0; l < LANES; l++)
            F->v[j][l] = chain->first[j];
}

static void turn(Frame *F, const double *c, const double *s) {
    FOR_PARTS {
        Part cosine = CONSTANT(c), sine = CONSTANT(s);
        for (int r = 0; r < 3; r++) {
            Part x = PART(F->v[r]), y = PART(F->v[3 + r]);
            PART(F->v[r]) = cosine * x + sine * y;
            PART(F->v[3 + r]) = cosine * y - sine * x;
        }
    }
}

static void slide(Frame *F, const double *q) {
    for (int r = 0; r < 3; r++)
        FOR_PARTS PART(F->v[9 + r]) += CONSTANT(q) * PART(F->v[6 + r]);
}

/* F C, leaving out what zeros of C spare. */
static void go_on(Frame *F, const Constant *C) {
    Frame G;
    if (C->shifts)
        for (int j = 0; j < 3; j++)
            if (C->m[9 + j] != 0.0)
                for (int r = 0; r < 3; r++)
                    for (int l = 0; l < LANES; l++)
                        F->v[9 + r][l] += C->m[9 + j] * F->v[3 * j + r][l];
    if (!C->turns)
        return;
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) {
            double *out = G.v[3 * c + r];
            int begun = 0;
            for (int j = 0; j < 3; j++) {
                double m = C->m[3 * c + j];
                const double *in = F->v[3 * j + r];
                if (m == 0.0)
                    continue;
                if (!begun)
                    for (int l = 0; l < LANES; l++)
                        out[l] = m * in[l];
                else
                    for (int l = 0; l < LANES; l++)
                        out[l] += m * in[l];
                begun = 1;
            }
            if (!begun)
                for (int l = 0; l < LANES; l++)
                    out[l] = 0.0;
        }
    for (int j = 0; j < 9; j++)
        for (int l = 0; l < LANES; l++)
            F->v[j][l] = G.v[j][l];
}

/* The joints' values s (n, LANES) to their sines and cosines; slides keep theirs. */
static void sines(const Chain *chain, double s[][LANES], double c[][LANES]) {
    for (int i = 0; i < chain->n; i++) {
        double x[LANES];
        int far = 0;
        if (!chain->revolute[i])
            continue;
        for (int l = 0; l < LANES; l++) {
            x[l] = s[i][l];
            far |= !(fabs(x[l]) <= FARTHEST);
        }
        FOR_PARTS {
            Part sine, cosine;
            sine_cosine(PART(x), &sine, &cosine);
            PART(s[i]) = sine;
            PART(c[i]) = cosine;
        }
        if (far)
            for (int l = 0; l < LANES; l++)
                if (!(fabs(x[l]) <= FARTHEST)) {
                    s[i][l] = sin(x[l]);
                    c[i][l] = cos(x[l]);
                }
    }
}

/* Rows q (count, n) to sines and cosines of the turning joints; slides keep their values in `s`. */
static void prepared(const Chain *chain, const double *q, ptrdiff_t count, double s[][LANES], double c[][LANES]) {
    for (int i = 0; i < chain->n; i++)
        for (int l = 0; l < LANES; l++) {
            ptrdiff_t row = l < count ? l : count - 1;
            s[i][l] = q[row * chain->n + i] + chain->offsets[i];
        }
    sines(chain, s, c);
}

static void put(const Frame *F, double *out, ptrdiff_t step, ptrdiff_t count) {
    for (ptrdiff_t l = 0; l < count; l++, out += step) {
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++)
                out[4 * r + c] = F->v[3 * c + r][l];
        out[12] = out[13] = out[14] = 0.0;
        out[15] = 1.0;
    }
}

static void moved(const Chain *chain, int i, Frame *F, double s[][LANES], double c[][LANES]) {
    if (chain->revolute[i])
        turn(F, c[i], s[i]);
    else
        slide(F, s[i]);
    go_on(F, &chain->links[i]);
}

#include "one_row.h"

/* Poses of the tool (m, 4, 4) at q (m, n). */
void NAMED(poses)(const Chain *chain, const double *q, ptrdiff_t m, double *out) {
    double s[MOST_JOINTS][LANES], c[MOST_JOINTS][LANES];
    Frame F;
    if (m == 1) {
        row_pose(chain, q, out);
        return;
    }
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        ptrdiff_t count = m - first < LANES ? m - first : LANES;
        prepared(chain, q + first * chain->n, count, s, c);
        start(chain, &F);
        for (int i = 0; i < chain->n; i++)
            moved(chain, i, &F, s, c);
        put(&F, out + 16 * first, 16, count);
    }
}

/* The frames (m, n + 1, 4, 4) that joints start from, and the tool's, at q (m, n). */
void NAMED(frames)(const Chain *chain, const double *q, ptrdiff_t m, double *out) {
    double s[MOST_JOINTS][LANES], c[MOST_JOINTS][LANES];
    Frame F;
    ptrdiff_t step = 16 * (chain->n + 1);
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        ptrdiff_t count = m - first < LANES ? m - first : LANES;
        prepared(chain, q + first * chain->n, count, s, c);
        start(chain, &F);
        for (int i = 0; i < chain->n; i++) {
            put(&F, out + step * first + 16 * i, step, count);
            moved(chain, i, &F, s, c);
        }
        put(&F, out + step * first + 16 * chain->n, step, count);
    }
}

/* Axes z and o of the joints (n, 6, LANES) and the tool's frame. */
static void followed(const Chain *chain, const double *q, ptrdiff_t count, double axes[][6][LANES], Frame *F) {
    double s[MOST_JOINTS][LANES], c[MOST_JOINTS][LANES];
    prepared(chain, q, count, s, c);
    start(chain, F);
    for (int i = 0; i < chain->n; i++) {
        for (int j = 0; j < 6; j++)
            for (int l = 0; l < LANES; l++)
                axes[i][j][l] = F->v[6 + j][l];
        moved(chain, i, F, s, c);
    }
}

/* Column i of the Jacobian (6, LANES): (z x (p - o) / size, z), or (z, 0) of a slide. */
static void column(const Chain *chain, int i, double axis[6][LANES], const Frame *F, double size, double J[6][LANES]) {
    if (!chain->revolute[i]) {
        for (int r = 0; r < 3; r++)
            for (int l = 0; l < LANES; l++) {
                J[r][l] = axis[r][l];
                J[3 + r][l] = 0.0;
            }
        return;
    }
    double lever[3][LANES];
    for (int r = 0; r < 3; r++)
        for (int l = 0; l < LANES; l++)
            lever[r][l] = (F->v[9 + r][l] - axis[3 + r][l]) / size;
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        for (int l = 0; l < LANES; l++) {
            J[r][l] = axis[a][l] * lever[b][l] - axis[b][l] * lever[a][l];
            J[3 + r][l] = axis[r][l];
        }
    }
}

/* Jacobians (m, 6, n) at q (m, n), in the axes of the base or, if `tool`, of the tool. */
void NAMED(jacobians)(const Chain *chain, const double *q, ptrdiff_t m, double size, int tool, double *out) {
    double axes[MOST_JOINTS][6][LANES], J[6][LANES], R[6][LANES];
    Frame F;
    int n = chain->n;
    if (m == 1 && size == 1.0 && !tool) {
        row_jacobian(chain, q, out);
        return;
    }
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        ptrdiff_t count = m - first < LANES ? m - first : LANES;
        followed(chain, q + first * n, count, axes, &F);
        for (int i = 0; i < n; i++) {
            column(chain, i, axes[i], &F, size, J);
            if (tool) {
                for (int h = 0; h < 6; h += 3)
                    for (int r = 0; r < 3; r++)
                        for (int l = 0; l < LANES; l++)
                            R[h + r][l] = F.v[3 * r][l] * J[h][l] + F.v[3 * r + 1][l] * J[h + 1][l] +
                                          F.v[3 * r + 2][l] * J[h + 2][l];
                for (int r = 0; r < 6; r++)
                    for (int l = 0; l < LANES; l++)
                        J[r][l] = R[r][l];
            }
            for (ptrdiff_t l = 0; l < count; l++)
                for (int r = 0; r < 6; r++)
                    out[(first + l) * 6 * n + r * n + i] = J[r][l];
        }
    }
}

/* The columns x, y, z, p of a target (4, 4) into lane l. */
static void put_target(const double *T, int l, double W[12][LANES]) {
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++)
            W[3 * c + r][l] = T[4 * r + c];
}

/* What frames lack of targets W: e (6, LANES), in sizes and radians. */
static void pose_errors(const Frame *F, double W[12][LANES], int count, double size, double e[6][LANES]) {
    double w[3][LANES], trace[LANES];
    for (int l = 0; l < LANES; l++)
        trace[l] = 0.0;
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        for (int l = 0; l < LANES; l++)
            w[r][l] = 0.0;
        for (int c = 0; c < 3; c++)
            for (int l = 0; l < LANES; l++)
                w[r][l] += F->v[3 * c + a][l] * W[3 * c + b][l] - F->v[3 * c + b][l] * W[3 * c + a][l];
    }
    for (int j = 0; j < 9; j++)
        for (int l = 0; l < LANES; l++)
            trace[l] += F->v[j][l] * W[j][l];
    for (int l = 0; l < count; l++) {
        for (int r = 0; r < 3; r++)
            e[r][l] = (W[9 + r][l] - F->v[9 + r][l]) / size;
        double sine = 0.5 * sqrt(w[0][l] * w[0][l] + w[1][l] * w[1][l] + w[2][l] * w[2][l]);
        double cosine = 0.5 * (trace[l] - 1.0);
        if (sine < HALF_TURN && cosine < 0.0) {
            /* Half a turn has no sine and so no direction here: it must still not pass for none. */
            e[3][l] = 3.14159265358979323846;
            e[4][l] = e[5][l] = 0.0;
            continue;
        }
        double scale = 0.5 * atan2(sine, cosine) / (sine > 1e-300 ? sine : 1e-300);
        for (int r = 0; r < 3; r++)
            e[3 + r][l] = w[r][l] * scale;
    }
}

/* What poses at q (m, n) lack of targets T (m, 4, 4): (m, 6) in sizes and radians, and the Jacobians (m, 6, n). */
void NAMED(errors)(const Chain *chain, const double *T, const double *q, ptrdiff_t m, double size, double *error,
                   double *jacobian) {
    double axes[MOST_JOINTS][6][LANES], J[6][LANES], W[12][LANES], e[6][LANES];
    Frame F;
    int n = chain->n;
    for (ptrdiff_t first = 0; first < m; first += LANES) {
        ptrdiff_t count = m - first < LANES ? m - first : LANES;
        followed(chain, q + first * n, count, axes, &F);
        for (int i = 0; i < n; i++) {
            column(chain, i, axes[i], &F, size, J);
            for (ptrdiff_t l = 0; l < count; l++)
                for (int r = 0; r < 6; r++)
                    jacobian[(first + l) * 6 * n + r * n + i] = J[r][l];
        }
        for (int l = 0; l < LANES; l++)
            put_target(T + 16 * (first + (l < count ? l : count - 1)), l, W);
        pose_errors(&F, W, (int)count, size, e);
        for (ptrdiff_t l = 0; l < count; l++)
            for (int r = 0; r < 6; r++)
                error[6 * (first + l) + r] = e[r][l];
    }
}
