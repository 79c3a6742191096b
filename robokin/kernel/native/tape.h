/* A closed form as a tape: straight operations on registers, as robokin.inverse.closed_form.form_tape writes them.

   A register stands for a number of each root that was chosen so far: one of level k has 2^k slots. The first registers
   are what the tape is asked about, for a closed form the three rows of the loop's last link; after them come the
   constants. The signs that name an arm's postures are a tape without roots, asked about the axes of the joints.
*/

#ifndef ROBOKIN_TAPE_H
#define ROBOKIN_TAPE_H

#include "chain.h"

#define MOST_SLOTS 512
#define MOST_STEPS 4096
#define MOST_LEVELS 3
#define MOST_ROOTS 8
#define ROWS 12

/* Directions of six axes, points on them, the tool's origin. */
#define AXES 39

/* A sign's quantity that is not below this decides for the first word, as robokin.inverse.posture_signs has it. */
#define UNDECIDED 1e-6

/* Joints of an arm with a closed form. */
#define SIX 6

#define TURN 6.28318530717958647692

/* As form_tape counts them. */
enum Operation {
    ADDED,     /* a + b */
    LESS,      /* a - b */
    TIMES,     /* a b */
    OVER,      /* a / b */
    MINUS,     /* -a */
    ROOT,      /* square root of a */
    MAGNITUDE, /* |a| */
    SIGNED,    /* |a| with the sign of b */
    CLAMPED,   /* a, or -1 or 1 where it is beyond */
    CHOSEN,    /* b where a > 0, else c */
    GREATER,   /* the greater of a and b */
    ANGLE,     /* atan2(a, b) */
    PAIRED,    /* a b + c d */
    CROSSED,   /* a b - c d */
    ENTERED,   /* a new level, `out` */
    BOTH,      /* a for the first root of the level of `out`, b for the second */
    REAL,      /* only roots for which a >= b */
    NEEDED,    /* no answer unless a >= b for each real root */
    LEVER,     /* the same for a square a below b, but that one above LEAST_LEVER leaves a doubt only */
    OPERATIONS
};

/* A root that is not real misses its condition by more where it is clearly complex: lengths are in sizes. */
#define CLEARLY_COMPLEX 1e-3

/* What stands for the number of solutions where it is clear that there is none. */
#define NONE_AT_ALL (-1)

/* Square of a lever below which the arrays take further steps (robokin's LOOSE). */
#define LEAST_LEVER 1e-12

typedef struct {
    int slot, level;
} Place;

typedef struct {
    int op;
    Place out, a, b, c, d;
} Step;

typedef struct {
    Chain chain;
    double first[12], last[12], unit; /* columns of C0 and C6, lengths in units of the loop [m] */
    double size;                      /* of the arm [m] */
    int inputs, levels, leaves, constants, steps;
    Place leaf[MOST_ROOTS][SIX];
    double low[SIX], high[SIX];
    int bounded[SIX], beyond[SIX];
    double wide_low[SIX], wide_high[SIX]; /* of joints that may stand a full turn on */
    int wide[SIX];
    double value[MOST_SLOTS];
    Step tape[];
} Form;

/* What solutions are judged by: names as in robokin.inverse.verify, window and members. */
typedef struct {
    int limits;         /* whether only those within the limits count */
    int inside_only;    /* and only they are put down */
    const double *wish; /* (6), or NULL */
} Wanted;

/* Rows of a target's solutions, in order. */
typedef struct {
    double *q; /* (listed, SIX) */
    double *position, *angle;
    unsigned char *inside;
    int listed;
} Solutions;

#define DECLARED_FORMS(name)                                                                                           \
    int solution##name(const Form *, const double *, const Wanted *, Solutions *);                                     \
    void solutions##name(const Form *, const double *, ptrdiff_t, const Wanted *, Solutions *, ptrdiff_t *,            \
                         ptrdiff_t *, unsigned char *);                                                              \
    void sides##name(const Form *, const double *, ptrdiff_t, ptrdiff_t *);

DECLARED_FORMS(_base)
DECLARED_FORMS(_avx2)

#endif
