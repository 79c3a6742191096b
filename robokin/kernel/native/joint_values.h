/* The values of all joints for a root of the elimination and its vector. Included for real numbers and complex ones.

   NUM: the type; VALUES: the function's name; TURN_OF(q, c, s): cosine and sine; RATIO(y, one): 2 atan(y / one);
   ANGLE(c, s, scale): the angle of a cosine and a sine times a scale; SIZE2: the squared absolute value;
   BETWEEN(g, f): the angle that turns pairs g (4, 2) to f (4, 2); UNIT: one; REAL_OF: the type of absolute values;
   PICK(which, a, b): a where `which` says so. As in Python's `raghavan_roth`.
*/

static void VALUES(const Elimination *E, const Equations *eq, NUM x, const NUM v[12], NUM values[6]) {
    NUM q[6], X[4][3], c, s, y[4], w[3];
    /* y and w: from the longest row or column, at its greater end. */
    REAL_OF longest = {0}, length;
    for (int j = 0; j < 3; j++) {
        length = SIZE2(v[j]) + SIZE2(v[3 + j]) + SIZE2(v[6 + j]) + SIZE2(v[9 + j]);
        for (int i = 0; i < 4; i++)
            y[i] = j ? PICK(length > longest, v[3 * i + j], y[i]) : v[3 * i];
        longest = j ? PICK(length > longest, length, longest) : length;
    }
    for (int i = 0; i < 4; i++) {
        length = SIZE2(v[3 * i]) + SIZE2(v[3 * i + 1]) + SIZE2(v[3 * i + 2]);
        for (int j = 0; j < 3; j++)
            w[j] = i ? PICK(length > longest, v[3 * i + j], w[j]) : v[j];
        longest = i ? PICK(length > longest, length, longest) : length;
    }
    q[0] = RATIO(x, UNIT) + E->shift;
    q[1] = RATIO(PICK(SIZE2(y[0]) >= SIZE2(y[3]), y[1], y[3]), PICK(SIZE2(y[0]) >= SIZE2(y[3]), y[0], y[2]));
    q[2] = RATIO(PICK(SIZE2(w[0]) >= SIZE2(w[2]), w[1], w[2]), PICK(SIZE2(w[0]) >= SIZE2(w[2]), w[0], w[1]));
    /* X = M5 J0 M0 J1 M1 J2 M2 */
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++)
            X[k][r] = eq->M[5].R[r][k] * UNIT;
        X[3][r] = eq->M[5].t[r] * UNIT;
    }
    for (int i = 0; i < 3; i++) {
        const Motion *M = &eq->M[i];
        TURN_OF(q[i], &c, &s);
        for (int r = 0; r < 3; r++) {
            NUM a = c * X[0][r] + s * X[1][r], b = c * X[1][r] - s * X[0][r], z = X[2][r];
            for (int k = 0; k < 3; k++)
                X[k][r] = M->R[0][k] * a + M->R[1][k] * b + M->R[2][k] * z;
            X[3][r] += M->t[0] * a + M->t[1] * b + M->t[2] * z;
        }
    }
    NUM f[15], pp = 0.0 * UNIT, lp = 0.0 * UNIT;
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        f[1 + r] = X[2][r];
        f[4 + r] = X[3][r];
        f[7 + r] = X[2][a] * X[3][b] - X[2][b] * X[3][a];
        pp += X[3][r] * X[3][r];
        lp += X[2][r] * X[3][r];
    }
    for (int r = 0; r < 3; r++)
        f[10 + r] = pp * X[2][r] - 2.0 * lp * X[3][r];
    f[0] = UNIT;
    f[13] = pp;
    f[14] = lp;
    /* Joint 5 leaves these alone: in them joint 4 is found, by least squares. */
    static const int left_alone[6] = {3, 6, 9, 12, 13, 14};
    double aa = 0.0, ab = 0.0, bb = 0.0;
    NUM ae = 0.0 * UNIT, be = 0.0 * UNIT;
    for (int k = 0; k < 6; k++) {
        const double *V = eq->V[left_alone[k]];
        NUM e = f[left_alone[k]] - V[0];
        aa += V[1] * V[1];
        ab += V[1] * V[2];
        bb += V[2] * V[2];
        ae += V[1] * e;
        be += V[2] * e;
    }
    q[4] = ANGLE(bb * ae - ab * be, aa * be - ab * ae, aa * bb - ab * ab);
    TURN_OF(q[4], &c, &s);
    NUM from[4][2], to[4][2];
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < 2; j++) {
            const double *V = eq->V[1 + 3 * k + j];
            from[k][j] = V[0] + V[1] * c + V[2] * s;
            to[k][j] = f[1 + 3 * k + j];
        }
    q[5] = -BETWEEN(from, to);
    /* Joint 3 from X and Y = J5^-1 M4^-1 J4^-1 M3^-1: their rotations' first columns. */
    NUM Y[2][3], c5, s5;
    TURN_OF(q[5], &c5, &s5);
    for (int k = 0; k < 2; k++) {
        const double *m = eq->M[3].R[k];
        NUM a = c * m[0] + s * m[1], b = c * m[1] - s * m[0], z = m[2] * UNIT;
        for (int r = 0; r < 3; r++)
            y[r] = eq->M[4].R[0][r] * a + eq->M[4].R[1][r] * b + eq->M[4].R[2][r] * z;
        Y[k][0] = c5 * y[0] + s5 * y[1];
        Y[k][1] = c5 * y[1] - s5 * y[0];
        Y[k][2] = y[2];
    }
    NUM cosine = 0.0 * UNIT, sine = 0.0 * UNIT;
    for (int r = 0; r < 3; r++) {
        cosine += X[0][r] * Y[0][r] + X[1][r] * Y[1][r];
        sine += X[1][r] * Y[0][r] - X[0][r] * Y[1][r];
    }
    q[3] = ANGLE(cosine, sine, 2.0);
    for (int i = 0; i < 6; i++)
        values[E->joints[i]] = E->backwards ? -q[i] : q[i];
}

#undef NUM
#undef VALUES
#undef TURN_OF
#undef RATIO
#undef ANGLE
#undef SIZE2
#undef BETWEEN
#undef REAL_OF
#undef PICK
#undef UNIT
