/* Numbers by LANES, in plain C that compilers turn into vector instructions.

   The files that begin with this one are compiled once for every machine and once for those with AVX2; LANES_NAME gives
   the functions of each their names. Products and sums are rounded one by one (-ffp-contract=off), so that both give
   the same digits.

   Sines and cosines: pi/2 is taken off in three parts (Cody and Waite), and on [-pi/4, pi/4] stand the polynomials of
   fdlibm's __kernel_sin and __kernel_cos (Sun Microsystems, 1993, freely distributable); to within 0.8 units in the
   last place for |x| <= 1e5. Beyond that, and for what is no number, the C library is asked.
*/

#ifndef ROBOKIN_VECTORS_H
#define ROBOKIN_VECTORS_H

#include <float.h>
#include <math.h>

#if FLT_EVAL_METHOD != 0 || defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__)
#error "needs doubles rounded one by one"
#endif

#if defined(_MSC_VER) && !defined(__clang__)
#pragma fp_contract(off)
#endif

/* Fours of numbers are handed over within this file alone: no other file's convention is broken. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define LANES 8
#define FARTHEST 1e5

#define CONCAT_(a, b) a##b
#define CONCAT(a, b) CONCAT_(a, b)
#define NAMED(name) CONCAT(name, LANES_NAME)

/* The nearest whole number to |x| < 2^51 is what is left when this is added and taken off again. */
static const double SHIFT = 6755399441055744.0;
static const double TWO_OVER_PI = 0.63661977236758138;
static const double PART_1 = 1.57079632673412561417e+00, PART_2 = 6.07710050630396597660e-11,
                    PART_3 = 2.02226624879595063154e-21;

/* Lanes by four: a loop over what may be the same memory is not turned into vector instructions by itself. */
typedef double Part __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long Bits __attribute__((vector_size(32), aligned(8), may_alias));

#define PARTS (LANES / 4)
#define FOR_PARTS for (int h = 0; h < PARTS; h++)
#define PART(lanes) (((Part *)(lanes))[h])
#define CONSTANT(lanes) (((const Part *)(lanes))[h])
#define BITS(lanes) (((Bits *)(lanes))[h])

static const Part ONE = {1.0, 1.0, 1.0, 1.0};

static inline Part chosen(Bits which, Part a, Part b) { return (Part)((which & (Bits)a) | (~which & (Bits)b)); }

static inline void sine_cosine(Part x, Part *sine, Part *cosine) {
    Part shift = SHIFT * ONE;
    Part k = (x * TWO_OVER_PI + shift) - shift;
    Part high = x - k * PART_1, low = k * PART_2;
    Part r = high - low;
    /* What that difference rounds away, and the third part. */
    Part tail = (high - r) - low - k * PART_3;
    Part z = r * r;
    Part ps = 8.33333333332248946124e-03 +
              z * (-1.98412698298579493134e-04 +
                   z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    Part v = z * r;
    Part s = r - ((z * (0.5 * tail - v * ps) - tail) - v * -1.66666666666666324348e-01);
    Part pc = z * (4.16666666666666019037e-02 +
                   z * (-1.38888888888741095749e-03 +
                        z * (2.48015872894767294178e-05 +
                             z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    Part half = 0.5 * z, w = 1.0 - half;
    Part c = w + (((1.0 - w) - half) + (z * pc - r * tail));
    /* k modulo 4 without integers: 4 (k/4 - floor(k/4)) by the same shift, to -2 … 2. */
    Part quarter = k - 4.0 * ((k * 0.25 + shift) - shift);
    Part odd = quarter * quarter; /* 0, 1, 4: odd quarters exchange sine and cosine */
    Bits swap = odd == ONE, half_turn = odd == 4.0 * ONE;
    *sine = chosen((quarter == -ONE) | half_turn, -ONE, ONE) * chosen(swap, c, s);
    *cosine = chosen((quarter == ONE) | half_turn, -ONE, ONE) * chosen(swap, s, c);
}

#endif
