/* Eigenvalues and eigenvectors of small real matrices that are not symmetric, one matrix at a time.

   The matrix is balanced by powers of two, brought to Hessenberg form by reflections, and its eigenvalues are found by
   QR steps with two shifts at once (J. G. F. Francis, "The QR transformation", Computer Journal 4, 1961/62). A vector is
   found by inverse iteration on the Hessenberg form: one solution with a right side that has no meaning, since a matrix
   that is singular but for rounding answers with its null vector (G. Golub, C. van Loan, "Matrix Computations", 4th ed.,
   2013, sections 7.5 and 7.6). Orders are multiples of four, as those of the eliminations' pencils are.
*/

#ifndef ROBOKIN_EIGEN_H
#define ROBOKIN_EIGEN_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* The greatest order. */
#define ORDER 24

/* QR steps for one pair of eigenvalues. */
#define QR_STEPS 60

typedef struct {
    int n;
    double H[ORDER][ORDER];  /* the Hessenberg form */
    double V[ORDER][ORDER];  /* the reflections' vectors, one a row */
    double tau[ORDER];       /* and their factors, 2 / |v|^2 */
    double scale[ORDER];     /* of balancing */
    double norm;
    double re[ORDER], im[ORDER];
} Eigen;

static inline Part even(double x) { return x * ONE; }

static inline Part magnitude(Part x) {
    const Bits rest = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
    return (Part)((Bits)x & rest);
}

/* Sum of products of two rows, in four parts: n is a multiple of four. */
static inline double dot_of(const double *a, const double *b, int from, int n) {
    Part sum = (Part){0.0};
    for (int j = from & ~3; j < n; j += 4)
        sum += *(const Part *)(a + j) * *(const Part *)(b + j);
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* a -= f b */
static inline void less_row(double *a, double f, const double *b, int n) {
    for (int j = 0; j < n; j += 4)
        *(Part *)(a + j) -= f * *(const Part *)(b + j);
}

/* Rows and columns scaled by powers of two until the norms of each pair are alike. */
static void balance(Eigen *E) {
    int n = E->n;
    for (int i = 0; i < n; i++)
        E->scale[i] = 1.0;
    for (int round = 0; round < 8; round++) {
        int done = 1;
        double columns[ORDER] = {0.0};
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                columns[j] += fabs(E->H[i][j]);
        for (int i = 0; i < n; i++) {
            double row = -fabs(E->H[i][i]), column = columns[i] + row, f = 1.0;
            for (int j = 0; j < n; j++)
                row += fabs(E->H[i][j]);
            if (!(column > 0.0) || !(row > 0.0))
                continue;
            double c = column, r = row;
            while (c < 0.5 * r && f < 1e150) {
                f *= 2.0;
                c *= 2.0;
                r *= 0.5;
            }
            while (c >= 2.0 * r && f > 1e-150) {
                f *= 0.5;
                c *= 0.5;
                r *= 2.0;
            }
            if (f == 1.0 || c + r >= 0.95 * (column + row))
                continue;
            done = 0;
            E->scale[i] *= f;
            for (int j = 0; j < n; j++) {
                /* What the other columns' sums gain by it. */
                double before = fabs(E->H[i][j]);
                E->H[i][j] /= f;
                columns[j] += fabs(E->H[i][j]) - before;
            }
            for (int j = 0; j < n; j++)
                E->H[j][i] *= f;
        }
        if (done)
            break;
    }
}

/* To Hessenberg form by reflections, which are kept. */
static void to_hessenberg(Eigen *E) {
    int n = E->n;
    double w[ORDER];
    for (int k = 0; k < n - 2; k++) {
        double *v = E->V[k];
        double sum = 0.0, first = E->H[k + 1][k];
        memset(v, 0, sizeof(E->V[k]));
        for (int i = k + 2; i < n; i++) {
            v[i] = E->H[i][k];
            sum += v[i] * v[i];
        }
        E->tau[k] = 0.0;
        if (!(sum > 0.0))
            continue;
        double length = sqrt(sum + first * first);
        double end = first > 0.0 ? -length : length;
        v[k + 1] = first - end;
        double tau = 2.0 / (sum + v[k + 1] * v[k + 1]);
        E->tau[k] = tau;
        memset(w, 0, sizeof w);
        for (int i = k + 1; i < n; i++)
            for (int j = k & ~3; j < n; j++)
                w[j] += v[i] * E->H[i][j];
        for (int i = k + 1; i < n; i++) {
            double f = tau * v[i];
            for (int j = k & ~3; j < n; j++)
                E->H[i][j] -= f * w[j];
        }
        E->H[k + 1][k] = end;
        for (int i = k + 2; i < n; i++)
            E->H[i][k] = 0.0;
        for (int i = 0; i < n; i++) {
            double f = tau * dot_of(E->H[i], v, k + 1, n);
            for (int j = (k + 1) & ~3; j < n; j++)
                E->H[i][j] -= f * v[j];
        }
    }
}

/* The eigenvalues of the block of rows and columns i, i + 1. */
static void of_two(const double H[][ORDER], int i, double *re, double *im) {
    double a = H[i][i], b = H[i][i + 1], c = H[i + 1][i], d = H[i + 1][i + 1];
    double p = 0.5 * (a - d), q = p * p + b * c;
    if (q >= 0.0) {
        double z = p + (p >= 0.0 ? sqrt(q) : -sqrt(q));
        re[i] = d + z;
        re[i + 1] = z != 0.0 ? d - b * c / z : re[i];
        im[i] = im[i + 1] = 0.0;
    } else {
        re[i] = re[i + 1] = d + p;
        im[i] = sqrt(-q);
        im[i + 1] = -im[i];
    }
}

/* One QR step with two shifts, whose sum and product are given, on rows and columns l to h. */
static void francis_step(double H[][ORDER], int l, int h, double sum, double product) {
    double x, y, z;
    int m;
    /* It may begin where two subdiagonal entries in a row are small. */
    for (m = h - 2;; m--) {
        double a = H[m][m], r = H[m + 1][m];
        x = (a * (a - sum) + product) + H[m][m + 1] * r;
        y = r * (a + H[m + 1][m + 1] - sum);
        z = r * H[m + 2][m + 1];
        double size = fabs(x) + fabs(y) + fabs(z);
        if (size > 0.0) {
            x /= size;
            y /= size;
            z /= size;
        }
        if (m == l)
            break;
        if (fabs(H[m][m - 1]) * (fabs(y) + fabs(z)) <=
            DBL_EPSILON * fabs(x) * (fabs(H[m - 1][m - 1]) + fabs(a) + fabs(H[m + 1][m + 1])))
            break;
    }
    for (int k = m; k < h; k++) {
        int three = k < h - 1;
        if (k > m) {
            x = H[k][k - 1];
            y = H[k + 1][k - 1];
            z = three ? H[k + 2][k - 1] : 0.0;
        }
        double length = sqrt(x * x + y * y + z * z), end = k > m ? -length : k > l ? -H[k][k - 1] : 0.0;
        if (x < 0.0) {
            length = -length;
            end = k > m ? -length : end;
        }
        double u = x + length, f = u * length;
        f = fabs(f) > DBL_MIN ? 1.0 / f : 0.0;
        /* I - f v v^T with v = (u, y, z), on all of the rows: what is beyond h is not needed any more. */
        double fu = u * f, fy = y * f, fz = z * f;
        for (int j = k & ~3; j <= h; j += 4) {
            Part *a = (Part *)(H[k] + j), *b = (Part *)(H[k + 1] + j), *c = (Part *)(H[k + (three ? 2 : 1)] + j);
            Part p = u * *a + y * *b;
            if (three) {
                p += z * *c;
                *c -= fz * p;
            }
            *a -= fu * p;
            *b -= fy * p;
        }
        if (k > l) {
            H[k][k - 1] = f != 0.0 ? end : x;
            H[k + 1][k - 1] = 0.0;
            if (three)
                H[k + 2][k - 1] = 0.0;
        }
        /* And on the columns, from below: the next step begins with the last rows, and need not wait for the others. */
        int last = h < k + 3 ? h : k + 3;
        if (three)
            for (int i = last; i >= l; i--) {
                double p = fu * H[i][k] + fy * H[i][k + 1] + fz * H[i][k + 2];
                H[i][k] -= u * p;
                H[i][k + 1] -= y * p;
                H[i][k + 2] -= z * p;
            }
        else
            for (int i = h; i >= l; i--) {
                double p = fu * H[i][k] + fy * H[i][k + 1];
                H[i][k] -= u * p;
                H[i][k + 1] -= y * p;
            }
    }
}

/* The eigenvalues of the Hessenberg form; whether all were found. */
static int eigenvalues(Eigen *E) {
    double H[ORDER][ORDER];
    int n = E->n, h = n - 1, steps = 0;
    memcpy(H, E->H, sizeof H);
    E->norm = 0.0;
    for (int i = 0; i < n; i++)
        for (int j = i ? i - 1 : 0; j < n; j++)
            E->norm += fabs(H[i][j]);
    if (!(E->norm <= DBL_MAX))
        return 0;
    while (h >= 0) {
        int l;
        for (l = h; l > 0; l--) {
            double size = fabs(H[l - 1][l - 1]) + fabs(H[l][l]);
            if (fabs(H[l][l - 1]) <= DBL_EPSILON * (size > 0.0 ? size : E->norm))
                break;
        }
        if (l >= h - 1) {
            if (l == h) {
                E->re[h] = H[h][h];
                E->im[h] = 0.0;
            } else {
                of_two((const double(*)[ORDER])H, l, E->re, E->im);
            }
            h = l - 1;
            steps = 0;
            continue;
        }
        if (l > 0)
            H[l][l - 1] = 0.0;
        if (steps++ >= QR_STEPS)
            return 0;
        double a = H[h - 1][h - 1], b = H[h][h];
        double sum = a + b, product = a * b - H[h][h - 1] * H[h - 1][h];
        if (steps % 10 == 0) {
            /* Shifts of no meaning, where the usual ones go round in circles. */
            double s = fabs(H[h][h - 1]) + fabs(H[h - 1][h - 2]);
            sum = 1.5 * s + 2.0 * b;
            product = (b + s) * (b + 0.5 * s);
        }
        francis_step(H, l, h, sum, product);
    }
    return 1;
}

/* Vectors x (n) of four real eigenvalues. */
static void real_vectors(const Eigen *E, Part value, Part *x) {
    int n = E->n;
    Part U[ORDER][ORDER], here[ORDER], largest = (Part){0.0}, least = even(DBL_EPSILON * E->norm);
    for (int j = 0; j < n; j++)
        here[j] = even(E->H[0][j]);
    here[0] -= value;
    for (int i = 0; i < n - 1; i++) {
        Part below = even(E->H[i + 1][i]), pivot = here[i];
        Bits swap = magnitude(below) > magnitude(pivot);
        pivot = chosen(~swap & (magnitude(pivot) < least), least, pivot);
        Part f = chosen(swap, pivot, below) / chosen(swap, below, pivot);
        U[i][i] = chosen(swap, below, pivot);
        for (int j = i + 1; j < n; j++) {
            Part a = here[j], b = even(E->H[i + 1][j]);
            if (j == i + 1)
                b -= value;
            U[i][j] = chosen(swap, b, a);
            here[j] = chosen(swap, a, b) - f * U[i][j];
        }
    }
    U[n - 1][n - 1] = chosen(magnitude(here[n - 1]) < least, least, here[n - 1]);
    for (int i = 0; i < n; i++)
        x[i] = i & 1 ? -least : least;
    for (int i = n - 1; i >= 0; i--) {
        x[i] /= U[i][i];
        largest = chosen(magnitude(x[i]) > largest, magnitude(x[i]), largest);
        for (int j = 0; j < i; j++)
            x[j] -= U[j][i] * x[i];
    }
    largest = ONE / largest;
    for (int j = 0; j < n; j++)
        x[j] *= largest;
}

/* Vectors x + i y (n) of four complex ones. */
static void complex_vectors(const Eigen *E, Part re, Part im, Part *x, Part *y) {
    int n = E->n;
    Part U[ORDER][ORDER], W[ORDER][ORDER], a[ORDER], b[ORDER], largest = (Part){0.0};
    Part least = even(DBL_EPSILON * E->norm), none = (Part){0.0};
    for (int j = 0; j < n; j++) {
        a[j] = even(E->H[0][j]);
        b[j] = none;
    }
    a[0] -= re;
    b[0] = -im;
    for (int i = 0; i < n - 1; i++) {
        Part below = even(E->H[i + 1][i]), p = a[i], q = b[i], size = magnitude(p) + magnitude(q);
        Bits swap = magnitude(below) > size;
        p = chosen(~swap & (size < least), least, p);
        size = chosen(swap, below * below, p * p + q * q);
        Part f = p * below / size, g = chosen(swap, q, -q) * below / size;
        U[i][i] = chosen(swap, below, p);
        W[i][i] = chosen(swap, none, q);
        for (int j = i + 1; j < n; j++) {
            Part r = even(E->H[i + 1][j]), s = none;
            if (j == i + 1) {
                r -= re;
                s = -im;
            }
            Part u = chosen(swap, r, a[j]), v = chosen(swap, s, b[j]);
            U[i][j] = u;
            W[i][j] = v;
            a[j] = chosen(swap, a[j], r) - (f * u - g * v);
            b[j] = chosen(swap, b[j], s) - (f * v + g * u);
        }
    }
    U[n - 1][n - 1] = chosen(magnitude(a[n - 1]) + magnitude(b[n - 1]) < least, least, a[n - 1]);
    W[n - 1][n - 1] = b[n - 1];
    for (int i = 0; i < n; i++) {
        x[i] = i & 1 ? -least : least;
        y[i] = none;
    }
    for (int i = n - 1; i >= 0; i--) {
        Part u = U[i][i], w = W[i][i], size = ONE / (u * u + w * w), p = x[i], q = y[i];
        x[i] = (p * u + q * w) * size;
        y[i] = (q * u - p * w) * size;
        size = magnitude(x[i]) + magnitude(y[i]);
        largest = chosen(size > largest, size, largest);
        for (int j = 0; j < i; j++) {
            x[j] -= U[j][i] * x[i] - W[j][i] * y[i];
            y[j] -= U[j][i] * y[i] + W[j][i] * x[i];
        }
    }
    largest = ONE / largest;
    for (int j = 0; j < n; j++) {
        x[j] *= largest;
        y[j] *= largest;
    }
}

/* Vectors (n) of the Hessenberg form as those of the matrix. */
static void brought_back(const Eigen *E, Part *x) {
    int n = E->n;
    for (int k = n - 3; k >= 0; k--) {
        Part f = (Part){0.0}, g = (Part){0.0};
        for (int j = k + 1; j < n - 1; j += 2) {
            f += E->V[k][j] * x[j];
            g += E->V[k][j + 1] * x[j + 1];
        }
        if ((n - k - 1) & 1)
            f += E->V[k][n - 1] * x[n - 1];
        f = (f + g) * E->tau[k];
        for (int j = k + 1; j < n; j++)
            x[j] -= E->V[k][j] * f;
    }
    for (int i = 0; i < n; i++)
        x[i] *= E->scale[i];
}

#endif
