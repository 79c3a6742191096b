/* A chain C0 J1 C1 ... Jn Cn as the native kernel keeps it. */

#ifndef ROBOKIN_CHAIN_H
#define ROBOKIN_CHAIN_H

#include <stddef.h>

/* More joints than this are left to Python: their columns would not stay on the stack. */
#define MOST_JOINTS 32

/* Joints of a chain that steps are made of natively. */
#define MOST_MOVED 16

/* Sine of the angle error below which, with a negative cosine, the error is half a turn. */
#define HALF_TURN 1e-9

typedef struct {
    double m[12]; /* columns x, y, z, p */
    int turns, shifts;
} Constant;

typedef struct {
    int n;
    double first[12];
    int revolute[MOST_JOINTS];
    double offsets[MOST_JOINTS];
    Constant links[MOST_JOINTS]; /* after each joint */
} Chain;

#define DECLARED(name)                                                                                                 \
    void poses##name(const Chain *, const double *, ptrdiff_t, double *);                                              \
    void frames##name(const Chain *, const double *, ptrdiff_t, double *);                                             \
    void jacobians##name(const Chain *, const double *, ptrdiff_t, double, int, double *);                             \
    void errors##name(const Chain *, const double *, const double *, ptrdiff_t, double, double *, double *);            \
    void descended##name(const Chain *, const double *, const double *, double *, ptrdiff_t, double, const double *,    \
                         const double *, int, double *);                                                               \
    void corrected##name(const Chain *, const double *, const double *, int, const double *, double *, ptrdiff_t,      \
                         double, double, double, double *, double *);                                                  \
    void refined##name(const Chain *, const double *, double *, ptrdiff_t, int, double *);                             \
    void complex_refined##name(const Chain *, const double *, double *, ptrdiff_t, int, double, double *);              \
    void tracked##name(const Chain *, const double *, const double *, const double *, ptrdiff_t, double *, double *);

DECLARED(_base)
DECLARED(_avx2)

#endif
