/* Sources: D. Lemire, Number parsing at a gigabyte per second, Software: Practice and Experience 51, 2021;
   R. Giulietti, The Schubfach way to render doubles, 2020. */

#include "decimal.h"

#include <string.h>

#if defined(_MSC_VER) && defined(_M_X64)
#include <intrin.h>
#endif

/* Powers of ten, 10^k / 2^r from 2^127 on, rounded up to whole numbers. */
enum { FIRST = -342, LAST = 324 };

typedef struct {
    uint64_t high, low;
} Wide;

static Wide powers[LAST - FIRST + 1];
static int begun;

/* Whole numbers of this many digits of 32 bits hold 10^324, and 2^1343 / 10^342 to 128 bits. */
enum { LIMBS = 42 };

/* The 128 bits that a number begins with; *rest tells whether others follow. */
static Wide leading(const uint32_t *limbs, int *rest) {
    int top = LIMBS - 1;
    while (!limbs[top])
        top--;
    int shift = 0;
    while (!(limbs[top] << shift >> 31))
        shift++;
    uint64_t words[5], out[4];
    for (int i = 0; i < 5; i++)
        words[i] = top - i >= 0 ? limbs[top - i] : 0;
    for (int i = 0; i < 4; i++)
        out[i] = ((words[i] << 32 | words[i + 1]) << shift >> 32) & 0xffffffff;
    *rest = shift && (words[4] << shift & 0xffffffff) != 0;
    *rest |= !shift && words[4];
    for (int i = 5; top - i >= 0; i++)
        *rest |= limbs[top - i] != 0;
    return (Wide){out[0] << 32 | out[1], out[2] << 32 | out[3]};
}

static Wide rounded_up(Wide floor) {
    floor.low++;
    floor.high += !floor.low;
    return floor;
}

void decimal_begin(void) {
    uint32_t limbs[LIMBS] = {1};
    int rest;
    if (begun)
        return;
    for (int k = 0; k <= LAST; k++) {
        Wide found = leading(limbs, &rest);
        powers[k - FIRST] = rest ? rounded_up(found) : found;
        uint64_t carry = 0;
        for (int i = 0; i < LIMBS; i++) {
            carry += (uint64_t)limbs[i] * 10;
            limbs[i] = (uint32_t)carry;
            carry >>= 32;
        }
    }
    memset(limbs, 0, sizeof limbs);
    limbs[LIMBS - 1] = 0x80000000;
    for (int k = -1; k >= FIRST; k--) {
        /* What is cut off here is cut off of the whole number once: a floor of a floor is one. */
        uint64_t left = 0;
        for (int i = LIMBS - 1; i >= 0; i--) {
            left = left << 32 | limbs[i];
            limbs[i] = (uint32_t)(left / 10);
            left %= 10;
        }
        powers[k - FIRST] = rounded_up(leading(limbs, &rest));
    }
    begun = 1;
}

static Wide product(uint64_t a, uint64_t b) {
#if defined(__SIZEOF_INT128__)
    unsigned __int128 ab = (unsigned __int128)a * b;
    return (Wide){(uint64_t)(ab >> 64), (uint64_t)ab};
#elif defined(_MSC_VER) && defined(_M_X64)
    Wide ab;
    ab.low = _umul128(a, b, &ab.high);
    return ab;
#else
    uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    uint64_t low = a0 * b0, middle = a1 * b0 + (low >> 32), other = a0 * b1 + (uint32_t)middle;
    return (Wide){a1 * b1 + (middle >> 32) + (other >> 32), other << 32 | (uint32_t)low};
#endif
}

static int leading_zeros(uint64_t x) {
#if defined(__GNUC__)
    return __builtin_clzll(x);
#else
    int n = 0;
    for (int step = 32; step; step >>= 1)
        if (!(x >> (64 - step))) {
            n += step;
            x <<= step;
        }
    return n;
#endif
}

/* The greatest whole number below k log2(10), for all k of the table. */
static int log2_of_power(int k) {
    return k >= 0 ? (int)((int64_t)k * 1741647 >> 19) : -(int)(((int64_t)-k * 1741647 + ((1 << 19) - 1)) >> 19);
}

static double with_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static const uint64_t INFINITE = (uint64_t)0x7ff << 52;

double decimal_nearest(uint64_t w, int64_t k) {
    if (!w || k < FIRST)
        return 0.0;
    if (k > 308)
        return with_bits(INFINITE);
    int zeros = leading_zeros(w);
    w <<= zeros;
    Wide power = powers[k - FIRST];
    if (k < -27 || k > 55) { /* The proof is for powers that are cut off there. */
        power.high -= !power.low;
        power.low--;
    }
    Wide found = product(w, power.high);
    if ((found.high & 0x1ff) == 0x1ff) {
        uint64_t more = product(w, power.low).high;
        found.low += more;
        found.high += found.low < more;
    }
    int upper = (int)(found.high >> 63);
    uint64_t mantissa = found.high >> (upper + 9);
    int exponent = log2_of_power((int)k) + 63 + upper - zeros + 1023;
    if (exponent <= 0) {
        if (exponent <= -63)
            return 0.0;
        mantissa >>= 1 - exponent;
        mantissa = (mantissa + (mantissa & 1)) >> 1;
        return with_bits(mantissa); /* One that is rounded up to 2^52 is the least normal one. */
    }
    /* In the middle between two: the even one. */
    if (found.low <= 1 && k >= -4 && k <= 23 && (mantissa & 3) == 1 && mantissa << (upper + 9) == found.high)
        mantissa &= ~(uint64_t)1;
    mantissa = (mantissa + (mantissa & 1)) >> 1;
    if (mantissa >= (uint64_t)1 << 53) {
        mantissa = (uint64_t)1 << 52;
        exponent++;
    }
    if (exponent >= 0x7ff)
        return with_bits(INFINITE);
    return with_bits((mantissa & ~((uint64_t)1 << 52)) | (uint64_t)exponent << 52);
}

/* a b / 2^128, its last bit set where anything is cut off. */
static uint64_t rounded_to_odd(Wide a, uint64_t b) {
    Wide high = product(a.high, b);
    uint64_t middle = high.low + product(a.low, b).high;
    return (high.high + (middle < high.low)) | (middle > 1);
}

/* Digits d and exponent k of the shortest decimal number d 10^k that rounds to c 2^q, of those the nearest. */
static uint64_t shortest(uint64_t c, int q, int least_of_its_power, int *k) {
    uint64_t odd = c & 1;
    int64_t scaled = (int64_t)q * 1262611 - (least_of_its_power ? 524031 : 0);
    *k = (int)(scaled >= 0 ? scaled >> 22 : -((-scaled + ((1 << 22) - 1)) >> 22));
    Wide power = powers[-*k - FIRST];
    int shift = q + log2_of_power(-*k) + 1;
    uint64_t lower = rounded_to_odd(power, (4 * c - 2 + (uint64_t)least_of_its_power) << shift) + odd;
    uint64_t here = rounded_to_odd(power, 4 * c << shift);
    uint64_t upper = rounded_to_odd(power, (4 * c + 2) << shift) - odd;
    uint64_t s = here / 4;
    if (s >= 10) {
        uint64_t tens = s / 10;
        int below = lower <= 40 * tens, above = 40 * tens + 40 <= upper;
        if (below != above) {
            ++*k;
            return tens + (uint64_t)above;
        }
    }
    int below = lower <= 4 * s, above = 4 * s + 4 <= upper;
    if (below != above)
        return s + (uint64_t)above;
    uint64_t middle = 4 * s + 2;
    return s + (here > middle || (here == middle && (s & 1)));
}

static const char PAIRS[] = "00010203040506070809101112131415161718192021222324252627282930313233343536373839404142434445464748"
                            "49505152535455565758596061626364656667686970717273747576777879808182838485868788899091929394959697"
                            "9899";

/* Eight digits. */
static void eight(char *to, uint32_t n) {
    uint32_t high = n / 10000, low = n % 10000;
    memcpy(to, PAIRS + 2 * (high / 100), 2);
    memcpy(to + 2, PAIRS + 2 * (high % 100), 2);
    memcpy(to + 4, PAIRS + 2 * (low / 100), 2);
    memcpy(to + 6, PAIRS + 2 * (low % 100), 2);
}

/* At most 17 digits: where they begin, behind zeros, in 24 signs. */
static int digits_of(char *all, uint64_t n) {
    uint64_t high = n / 100000000;
    all[7] = (char)('0' + high / 100000000);
    eight(all + 8, (uint32_t)(high % 100000000));
    eight(all + 16, (uint32_t)(n % 100000000));
    int first = n >= 10000000000000000u ? 7 : n >= 1000000000000000u ? 8 : 9;
    while (all[first] == '0')
        first++;
    return first;
}

static char *word(char *to, const char *text) {
    size_t length = strlen(text);
    memcpy(to, text, length);
    return to + length;
}

/* `-1e-7` and `1e+16`: an exponent from 16 zeros on, and from 5 zeros behind the point. */
static char *with_exponent(char *to, const char *digits, int count, int exponent) {
    *to++ = digits[0];
    if (count > 1) {
        *to++ = '.';
        memcpy(to, digits + 1, (size_t)count - 1);
        to += count - 1;
    }
    *to++ = 'e';
    *to++ = exponent < 0 ? '-' : '+';
    if (exponent < 0)
        exponent = -exponent;
    if (exponent >= 100)
        *to++ = (char)('0' + exponent / 100);
    if (exponent >= 10)
        *to++ = (char)('0' + exponent / 10 % 10);
    *to++ = (char)('0' + exponent % 10);
    return to;
}

char *decimal_write(char *to, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    uint64_t c = bits & (((uint64_t)1 << 52) - 1);
    int exponent = (int)(bits >> 52 & 0x7ff), k = 0;
    if (exponent == 0x7ff && c)
        return word(to, "NaN");
    if (bits >> 63)
        *to++ = '-';
    if (exponent == 0x7ff)
        return word(to, "Infinity");
    if (!exponent && !c)
        return word(to, "0.0");
    int least_of_its_power = !c && exponent > 1;
    if (exponent)
        c |= (uint64_t)1 << 52;
    else
        exponent = 1;
    int q = exponent - 1075;
    uint64_t n;
    if (q <= 0 && q > -53 && !(c & (((uint64_t)1 << -q) - 1)))
        n = c >> -q;
    else
        n = shortest(c, q, least_of_its_power, &k);
    for (; n % 10 == 0; k++)
        n /= 10;
    /* Copies are of 16 signs, for the processor's sake: what is behind the digits is written over. */
    char all[48] = {0};
    int first = digits_of(all, n), count = 24 - first, point = count + k;
    const char *digits = all + first;
    if (point > 16 || point < -4)
        return with_exponent(to, digits, count, point - 1);
    if (point <= 0) {
        memcpy(to, "0.000000", 8);
        to += 2 - point;
        *to = *digits;
        memcpy(to + 1, digits + 1, 16);
        return to + count;
    }
    memcpy(to, digits, 16);
    if (point < count) {
        to[point] = '.';
        memcpy(to + point + 1, digits + point, 16);
        return to + count + 1;
    }
    memset(to + count, '0', (size_t)(point - count));
    return word(to + point, ".0");
}
