/* Doubles as decimal text: the nearest one to a text, and the shortest text that gives one back. */

#ifndef ROBOKIN_DECIMAL_H
#define ROBOKIN_DECIMAL_H

#include <stdint.h>

/* No number is longer: -1.2345678901234567e-308. */
#define MOST_CHARACTERS 24

/* What has to be writable from where a number begins. */
#define MOST_TOUCHED 48

/* Make the table of powers of ten; before the first call of the others, and by one thread. */
void decimal_begin(void);

/* The double nearest to w 10^k, of two that are equally near the even one; infinity where there is none. */
double decimal_nearest(uint64_t w, int64_t k);

/* Write a double's shortest text, of those the nearest, and return the end, at most MOST_CHARACTERS on;
   up to MOST_TOUCHED are written to. */
char *decimal_write(char *to, double x);

#endif
