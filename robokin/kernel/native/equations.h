/* The equations of the elimination for one target: the matrix whose eigenvalues are the roots.

   Python's `fourteen_functions`, `raghavan_roth` and `pencil` are the reference, and say what is derived how; this is
   for loops whose joints all turn. A matrix of functions (15, k) is kept with rows of sixteen.
*/

#include "motions.h"

#include <complex.h>
#include <math.h>
#include <string.h>

/* C = A B for A (m, k) and B (k, n), n = 4 w, with rows of the given lengths. */
static inline void product(int m, int k, int w, const double *A, int a, const double *B, int b, double *C, int c) {
    for (int i = 0; i < m; i++, A += a, C += c) {
        Part sum[ORDER / 4];
        for (int j = 0; j < w; j++)
            sum[j] = (Part){0.0};
        for (int l = 0; l < k; l++) {
            const Part *row = (const Part *)(B + l * b);
            for (int j = 0; j < w; j++)
                sum[j] += A[l] * row[j];
        }
        for (int j = 0; j < w; j++)
            ((Part *)C)[j] = sum[j];
    }
}

/* R U for three rows U of functions. */
static inline void turned(const double R[3][3], double U[3][16], double out[3][16]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 16; j++)
            out[i][j] = R[i][0] * U[0][j] + R[i][1] * U[1][j] + R[i][2] * U[2][j];
}

/* out += f t x U */
static inline void add_cross(double f, const double t[3], double U[3][16], double out[3][16]) {
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        double ta = f * t[a], tb = f * t[b];
        for (int j = 0; j < 16; j++)
            out[i][j] += ta * U[b][j] - tb * U[a][j];
    }
}

/* A(M) applied to functions. */
static void act(const Motion *M, Functions V, Functions out) {
    Functions W;
    const double *t = M->t;
    double tt = t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
    memcpy(W[0], V[0], sizeof W[0]);
    for (int i = 1; i < 13; i += 3)
        turned(M->R, V + i, W + i);
    for (int j = 0; j < 16; j++) {
        double tl = t[0] * W[1][j] + t[1] * W[2][j] + t[2] * W[3][j];
        double tp = t[0] * W[4][j] + t[1] * W[5][j] + t[2] * W[6][j];
        W[13][j] = V[13][j] + 2.0 * tp + tt * V[0][j];
        W[14][j] = V[14][j] + tl;
        for (int i = 0; i < 3; i++) {
            W[10 + i][j] += tt * W[1 + i][j] - 2.0 * t[i] * (tl + V[14][j]);
            W[4 + i][j] += t[i] * V[0][j];
        }
    }
    add_cross(2.0, t, W + 7, W + 10);
    add_cross(-1.0, t, W + 1, W + 7);
    memcpy(out, W, sizeof W);
}

/* A(J) V: columns for 1, cos and sin of the joint, k of each, or of the joint turned back. */
static void times_joint(Functions V, int k, double sign, Functions out) {
    Functions W;
    memset(W, 0, sizeof W);
    for (int i = 0; i < 15; i++) {
        int part = i >= 1 && i < 13 ? (i - 1) % 3 : 2;
        for (int j = 0; j < k; j++)
            if (part == 2) {
                W[i][j] = V[i][j];
            } else {
                W[i][k + j] = V[i][j];
                W[i][2 * k + j] = sign * (part ? V[i - 1][j] : -V[i + 1][j]);
            }
    }
    memcpy(out, W, sizeof W);
}

static void functions_of_identity(Functions V) {
    memset(V, 0, sizeof(Functions));
    V[0][0] = V[3][0] = 1.0;
}

/* Orthonormal rows, the first `rank` of which span `rank` or more rows (k, 16) of length n; Q: the rows from `from` on.

   By reflections, the longest of the rest first: then more rows than the rank do no harm. The rows, zero from n on, are
   overwritten. */
static __attribute__((noinline)) void spanning(int n, int k, int rank, double (*A)[16], int from, double (*Q)[16]) {
    double tau[16], V[16][16];
    int width = (n + 3) & ~3;
    rank = rank < k ? rank : k;
    for (int s = 0; s < rank; s++) {
        int best = s;
        double greatest = dot_of(A[s], A[s], 0, width);
        for (int i = s + 1; i < k && rank < k; i++) {
            double sum = dot_of(A[i], A[i], 0, width);
            if (sum > greatest) {
                greatest = sum;
                best = i;
            }
        }
        memcpy(V[s], A[best], sizeof V[s]);
        memcpy(A[best], A[s], sizeof V[s]);
        double length = sqrt(greatest), first = V[s][s];
        V[s][s] += first > 0.0 ? length : -length;
        tau[s] = greatest > 0.0 ? 1.0 / (greatest + fabs(first) * length) : 0.0;
        for (int i = s + 1; i < k; i++) {
            double f = tau[s] * dot_of(V[s], A[i], 0, width);
            less_row(A[i], f, V[s], width);
            A[i][s] = 0.0;
        }
    }
    for (int i = from; i < n; i++) {
        double *q = Q[i - from];
        memset(q, 0, 16 * sizeof *q);
        q[i] = 1.0;
        for (int s = rank - 1; s >= 0; s--)
            less_row(q, tau[s] * dot_of(V[s], q, 0, width), V[s], width);
    }
}

/* The same for complex rows (k, 6): those (n - rank, 6) that are left, u with u a^H = 0 for every row a. */
static void complex_rest(int n, int k, int rank, double complex (*A)[6], double complex (*Q)[6]) {
    double tau[6];
    double complex V[6][6];
    for (int s = 0; s < rank; s++) {
        int best = s;
        double greatest = -1.0;
        for (int i = s; i < k; i++) {
            double sum = 0.0;
            for (int j = s; j < n; j++)
                sum += creal(A[i][j]) * creal(A[i][j]) + cimag(A[i][j]) * cimag(A[i][j]);
            if (sum > greatest) {
                greatest = sum;
                best = i;
            }
        }
        double complex row[6];
        memcpy(row, A[best], sizeof row);
        memcpy(A[best], A[s], sizeof row);
        memset(V[s], 0, sizeof V[s]);
        tau[s] = 0.0;
        if (!(greatest > 0.0))
            continue;
        double length = sqrt(greatest), first = cabs(row[s]);
        for (int j = s; j < n; j++)
            V[s][j] = row[j];
        V[s][s] += first > 0.0 ? row[s] * (length / first) : length;
        double size = 0.0;
        for (int j = s; j < n; j++)
            size += creal(V[s][j]) * creal(V[s][j]) + cimag(V[s][j]) * cimag(V[s][j]);
        tau[s] = 2.0 / size;
        for (int i = s + 1; i < k; i++) {
            double complex f = 0.0;
            for (int j = s; j < n; j++)
                f += conj(V[s][j]) * A[i][j];
            f *= tau[s];
            for (int j = s; j < n; j++)
                A[i][j] -= f * V[s][j];
        }
    }
    for (int i = rank; i < n; i++) {
        double complex *q = Q[i - rank];
        for (int j = 0; j < 6; j++)
            q[j] = j == i;
        for (int s = rank - 1; s >= 0; s--) {
            double complex f = 0.0;
            for (int j = s; j < n; j++)
                f += conj(V[s][j]) * q[j];
            f *= tau[s];
            for (int j = s; j < n; j++)
                q[j] -= f * V[s][j];
        }
    }
}

/* F: the functions of what joints 1 and 2 do, on the products of their half-angle tangents' powers. */
static void ahead_of(const Elimination *E, const Motion *M, Functions F) {
    static const double half[3][3] = {{1.0, 0.0, 1.0}, {1.0, 0.0, -1.0}, {0.0, 2.0, 0.0}};
    Functions V, W;
    Motion turned_first;
    functions_of_identity(V);
    act(&M[2], V, W);
    times_joint(W, 1, 1.0, V);
    act(&M[1], V, W);
    times_joint(W, 3, 1.0, V);
    composed(&E->zero, &M[0], &turned_first);
    act(&turned_first, V, W);
    memset(V, 0, sizeof V);
    /* 1, cos, sin of joint 1 times those of joint 2, each (1 + y^2) or (1 + w^2) times as great. */
    for (int i = 0; i < 15; i++)
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                for (int c = 0; c < 3; c++)
                    for (int d = 0; d < 3; d++)
                        V[i][3 * c + d] += W[i][3 * a + b] * (half[a][c] * half[b][d]);
    memcpy(F, V, sizeof V);
}

/* V: M4^-1 J4^-1 M3^-1 on the functions of joint 4. */
static void behind_of(const Motion *M, Functions V) {
    Functions W;
    Motion back;
    functions_of_identity(W);
    inverse_of(&M[3], &back);
    act(&back, W, V);
    times_joint(V, 1, -1.0, W);
    inverse_of(&M[4], &back);
    act(&back, W, V);
}

/* Six combinations N of the functions that are free of joints 4 and 5. */
static void free_of_last(Functions V, double N[6][16]) {
    Functions G;
    double A[8][16], Q[6][16];
    times_joint(V, 3, -1.0, G);
    memset(A, 0, sizeof A);
    for (int c = 0; c < 8; c++)
        for (int i = 0; i < 14; i++)
            A[c][i] = G[i + 1][c + 1];
    spanning(14, 8, 8, A, 8, Q);
    for (int i = 0; i < 6; i++) {
        double constant = 0.0;
        for (int j = 0; j < 14; j++)
            constant += Q[i][j] * G[j + 1][0];
        N[i][0] = -constant;
        for (int j = 0; j < 14; j++)
            N[i][j + 1] = Q[i][j];
        N[i][15] = 0.0;
    }
}

static void action_of(const Motion *M, double A[15][16]) {
    Functions one;
    memset(one, 0, sizeof one);
    for (int i = 0; i < 15; i++)
        one[i][i] = 1.0;
    act(M, one, A);
}

/* Rows (k, 9) on the products, and y times them: (2 k, 12), in rows of sixteen. */
static void twice(int k, double (*rows)[16], double (*out)[16]) {
    for (int i = 0; i < k; i++) {
        memset(out[i], 0, sizeof out[i]);
        memset(out[k + i], 0, sizeof out[i]);
        memcpy(out[i], rows[i], 9 * sizeof(double));
        memcpy(out[k + i] + 3, rows[i], 9 * sizeof(double));
    }
}

/* Solves A X = B for A (n, n) and B (n, k), both in rows; whether A is regular. The result stands in B. */
static int linear(int n, int k, double (*A)[16], double (*B)[ORDER]) {
    for (int s = 0; s < n; s++) {
        int best = s;
        for (int i = s + 1; i < n; i++)
            if (fabs(A[i][s]) > fabs(A[best][s]))
                best = i;
        if (!(fabs(A[best][s]) > 0.0))
            return 0;
        if (best != s)
            for (int j = 0; j < ORDER; j++) {
                double other = B[s][j];
                B[s][j] = B[best][j];
                B[best][j] = other;
                if (j < 16) {
                    other = A[s][j];
                    A[s][j] = A[best][j];
                    A[best][j] = other;
                }
            }
        double inverse = 1.0 / A[s][s];
        for (int i = s + 1; i < n; i++) {
            double f = A[i][s] * inverse;
            if (f == 0.0)
                continue;
            for (int j = s & ~3; j < 12; j++)
                A[i][j] -= f * A[s][j];
            for (int j = 0; j < k; j++)
                B[i][j] -= f * B[s][j];
        }
    }
    for (int s = n - 1; s >= 0; s--) {
        double inverse = 1.0 / A[s][s];
        for (int j = 0; j < k; j++)
            B[s][j] *= inverse;
        for (int i = 0; i < s; i++) {
            double f = A[i][s];
            for (int j = 0; j < k; j++)
                B[i][j] -= f * B[s][j];
        }
    }
    return 1;
}

/* The matrix whose eigenvalues are the roots, for a target's L6; whether there is one. */
int NAMED(equations)(const Elimination *E, const Motion *closing, Equations *eq, Eigen *matrix) {
    Functions F_own, A_own;
    double N_own[6][16], NA[6][16], E1[6][16], Ec[6][16], Es[6][16];
    const double(*F)[16] = E->ahead, (*N)[16] = E->without_last, (*A)[16] = E->action;
    memcpy(eq->M, E->links, sizeof eq->M);
    eq->M[E->target] = *closing;
    if (E->backwards)
        inverse_of(closing, &eq->M[E->target]);
    if (E->target <= 2) {
        ahead_of(E, eq->M, F_own);
        F = (const double(*)[16])F_own;
    }
    if (E->target == 3 || E->target == 4) {
        behind_of(eq->M, eq->V);
        free_of_last(eq->V, N_own);
        N = (const double(*)[16])N_own;
    } else {
        memcpy(eq->V, E->behind, sizeof eq->V);
    }
    if (E->target == 5) {
        action_of(&eq->M[5], A_own);
        A = (const double(*)[16])A_own;
    }
    product(6, 15, 4, N[0], 16, A[0], 16, NA[0], 16);
    /* On 1, cos and sin of joint 0. */
    for (int i = 0; i < 6; i++) {
        double one[12] = {0.0}, cosine[12] = {0.0}, sine[12] = {0.0};
        for (int f = 0; f < 15; f++) {
            double n = NA[i][f];
            int part = f >= 1 && f < 13 ? (f - 1) % 3 : 2;
            if (part == 2) {
                for (int j = 0; j < 12; j++)
                    one[j] += n * F[f][j];
                continue;
            }
            double other = part ? -NA[i][f - 1] : NA[i][f + 1];
            for (int j = 0; j < 12; j++) {
                cosine[j] += n * F[f][j];
                sine[j] += other * F[f][j];
            }
        }
        for (int j = 0; j < 12; j++) {
            E1[i][j] = one[j];
            Ec[i][j] = cosine[j];
            Es[i][j] = sine[j];
        }
        for (int j = 12; j < 16; j++)
            E1[i][j] = Ec[i][j] = Es[i][j] = 0.0;
    }
    int rest = 6 - E->free, columns = 12 - 2 * E->free, paired = E->paired;
    double complex turning[4][6];
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 6; i++)
            turning[k][i] = NA[i][1 + 3 * k] + I * NA[i][2 + 3 * k];
    if (E->free) {
        double real[8][16], Q[6][16], B[12][16], P[6][16], some[6][16];
        memset(real, 0, sizeof real);
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 6; i++) {
                real[k][i] = creal(turning[k][i]);
                real[4 + k][i] = cimag(turning[k][i]);
            }
        spanning(6, 8, rest, real, 0, Q);
        product(E->free, 6, 3, Q[rest], 16, E1[0], 16, some[0], 16);
        twice(E->free, some, B);
        spanning(12, 2 * E->free, 2 * E->free, B, 2 * E->free, eq->basis);
        double(*parts[3])[16] = {E1, Ec, Es};
        for (int k = 0; k < 3; k++) {
            product(rest, 6, 3, Q[0], 16, parts[k][0], 16, P[0], 16);
            memcpy(parts[k], P, sizeof P);
        }
        double complex moved[4][6];
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < rest; i++) {
                moved[k][i] = 0.0;
                for (int j = 0; j < 6; j++)
                    moved[k][i] += Q[i][j] * turning[k][j];
            }
        memcpy(turning, moved, sizeof turning);
    }
    double at_zero[6][16], change[6][16], linear_0[12][16], linear_1[12][16], R[6][16];
    for (int i = 0; i < rest; i++)
        for (int j = 0; j < 16; j++) {
            at_zero[i][j] = E1[i][j] + Ec[i][j];
            change[i][j] = Ec[i][j] - E1[i][j];
        }
    int quadratic = rest - 2 * paired;
    if (paired) {
        double complex u[6][6];
        double U[12][16], W[12][16], Uc[12][16], L[12][16];
        complex_rest(rest, 4, rest - paired, turning, u);
        memset(U, 0, sizeof U);
        memset(W, 0, sizeof W);
        for (int i = 0; i < paired; i++)
            for (int j = 0; j < rest; j++) {
                /* The conjugates: u with u a = 0. */
                U[i][j] = creal(u[i][j]);
                U[paired + i][j] = W[i][j] = -cimag(u[i][j]);
                W[i][j] = -W[i][j];
                W[paired + i][j] = creal(u[i][j]);
            }
        memcpy(Uc, U, sizeof U);
        product(2 * paired, rest, 3, U[0], 16, at_zero[0], 16, L[0], 16);
        twice(2 * paired, L, linear_0);
        product(2 * paired, rest, 3, W[0], 16, change[0], 16, L[0], 16);
        twice(2 * paired, L, linear_1);
        spanning(rest, 2 * paired, 2 * paired, Uc, 2 * paired, R);
    } else {
        memset(R, 0, sizeof R);
        for (int i = 0; i < rest; i++)
            R[i][i] = 1.0;
    }
    double lead[12][16], some[6][16], M0[12][16], M1[12][16], M2[12][16], right[12][ORDER];
    product(quadratic, rest, 3, R[0], 16, change[0], 16, some[0], 16);
    for (int i = 0; i < quadratic; i++)
        for (int j = 0; j < 12; j++)
            some[i][j] = -some[i][j];
    twice(quadratic, some, M2);
    product(quadratic, rest, 3, R[0], 16, Es[0], 16, some[0], 16);
    for (int i = 0; i < quadratic; i++)
        for (int j = 0; j < 12; j++)
            some[i][j] = 2.0 * some[i][j];
    twice(quadratic, some, M1);
    product(quadratic, rest, 3, R[0], 16, at_zero[0], 16, some[0], 16);
    twice(quadratic, some, M0);
    int rows = 4 * paired;
    quadratic *= 2;
    if (E->free) {
        /* The vectors are given in the basis. */
        double across[12][16], out[12][16];
        memset(across, 0, sizeof across);
        for (int i = 0; i < columns; i++)
            for (int j = 0; j < 12; j++)
                across[j][i] = eq->basis[i][j];
        double(*parts[5])[16] = {linear_0, linear_1, M0, M1, M2};
        for (int k = 0; k < 5; k++) {
            int count = k < 2 ? rows : quadratic;
            product(count, 12, 3, parts[k][0], 16, across[0], 16, out[0], 16);
            memcpy(parts[k], out, (size_t)count * sizeof out[0]);
        }
    }
    memset(right, 0, sizeof right);
    for (int i = 0; i < rows; i++) {
        memcpy(lead[i], linear_1[i], sizeof lead[i]);
        for (int j = 0; j < columns; j++)
            right[i][j] = -linear_0[i][j];
    }
    for (int i = 0; i < quadratic; i++) {
        memcpy(lead[rows + i], M2[i], sizeof lead[i]);
        right[rows + i][columns + i] = 1.0;
    }
    int n = columns + quadratic;
    if (!linear(columns, n, lead, right))
        return 0;
    matrix->n = n;
    for (int i = 0; i < columns; i++)
        memcpy(matrix->H[i], right[i], sizeof right[i]);
    if (n <= 16)
        product(quadratic, columns, 4, M1[0], 16, right[0], ORDER, matrix->H[columns], ORDER);
    else
        product(quadratic, columns, ORDER / 4, M1[0], 16, right[0], ORDER, matrix->H[columns], ORDER);
    for (int i = columns; i < n; i++)
        for (int j = 0; j < n; j++)
            matrix->H[i][j] = -matrix->H[i][j] - (j < columns ? M0[i - columns][j] : 0.0);
    eq->free = E->free;
    eq->columns = columns;
    return 1;
}

/* What does not depend on the target. */
void NAMED(prepared_elimination)(Elimination *E) {
    if (E->target > 2)
        ahead_of(E, E->links, E->ahead);
    if (E->target != 3 && E->target != 4) {
        behind_of(E->links, E->behind);
        free_of_last(E->behind, E->without_last);
    }
    if (E->target != 5)
        action_of(&E->links[5], E->action);
}
