/* Rigid motions, and what the equations of the elimination leave for one target: equations.h is a file of its own. */

#ifndef ROBOKIN_MOTIONS_H
#define ROBOKIN_MOTIONS_H

#include "eigen.h"
#include "elimination.h"

static void inverse_of(const Motion *M, Motion *out) {
    Motion N;
    for (int i = 0; i < 3; i++) {
        N.t[i] = 0.0;
        for (int j = 0; j < 3; j++) {
            N.R[i][j] = M->R[j][i];
            N.t[i] -= M->R[j][i] * M->t[j];
        }
    }
    *out = N;
}

static void composed(const Motion *A, const Motion *B, Motion *out) {
    Motion N;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            N.R[i][j] = A->R[i][0] * B->R[0][j] + A->R[i][1] * B->R[1][j] + A->R[i][2] * B->R[2][j];
        N.t[i] = A->R[i][0] * B->t[0] + A->R[i][1] * B->t[1] + A->R[i][2] * B->t[2] + A->t[i];
    }
    *out = N;
}

typedef struct {
    Motion M[6];
    Functions V;           /* M4^-1 J4^-1 M3^-1 on the functions of joint 4 */
    int free, columns;     /* rows that are free of joint 0; of the vectors */
    double basis[12][16];  /* of the vectors, row by row (columns, 12), where there are free rows */
} Equations;

/* The matrix whose eigenvalues are the roots, for a target's L6; whether there is one. */
int NAMED(equations)(const Elimination *E, const Motion *closing, Equations *eq, Eigen *matrix);

#endif
