/* Arms with a spherical shoulder and a spherical wrist as the native kernel keeps them, and what it says of one pose. */

#ifndef ROBOKIN_SWIVEL_H
#define ROBOKIN_SWIVEL_H

#include "chain.h"

#define SEVEN 7

/* Equations of limits: two for each joint but the elbow. */
#define MOST_BOUNDS 12

/* Pieces of self-motions, and configurations put on them; poses with more are left to Python. */
#define MOST_PIECES 64
#define MOST_PLACED 160

/* Solutions listed of a pose at most. */
#define MOST_LISTED 33

/* Curves of a pose, by the signs of elbow, shoulder and wrist. */
#define CURVES 8

/* The numbers of `swivel_arm` and `SwivelBounds`, matrices row by row; of pairs the shoulder's number is first. */
typedef struct {
    Chain chain;
    double size;
    double base[9], origin[3], wrist[3], shoulder[3], hand[9];
    double seen[3], lower[3], forearm[9], forearm_origin[3], next[9], upper[3], elbow[3];
    double k[2], r[2], cos_phi[2], sin_phi[2];
    double u[2][3][2], v[2][3][2];
    int bounds, stopping;
    double matrix[MOST_BOUNDS][10], value[MOST_BOUNDS];
    double middle[SEVEN], half[SEVEN];
    int stops[SEVEN];
    /* Directions of the middles, and the cosines of what is clearly within, and clearly beyond. */
    double cos_middle[SEVEN], sin_middle[SEVEN], within[SEVEN], beyond[SEVEN];
    /* What counts as within the limits, and where idle joints rest. */
    double low[SEVEN], high[SEVEN], rest[SEVEN];
} SwivelArm;

typedef struct {
    double q4[2];
    int real[2], straight;
    /* By elbow, triple and entry (13, 23, 33, 31, 32) the factors of 1, cos psi and sin psi. */
    double entries[2][2][5][3];
} SwivelCurves;

typedef struct {
    int code, whole; /* 4 elbow + 2 shoulder + wrist */
    double first, last;
} SwivelPiece;

typedef struct {
    int pieces;
    SwivelPiece piece[MOST_PIECES];
    int closing, within, listed;
    double q[MOST_LISTED][SEVEN], position[MOST_LISTED], angle[MOST_LISTED];
    int code[MOST_LISTED];
} SwivelAnswer;

/* What follows from the other numbers of an arm. */
void prepared_swivel(SwivelArm *arm);

/* The self-motions within the limits and up to `most` solutions for a target T (4, 4); 0 where Python is to look at it. */
int swivel_answer(const SwivelArm *arm, void (*poses)(const Chain *, const double *, ptrdiff_t, double *),
                  const double *T, int most, SwivelCurves *curves, SwivelAnswer *out);

/* The joints, as bits, that move along the curve of a code. */
int swivel_moving(const SwivelArm *arm, const SwivelCurves *curves, int code);

#endif
