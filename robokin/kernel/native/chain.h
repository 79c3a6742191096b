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

/* Numbers of a front beside its place, tangent and bend; the reasons why one ends. */
#define FRONT_NUMBERS 6
#define FRONT_BOUND 1.0
#define FRONT_LOST 2.0

/* The two ends of s curves: rows i and s + i. What is asked, what changes, and room for one step of all of them. */
typedef struct {
    int n;
    ptrdiff_t s;
    double size, plain_steps; /* of a correction; curves that are allowed more wait */
    const double *targets, *steps_of, *low, *high;
    double *state, *closed, *left, *waits;
    double *history; /* of each point the front, the place, the tangent and the second least singular value */
    ptrdiff_t used, room;
    ptrdiff_t *rows;
    double *T, *guess, *led, *normals, *gaps, *tangents, *most, *off, *seconds, *J;
} Fronts;

#define DECLARED(name)                                                                                                 \
    void poses##name(const Chain *, const double *, ptrdiff_t, double *);                                              \
    void frames##name(const Chain *, const double *, ptrdiff_t, double *);                                             \
    void jacobians##name(const Chain *, const double *, ptrdiff_t, double, int, double *);                             \
    void errors##name(const Chain *, const double *, const double *, ptrdiff_t, double, double *, double *);            \
    void descended##name(const Chain *, const double *, const double *, double *, ptrdiff_t, double, const double *,    \
                         const double *, int, double *);                                                               \
    void corrected##name(const Chain *, const double *, const double *, int, const double *, double *, ptrdiff_t,      \
                         double, double, double, double *, double *);                                                  \
    void gone_down##name(const Chain *, const double *, double *, ptrdiff_t, double, const double *, const double *,   \
                         int, const double *, int, double, double, double *);                                          \
    void turned##name(const Chain *, const double *, double *, ptrdiff_t, double, const double *, const double *, int, \
                      double *);                                                                                       \
    int advanced##name(const Chain *, Fronts *);                                                                       \
    void least_values##name(const double *, ptrdiff_t, int, double *);                                                 \
    void refined##name(const Chain *, const double *, double *, ptrdiff_t, int, double *);                             \
    void complex_refined##name(const Chain *, const double *, double *, ptrdiff_t, int, double, double *);              \
    void tracked##name(const Chain *, const double *, const double *, const double *, ptrdiff_t, double *, double *); \
    void regulars##name(const Chain *, const double *, const double *, ptrdiff_t, double *);                           \
    void shortest_of##name(const double *, const double *, ptrdiff_t, int, int, double, double *);                     \
    void finely_closed##name(const Chain *, const double *, double *, ptrdiff_t, double, int, double, double, double,  \
                             double *);                                                                                \
    ptrdiff_t followed_rows##name(const Chain *, const double *, ptrdiff_t, double, int, const double *,               \
                                  const double *, double *, int, int, double *);

DECLARED(_base)
DECLARED(_avx2)

#endif
