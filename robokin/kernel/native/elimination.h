/* A loop of six turning joints and one split of it, as the native kernel keeps them, and what it finds for a target. */

#ifndef ROBOKIN_ELIMINATION_H
#define ROBOKIN_ELIMINATION_H

#include "chain.h"
#include "tape.h"

/* Roots of the greatest pencil, and as many candidates of one kind. */
#define MOST_CANDIDATES 24

typedef struct {
    double R[3][3], t[3];
} Motion;

/* Rows are padded to multiples of four. */
typedef double Functions[15][16];

typedef struct {
    Chain arm;               /* from base to tool, in metres */
    Chain loop;              /* J1 L1 ... L5 J6, in sizes */
    Motion first, last;      /* C0 and C6, in sizes */
    double size;
    int number;              /* of complex solutions */
    int joints[6];           /* of the loop, in the split's order */
    int backwards, target;   /* whether it is followed backwards; which M depends on the target */
    int free, paired;        /* the degrees of the rows */
    double shift, imaginary;
    Motion links[6];         /* M0 ... M5, that of the target left out */
    Motion zero;             /* the turn by the shift */
    Functions ahead, behind; /* what does not depend on the target: F and V */
    double without_last[6][16], action[15][16];
    int beside;              /* poses next door that are asked where solutions are missing */
    Motion away[8];
} Elimination;

/* The name of an elimination's capsule. */
#define ELIMINATION "robokin.elimination"

/* What is found for a target: all in radians, of the arm's own joints. */
typedef struct {
    int tried;               /* candidates that are real */
    int number;              /* distinct regular complex solutions that are known */
    int count;               /* real ones */
    int looked;              /* poses next door that were asked */
    double imaginary;        /* the greatest imaginary part of a joint's value, the least of all complex solutions */
    double q[MOST_CANDIDATES][6], position[MOST_CANDIDATES], angle[MOST_CANDIDATES];
} Eliminated;

#define DECLARED_ELIMINATION(name)                                                                                     \
    void prepared_elimination##name(Elimination *);                                                                    \
    void eliminated##name(const Elimination *, const double *, Eliminated *);                                          \
    void tried_candidates##name(const Elimination *, const double *, int *, double *, double *);                       \
    int listed_elimination##name(const Elimination *, const Form *, const double *, const Wanted *, Solutions *, int *);

DECLARED_ELIMINATION(_base)
DECLARED_ELIMINATION(_avx2)

#endif
