/* Complex joint values of a loop J1 L1 ... J6 L6 = 1, four of them at once.

   Python's `loop` and `complex_newton` are the reference, and say what is derived how. Comes after lanes.h.
*/

/* Four complex numbers. */
typedef struct {
    Part re, im;
} Complex;

static inline Complex plus(Complex a, Complex b) { return (Complex){a.re + b.re, a.im + b.im}; }

static inline Complex minus(Complex a, Complex b) { return (Complex){a.re - b.re, a.im - b.im}; }

static inline Complex multiplied(Complex a, Complex b) {
    return (Complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static inline Complex scaled(Complex a, Part f) { return (Complex){a.re * f, a.im * f}; }

static inline Part absolute_squared(Complex a) { return a.re * a.re + a.im * a.im; }

static inline Complex inverse(Complex a) {
    Part squared = absolute_squared(a);
    return (Complex){a.re / squared, -a.im / squared};
}

static inline Complex one_of(Bits which, Complex a, Complex b) {
    return (Complex){chosen(which, a.re, b.re), chosen(which, a.im, b.im)};
}

/* Numbers in exchange for others, where `which` says so. */
static inline void exchanged(Bits which, Part *a, Part *b) {
    Bits differ = ((Bits)*a ^ (Bits)*b) & which;
    *a = (Part)((Bits)*a ^ differ);
    *b = (Part)((Bits)*b ^ differ);
}

static inline Part greater(Part a, Part b) { return chosen(a > b, a, b); }

static inline Part roots(Part x) {
    for (int l = 0; l < 4; l++)
        x[l] = sqrt(x[l]);
    return x;
}

/* Cosines and sines of complex angles. */
static void complex_turns(Complex q, Complex *c, Complex *s) {
    Part sine, cosine, e;
    int far = 0;
    for (int l = 0; l < 4; l++) {
        e[l] = exp(q.im[l]);
        far |= !(fabs(q.re[l]) <= FARTHEST);
    }
    sine_cosine(q.re, &sine, &cosine);
    for (int l = 0; far && l < 4; l++)
        if (!(fabs(q.re[l]) <= FARTHEST)) {
            sine[l] = sin(q.re[l]);
            cosine[l] = cos(q.re[l]);
        }
    Part other = 1.0 / e, hyperbolic_cosine = 0.5 * (e + other), hyperbolic_sine = 0.5 * (e - other);
    *c = (Complex){cosine * hyperbolic_cosine, -sine * hyperbolic_sine};
    *s = (Complex){sine * hyperbolic_cosine, cosine * hyperbolic_sine};
}

/* X C, leaving out what zeros of C spare; columns x, y, z, p. */
static void complex_go_on(Complex X[4][3], const Constant *C) {
    Complex Y[3][3];
    if (C->shifts)
        for (int j = 0; j < 3; j++)
            if (C->m[9 + j] != 0.0)
                for (int r = 0; r < 3; r++)
                    X[3][r] = plus(X[3][r], scaled(X[j][r], C->m[9 + j] * ONE));
    if (!C->turns)
        return;
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) {
            Complex sum = {{0.0}, {0.0}};
            int begun = 0;
            for (int j = 0; j < 3; j++) {
                Part m = C->m[3 * c + j] * ONE;
                if (C->m[3 * c + j] == 0.0)
                    continue;
                sum = begun ? plus(sum, scaled(X[j][r], m)) : scaled(X[j][r], m);
                begun = 1;
            }
            Y[c][r] = sum;
        }
    memcpy(X, Y, sizeof Y);
}

/* X L for an L of each value. */
static void complex_closed(Complex X[4][3], const Complex L[4][3]) {
    Complex Y[3][3];
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++) {
            Complex sum = plus(multiplied(X[0][r], L[c][0]), plus(multiplied(X[1][r], L[c][1]), multiplied(X[2][r], L[c][2])));
            if (c < 3)
                Y[c][r] = sum;
            else
                X[3][r] = plus(X[3][r], sum);
        }
    memcpy(X, Y, sizeof Y);
}

/* The twists (joint, entry) at values q, X before L6, and the greatest |z|^2 of the axes. */
static void complex_followed(const Chain *loop, const Complex q[6], Complex S[6][6], Complex X[4][3], Part *size) {
    for (int j = 0; j < 4; j++)
        for (int r = 0; r < 3; r++)
            X[j][r] = (Complex){loop->first[3 * j + r] * ONE, {0.0}};
    *size = (Part){0.0};
    for (int i = 0; i < 6; i++) {
        const Complex *z = X[2], *o = X[3];
        Part sum = {0.0};
        for (int r = 0; r < 3; r++) {
            int a = (r + 1) % 3, b = (r + 2) % 3;
            S[i][r] = loop->revolute[i] ? minus(multiplied(o[a], z[b]), multiplied(o[b], z[a])) : z[r];
            S[i][3 + r] = loop->revolute[i] ? z[r] : (Complex){{0.0}, {0.0}};
            sum += absolute_squared(z[r]);
        }
        *size = greater(sum, *size);
        if (loop->revolute[i]) {
            Complex c, s;
            complex_turns(q[i], &c, &s);
            for (int r = 0; r < 3; r++) {
                Complex x = X[0][r], y = X[1][r];
                X[0][r] = plus(multiplied(c, x), multiplied(s, y));
                X[1][r] = minus(multiplied(c, y), multiplied(s, x));
            }
        } else {
            for (int r = 0; r < 3; r++)
                X[3][r] = plus(X[3][r], multiplied(q[i], X[2][r]));
        }
        complex_go_on(X, &loop->links[i]);
    }
}

/* What X lacks of the identity: v and w; 3 less its trace. */
static void complex_error(Complex X[4][3], Complex e[6], Complex *lack) {
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        e[r] = X[3][r];
        e[3 + r] = scaled(minus(X[a][b], X[b][a]), 0.5 * ONE);
    }
    Complex trace = plus(plus(X[0][0], X[1][1]), X[2][2]);
    *lack = (Complex){3.0 - trace.re, -trace.im};
}

/* The residual of an error, relative to the size of the terms of X. */
static Part complex_residual(const Complex e[6], Complex lack, Part size) {
    Part sum = {0.0};
    for (int r = 0; r < 6; r++)
        sum += absolute_squared(e[r]);
    return roots(sum + absolute_squared(lack)) / size;
}

/* dq with S dq = b, in the place of b, for some sides; S is overwritten. The determinant of S. */
static Complex complex_solved(Complex S[6][6], Complex b[][6], int sides) {
    Complex determinant = {ONE, {0.0}};
    for (int k = 0; k < 6; k++) {
        Part sign = ONE;
        for (int r = k + 1; r < 6; r++) {
            Bits swap = absolute_squared(S[k][r]) > absolute_squared(S[k][k]);
            if (!(swap[0] | swap[1] | swap[2] | swap[3]))
                continue;
            sign = chosen(swap, -sign, sign);
            for (int i = k; i < 6; i++) {
                exchanged(swap, &S[i][k].re, &S[i][r].re);
                exchanged(swap, &S[i][k].im, &S[i][r].im);
            }
            for (int j = 0; j < sides; j++) {
                exchanged(swap, &b[j][k].re, &b[j][r].re);
                exchanged(swap, &b[j][k].im, &b[j][r].im);
            }
        }
        Complex pivot = S[k][k], over = inverse(pivot);
        determinant = multiplied(scaled(determinant, sign), pivot);
        for (int r = k + 1; r < 6; r++) {
            Complex f = multiplied(S[k][r], over);
            for (int i = k + 1; i < 6; i++)
                S[i][r] = minus(S[i][r], multiplied(f, S[i][k]));
            for (int j = 0; j < sides; j++)
                b[j][r] = minus(b[j][r], multiplied(f, b[j][k]));
        }
        /* The inverses of the pivots stand in their place. */
        S[k][k] = over;
    }
    for (int j = 0; j < sides; j++)
        for (int k = 5; k >= 0; k--) {
            Complex sum = b[j][k];
            for (int i = k + 1; i < 6; i++)
                sum = minus(sum, multiplied(S[i][k], b[j][i]));
            b[j][k] = multiplied(sum, S[k][k]);
        }
    return determinant;
}

static inline int is_number(double x) { return x - x == 0.0; }

/* The columns of an L6 (4, 4) of complex numbers into one of the four. */
static void put_closing(const double *closing, int l, Complex L[4][3]) {
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 3; r++) {
            L[c][r].re[l] = closing[8 * r + 2 * c];
            L[c][r].im[l] = closing[8 * r + 2 * c + 1];
        }
}

/* Newton steps for complex values (m, 6) with an L6 (m, 4, 4) each, complex as well; the residuals (m,) they end with.

   A residual is -1 where S has no inverse to the last digit: there Python goes on. */
void NAMED(complex_refined)(const Chain *loop, const double *closing, double *values, ptrdiff_t m, int steps,
                            double longest, double *residual) {
    for (ptrdiff_t first = 0; first < m; first += 4) {
        int count = m - first < 4 ? (int)(m - first) : 4;
        Complex q[6], S[6][6], X[4][3], L[4][3], e[1][6], lack;
        Part size, squared, length, off = {0.0};
        int flat[4] = {0};
        for (int l = 0; l < 4; l++) {
            ptrdiff_t row = first + (l < count ? l : 0);
            for (int i = 0; i < 6; i++) {
                q[i].re[l] = values[12 * row + 2 * i];
                q[i].im[l] = values[12 * row + 2 * i + 1];
            }
            put_closing(closing + 32 * row, l, L);
        }
        for (int step = 0;; step++) {
            complex_followed(loop, q, S, X, &size);
            complex_closed(X, L);
            complex_error(X, e[0], &lack);
            off = complex_residual(e[0], lack, size);
            if (step == steps)
                break;
            squared = (Part){0.0};
            for (int i = 0; i < 6; i++)
                for (int r = 0; r < 6; r++)
                    squared += absolute_squared(S[i][r]);
            complex_solved(S, e, 1);
            length = (Part){0.0};
            for (int i = 0; i < 6; i++)
                length = greater(absolute_squared(e[0][i]), length);
            length = roots(length);
            for (int l = 0; l < 4; l++) {
                int sound = 1;
                for (int i = 0; i < 6; i++)
                    sound &= is_number(e[0][i].re[l]) && is_number(e[0][i].im[l]);
                flat[l] |= !sound && is_number(squared[l]) && is_number(off[l]);
                if (!sound || flat[l])
                    continue;
                double f = longest / (length[l] > longest ? length[l] : longest);
                for (int i = 0; i < 6; i++) {
                    q[i].re[l] -= e[0][i].re[l] * f;
                    q[i].im[l] -= e[0][i].im[l] * f;
                }
            }
        }
        for (int l = 0; l < count; l++) {
            for (int i = 0; i < 6; i++) {
                values[12 * (first + l) + 2 * i] = q[i].re[l];
                values[12 * (first + l) + 2 * i + 1] = q[i].im[l];
            }
            residual[first + l] = flat[l] ? -1.0 : is_number(off[l]) ? off[l] : HUGE_VAL;
        }
    }
}
