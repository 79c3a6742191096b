/* All solutions of a loop of six turning joints for one target: elimination, Newton's steps, proof and count.

   Comes after lanes.h in each of the files that are compiled for a set of instructions. Python's `raghavan_roth`,
   `window` and `complex_newton` are the reference. What is counted are distinct regular complex solutions; where they
   are as many as the loop has, no other exists. Poses next door are asked where some are missing: what is found there
   is brought to the target by Newton's steps, and counted by the same rules.
*/

#include <complex.h>
#include <string.h>

#include "eigen.h"
#include "motions.h"
#include "complex_loop.h"
#include "loop_newton.h"
#include "paths.h"

/* |Im x| above which a root is tried as a complex one; what a complex solution's must exceed [rad]. */
#define COMPLEX_ROOT 1e-9
#define COMPLEX_VALUE 1e-7

/* |x^2 + 1| of a root that is one of the equations' own x = +-i. */
#define SPURIOUS 1e-6

/* Roots that a singular pencil makes greater still are infinite: this is their square. */
#define LARGEST_ROOT 1e200

/* An imaginary part of an angle beyond this comes from a root at +-i. */
#define STEEPEST 20.0

/* Steps of the polish of real candidates and of complex ones, and of the latter from next door. */
#define REAL_STEPS 12
#define COMPLEX_STEPS 3
#define STEPS_HOME 6

/* Residuals [sizes and rad]: of what is listed, of complex candidates that are left as they are, of solutions. */
#define CLOSES 1e-9
#define ROUGH 1e-12
#define CLOSED 1e-9

/* Values that differ by less in every joint [rad] are one solution: real ones in the list, and any that are counted. */
#define EQUAL 1e-6
#define APART 1e-4

/* What tells regular solutions: see `complex_newton` and `window`. */
#define REGULAR 1e-6
#define CLEARLY_REGULAR 1e-4

/* Candidates on their way to infinity. */
#define AWAY 2.0
#define STILL 1e-13
#define FAR_OUT 7.0
#define STEP_ON 1e-2

/* An imaginary part [rad] above which no real solution is near. */
#define CLEARLY_IMAGINARY 0.03

/* Solutions of a target that are known. */
typedef struct {
    int real, pairs;
    double q[MOST_CANDIDATES][6], position[MOST_CANDIDATES], angle[MOST_CANDIDATES];
    int counted[MOST_CANDIDATES];
    double re[MOST_CANDIDATES][6], im[MOST_CANDIDATES][6];
} Known;

/* Candidates of one pose. */
typedef struct {
    int real, pairs;
    double q[MOST_CANDIDATES][6];
    double complex z[MOST_CANDIDATES][6];
} Tried;

static inline double squared_size(double complex z) { return creal(z) * creal(z) + cimag(z) * cimag(z); }

static inline double complex logarithm(double complex z) {
    return 0.5 * log(squared_size(z)) + I * atan2(cimag(z), creal(z));
}

static inline double complex times(double complex a, double complex b) {
    return (creal(a) * creal(b) - cimag(a) * cimag(b)) + I * (creal(a) * cimag(b) + cimag(a) * creal(b));
}

static inline double complex over(double complex a, double complex b) {
    double size = 1.0 / squared_size(b);
    return (creal(a) * creal(b) + cimag(a) * cimag(b)) * size + I * ((cimag(a) * creal(b) - creal(a) * cimag(b)) * size);
}

/* Angles are within some turns: they come from arcs, and the shift. */
static inline void real_turn(Part q, Part *c, Part *s) { sine_cosine(q, s, c); }

static inline Part real_angle(Part cosine, Part sine) {
    Part angle;
    for (int l = 0; l < 4; l++)
        angle[l] = arc(sine[l], cosine[l]);
    return angle;
}

static inline Part real_between(Part g[4][2], Part f[4][2]) {
    Part sine = {0.0}, cosine = {0.0};
    for (int k = 0; k < 4; k++) {
        sine += g[k][0] * f[k][1] - g[k][1] * f[k][0];
        cosine += g[k][0] * f[k][0] + g[k][1] * f[k][1];
    }
    return real_angle(cosine, sine);
}

#define NUM Part
#define VALUES real_values
#define TURN_OF real_turn
#define RATIO(y, one) (2.0 * real_angle(one, y))
#define ANGLE(c, s, scale) real_angle(c, s)
#define SIZE2(z) ((z) * (z))
#define BETWEEN real_between
#define REAL_OF Part
#define PICK chosen
#define UNIT ONE
#include "joint_values.h"

static inline void complex_turn(double complex q, double complex *c, double complex *s) {
    Part sine, cosine;
    double e = exp(cimag(q)), other = 1.0 / e;
    sine_cosine(even(creal(q)), &sine, &cosine);
    *c = cosine[0] * (0.5 * (e + other)) - I * (sine[0] * (0.5 * (e - other)));
    *s = sine[0] * (0.5 * (e + other)) + I * (cosine[0] * (0.5 * (e - other)));
}

/* 2 atan(y / one) */
static inline double complex complex_ratio(double complex y, double complex one) {
    return -I * logarithm(over(one + I * y, one - I * y));
}

static inline double complex complex_angle(double complex c, double complex s, double scale) {
    double complex forth = (c + I * s) / scale, back = (c - I * s) / scale;
    return squared_size(forth) >= squared_size(back) ? -I * logarithm(forth) : I * logarithm(back);
}

static inline double complex complex_between(double complex g[4][2], double complex f[4][2]) {
    double a = 0.0, b = 0.0;
    double complex forth = 0.0, back = 0.0;
    for (int k = 0; k < 4; k++) {
        double complex plus = g[k][0] + I * g[k][1], minus = g[k][0] - I * g[k][1];
        a += squared_size(plus);
        b += squared_size(minus);
        forth += times(conj(plus), f[k][0] + I * f[k][1]);
        back += times(conj(minus), f[k][0] - I * f[k][1]);
    }
    return squared_size(forth) * b * b >= squared_size(back) * a * a ? -I * logarithm(forth / a)
                                                                      : I * logarithm(back / b);
}

#define NUM double complex
#define VALUES complex_values
#define TURN_OF complex_turn
#define RATIO complex_ratio
#define ANGLE complex_angle
#define SIZE2 squared_size
#define BETWEEN complex_between
#define REAL_OF double
#define PICK(which, a, b) ((which) ? (a) : (b))
#define UNIT 1.0
#include "joint_values.h"

/* Vectors of the pencil as the products (12), in the basis if there is one. */
static void products_of(const Equations *eq, const Part *x, Part v[12]) {
    for (int j = 0; j < 12; j++) {
        Part sum = eq->free ? (Part){0.0} : x[j];
        for (int i = 0; eq->free && i < eq->columns; i++)
            sum += x[i] * eq->basis[i][j];
        v[j] = sum;
    }
}

/* The imaginary part up to which a complex root may be two real ones. */
static double nearly_real(const Elimination *E, double a, double b) {
    double squared = a * a + b * b;
    return E->imaginary * (1.0 + (squared < LARGEST_ROOT ? squared : LARGEST_ROOT));
}

/* Whether a complex root is not one of the equations' own x = +-i; next to the real ones they are tried all the same. */
static int is_root(const Elimination *E, double a, double b) {
    double complex root = a + I * b;
    return b <= nearly_real(E, a, b) || squared_size(times(root, root) + 1.0) > SPURIOUS * SPURIOUS;
}

/* Values (6) of some of four candidates are put down where they are numbers. */
static void put_real(const Part values[6], int count, Tried *tried) {
    for (int l = 0; l < count; l++) {
        int sound = 1;
        for (int i = 0; i < 6; i++) {
            tried->q[tried->real][i] = values[i][l];
            sound &= fabs(values[i][l]) < 1e6;
        }
        tried->real += sound;
    }
}

/* Candidates for real roots, up to four. */
static void try_real(const Elimination *E, const Equations *eq, const Eigen *matrix, Part roots, int count,
                     Tried *tried) {
    Part x[ORDER], v[12], values[6];
    real_vectors(matrix, roots, x);
    brought_back(matrix, x);
    products_of(eq, x, v);
    real_values(E, eq, roots, v, values);
    put_real(values, count, tried);
}

/* Candidates for a complex root a + i b, b > 0, whose conjugate is meant, too, and the products u (12). */
static void try_pair(const Elimination *E, const Equations *eq, double a, double b, const double complex *u,
                     Tried *tried) {
    double complex root = a + I * b, largest = 0.0, *values = tried->z[tried->pairs];
    if (b <= nearly_real(E, a, b)) {
        /* Two real roots that come out as a pair x +- i d are taken for x +- d. */
        const Part sign = {1.0, -1.0, 1.0, -1.0};
        Part both[12], q[6];
        for (int j = 0; j < 12; j++)
            largest = squared_size(u[j]) > squared_size(largest) ? u[j] : largest;
        for (int j = 0; j < 12; j++) {
            double complex z = over(u[j], largest);
            both[j] = even(creal(z)) + sign * cimag(z);
        }
        real_values(E, eq, even(a) + sign * b, both, q);
        put_real(q, 2, tried);
    }
    if (b <= COMPLEX_ROOT || squared_size(times(root, root) + 1.0) <= SPURIOUS * SPURIOUS)
        return;
    complex_values(E, eq, root, u, values);
    int sound = 1;
    for (int i = 0; i < 6; i++)
        sound &= fabs(creal(values[i])) < 1e6 && fabs(cimag(values[i])) < STEEPEST;
    tried->pairs += sound;
}

/* Candidates for complex roots, up to four. */
static void try_complex(const Elimination *E, const Equations *eq, const Eigen *matrix, Part re, Part im, int count,
                        Tried *tried) {
    Part x[ORDER], y[ORDER], v[12], w[12];
    complex_vectors(matrix, re, im, x, y);
    brought_back(matrix, x);
    brought_back(matrix, y);
    products_of(eq, x, v);
    products_of(eq, y, w);
    for (int l = 0; l < count; l++) {
        double complex u[12];
        for (int j = 0; j < 12; j++)
            u[j] = v[j][l] + I * w[j][l];
        try_pair(E, eq, re[l], im[l], u, tried);
    }
}

/* Part of roots (k) from `first` on, filled up by repeating one. */
static Part some_of(const double *roots, int k, int first) {
    Part some;
    for (int l = 0; l < 4; l++)
        some[l] = roots[first + l < k ? first + l : first];
    return some;
}

/* The candidates for the roots of a target's equations. */
static void of_roots(const Elimination *E, const Equations *eq, const Eigen *matrix, Tried *tried) {
    double real[ORDER], re[ORDER], im[ORDER];
    int reals = 0, pairs = 0;
    for (int k = 0; k < matrix->n; k++)
        if (matrix->im[k] == 0.0) {
            real[reals++] = matrix->re[k];
        } else if (matrix->im[k] > 0.0 && is_root(E, matrix->re[k], matrix->im[k])) {
            re[pairs] = matrix->re[k];
            im[pairs++] = matrix->im[k];
        }
    for (int k = 0; k < reals; k += 4)
        try_real(E, eq, matrix, some_of(real, reals, k), reals - k < 4 ? reals - k : 4, tried);
    for (int k = 0; k < pairs; k += 4)
        try_complex(E, eq, matrix, some_of(re, pairs, k), some_of(im, pairs, k), pairs - k < 4 ? pairs - k : 4, tried);
}

/* The candidates for a target's L6. */
static void candidates(const Elimination *E, const Motion *closing, Tried *tried) {
    Equations eq;
    Eigen matrix;
    tried->real = tried->pairs = 0;
    if (!NAMED(equations)(E, closing, &eq, &matrix))
        return;
    balance(&matrix);
    to_hessenberg(&matrix);
    if (!eigenvalues(&matrix))
        return;
    of_roots(E, &eq, &matrix, tried);
}

/* The same for an L6 (4, 4) in sizes as numbers: real ones (6) into `real`, one of each pair (6, re and im) into `pairs`. */
void NAMED(tried_candidates)(const Elimination *E, const double *L6, int *counts, double *real, double *pairs) {
    Motion closing;
    Tried tried;
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            closing.R[r][c] = L6[4 * r + c];
        closing.t[r] = L6[4 * r + 3];
    }
    candidates(E, &closing, &tried);
    counts[0] = tried.real;
    counts[1] = tried.pairs;
    memcpy(real, tried.q, (size_t)tried.real * sizeof tried.q[0]);
    for (int k = 0; k < tried.pairs; k++)
        for (int i = 0; i < 6; i++) {
            *pairs++ = creal(tried.z[k][i]);
            *pairs++ = cimag(tried.z[k][i]);
        }
}

/* The greatest difference of two configurations in a joint [rad], full turns left out. */
static double difference(const double *a, const double *b) {
    double greatest = 0.0;
    for (int i = 0; i < 6; i++) {
        double gap = a[i] - b[i];
        gap = fabs(gap - 6.28318530717958647692 * nearbyint(gap * 0.15915494309189533577));
        greatest = gap > greatest ? gap : greatest;
    }
    return greatest;
}

/* Whether a solution with a residual is told apart from others by the least singular value of S, or by det S. */
static int told_apart(double residual, double determinant, double squared, double *needed) {
    *needed = sqrt(residual / SURE);
    *needed = *needed > REGULAR ? *needed : REGULAR;
    double others = squared / 5.0;
    return determinant > *needed * (others * others * sqrt(others));
}

/* Real candidates that close, each once, with what the arm then lacks of the target. */
static void add_real(const Elimination *E, const Constant *closing, const double *T, const Tried *tried, Known *known) {
    for (int first = 0; first < tried->real; first += LANES) {
        Group group;
        double poses[16 * LANES], q[LANES][6];
        group.count = tried->real - first < LANES ? tried->real - first : LANES;
        memcpy(group.q, tried->q[first], (size_t)group.count * sizeof group.q[0]);
        refine(&E->loop, closing, &group, REAL_STEPS);
        for (int l = 0; l < group.count; l++)
            for (int i = 0; i < 6; i++)
                q[l][i] = group.q[l][i] - E->arm.offsets[i];
        NAMED(poses)(&E->arm, q[0], group.count, poses);
        for (int l = 0; l < group.count; l++) {
            double position = 0.0, angle = 0.0;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 4; j++) {
                    double gap = T[4 * i + j] - poses[16 * l + 4 * i + j];
                    *(j < 3 ? &angle : &position) += gap * gap;
                }
            position = sqrt(position);
            angle = sqrt(0.5 * angle);
            double residual = position / E->size > angle ? position / E->size : angle;
            if (!(residual <= CLOSES) || known->real >= MOST_CANDIDATES)
                continue;
            int place = known->real;
            for (int k = 0; k < known->real; k++)
                if (difference(known->q[k], group.q[l]) < EQUAL)
                    place = k;
            if (place < known->real &&
                known->position[place] / E->size + known->angle[place] <= position / E->size + angle)
                continue;
            int counted = group.determinant[l] > CLEARLY_REGULAR;
            if (!counted) {
                ComplexGroup one;
                double needed = sqrt(residual / SURE);
                one.count = 1;
                for (int i = 0; i < 6; i++)
                    for (int j = 0; j < LANES; j++) {
                        one.re[i][j] = group.q[l][i];
                        one.im[i][j] = 0.0;
                    }
                counted = least_singular(&E->loop, &one, 0) > (needed > REGULAR ? needed : REGULAR);
            }
            memcpy(known->q[place], group.q[l], sizeof known->q[place]);
            known->position[place] = position;
            known->angle[place] = angle;
            known->counted[place] = counted;
            known->real += place == known->real;
        }
    }
}

/* Complex candidates that are regular solutions, each once. */
static void add_complex(const Elimination *E, const Constant *closing, const Tried *tried, int steps, Known *known) {
    for (int first = 0; first < tried->pairs; first += LANES) {
        ComplexGroup group;
        group.count = tried->pairs - first < LANES ? tried->pairs - first : LANES;
        for (int l = 0; l < LANES; l++)
            for (int i = 0; i < 6; i++) {
                double complex z = tried->z[first + (l < group.count ? l : group.count - 1)][i];
                group.re[i][l] = creal(z);
                group.im[i][l] = cimag(z);
            }
        complex_refine(&E->loop, closing, &group, steps, ROUGH);
        for (int l = 0; l < group.count; l++) {
            double away = 0.0, re[6], im[6], needed, side = 0.0;
            for (int i = 0; i < 6; i++) {
                re[i] = group.re[i][l];
                im[i] = group.im[i][l];
                away = fabs(im[i]) > away ? fabs(im[i]) : away;
                if (side == 0.0 && fabs(im[i]) > COMPLEX_VALUE)
                    side = im[i];
            }
            double residual = group.residual[l];
            if (!(residual <= CLOSED) || !(away > COMPLEX_VALUE) || !(away < STEEPEST) || known->pairs >= MOST_CANDIDATES)
                continue;
            if (away > AWAY && (residual > STILL || away > FAR_OUT) && !(group.step[l] <= STEP_ON))
                continue;
            if (!told_apart(residual, group.determinant[l], group.squared[l], &needed) &&
                !(least_singular(&E->loop, &group, l) > needed))
                continue;
            /* Of a pair that with the positive imaginary part in the first joint that has any stands for both. */
            for (int i = 0; i < 6; i++)
                im[i] = side < 0.0 ? -im[i] : im[i];
            int new = 1;
            for (int k = 0; k < known->pairs && new; k++) {
                double gap = difference(known->re[k], re);
                for (int i = 0; i < 6; i++)
                    gap = fabs(known->im[k][i] - im[i]) > gap ? fabs(known->im[k][i] - im[i]) : gap;
                new = gap >= APART;
            }
            if (!new)
                continue;
            memcpy(known->re[known->pairs], re, sizeof re);
            memcpy(known->im[known->pairs], im, sizeof im);
            known->pairs++;
        }
    }
}

static int number_of(const Known *known) {
    int number = 2 * known->pairs;
    for (int k = 0; k < known->real; k++)
        number += known->counted[k] != 0;
    return number;
}

/* L6 = C6 T^-1 C0 of a target (4, 4) [m]. */
static void closing_of(const Elimination *E, const double *T, Motion *out) {
    Motion target;
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            target.R[r][c] = T[4 * r + c];
        target.t[r] = T[4 * r + 3] / E->size;
    }
    inverse_of(&target, &target);
    composed(&E->last, &target, &target);
    composed(&target, &E->first, out);
}

/* All that is found for a target T (4, 4) [m], a rigid motion. */
void NAMED(eliminated)(const Elimination *E, const double *T, Eliminated *out) {
    Motion closing, beside;
    Constant link;
    Tried tried;
    Known known;
    known.real = known.pairs = 0;
    closing_of(E, T, &closing);
    link_of(&closing, &link);
    candidates(E, &closing, &tried);
    out->tried = tried.real;
    add_real(E, &link, T, &tried, &known);
    add_complex(E, &link, &tried, COMPLEX_STEPS, &known);
    out->looked = 0;
    while (number_of(&known) < E->number && out->looked < E->beside) {
        composed(&E->away[out->looked++], &closing, &beside);
        candidates(E, &beside, &tried);
        /* Each solution comes from one of those that are counted as tried. */
        out->tried += tried.real;
        add_real(E, &link, T, &tried, &known);
        add_complex(E, &link, &tried, STEPS_HOME, &known);
    }
    out->number = number_of(&known);
    out->count = known.real;
    out->imaginary = INFINITY;
    for (int k = 0; k < known.pairs; k++) {
        double away = 0.0;
        for (int i = 0; i < 6; i++)
            away = fmax(away, fabs(known.im[k][i]));
        out->imaginary = fmin(out->imaginary, away);
    }
    for (int k = 0; k < known.real; k++) {
        for (int i = 0; i < 6; i++)
            out->q[k][i] = known.q[k][i] - E->arm.offsets[i];
        out->position[k] = known.position[k];
        out->angle[k] = known.angle[k];
    }
}

/* The solutions for a target T in the order of the list, which are put into `out`; 0 where others are to look at it, and
   NONE_AT_ALL where all are known and clearly complex.

   `tried`: how many candidates there were. */
int NAMED(listed_elimination)(const Elimination *E, const Form *form, const double *T, const Wanted *wanted,
                              Solutions *out, int *tried) {
    enum { GROUPS = MOST_CANDIDATES / LANES };
    Eliminated found;
    double q[GROUPS][SIX][LANES], least[LANES];
    Slot key[GROUPS], sum[GROUPS];
    Truth inside[GROUPS];
    int place[MOST_CANDIDATES] = {0}, doubt = 0;
    NAMED(eliminated)(E, T, &found);
    *tried = found.tried;
    int count = found.count;
    if (found.number == E->number && !found.tried && !found.looked && found.imaginary > CLEARLY_IMAGINARY)
        return NONE_AT_ALL;
    if (found.number != E->number || count < 2 || count % 2)
        return 0;
    for (int g = 0; g * LANES < count; g++) {
        int first = g * LANES, some = count - first < LANES ? count - first : LANES;
        for (int i = 0; i < SIX; i++)
            OVER_LANES q[g][i][l] = found.q[first + (l < some ? l : 0)][i];
        told(q[g], key[g], sum[g]);
        if (!limited(form, wanted, q[g], some, inside[g], &doubt))
            return 0;
    }
    for (int k = 0; k < count; k++)
        for (int j = 0; j < k; j++) {
            double before = key[k / LANES][k % LANES], other = key[j / LANES][j % LANES];
            if (before == other)
                return 0;
            place[before > other ? k : j]++;
            doubt |= fabs(sum[k / LANES][k % LANES] - sum[j / LANES][j % LANES]) < CLOSE;
        }
    for (int g = 0; doubt && g * LANES < count; g++) {
        int first = g * LANES, some = count - first < LANES ? count - first : LANES;
        for (int l = 0; l < LANES; l++) {
            int k = first + (l < some ? l : 0);
            double off = fmax(found.position[k] / E->size, found.angle[k]);
            least[l] = fmax(SINGULAR, sqrt(off / SURE));
        }
        if (!regular(form, q[g], some, least))
            return 0;
    }
    for (int k = 0; k < count; k++) {
        int to = place[k];
        for (int i = 0; i < SIX; i++)
            out->q[SIX * to + i] = q[k / LANES][i][k % LANES];
        out->position[to] = found.position[k];
        out->angle[to] = found.angle[k];
        out->inside[to] = inside[k / LANES][k % LANES] != 0;
    }
    out->listed = count;
    return count;
}
