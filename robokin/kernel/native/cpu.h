/* Whether the processor has AVX2 and the system keeps its registers: asked of the processor itself, for not every
   compiler's library knows.
*/

#ifndef ROBOKIN_CPU_H
#define ROBOKIN_CPU_H

#if defined(_MSC_VER) && !defined(__clang__)
#include <immintrin.h>
#include <intrin.h>

static void cpuid(unsigned leaf, unsigned *about) { __cpuidex((int *)about, (int)leaf, 0); }

static unsigned kept_registers(void) { return (unsigned)_xgetbv(0); }
#else
#include <cpuid.h>

static void cpuid(unsigned leaf, unsigned *about) {
    __cpuid_count(leaf, 0, about[0], about[1], about[2], about[3]);
}

static unsigned kept_registers(void) {
    unsigned low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}
#endif

static int has_avx2(void) {
    unsigned about[4];
    cpuid(0, about);
    if (about[0] < 7)
        return 0;
    cpuid(1, about);
    if ((about[2] >> 27 & 3) != 3 || (kept_registers() & 6) != 6)
        return 0;
    cpuid(7, about);
    return about[1] >> 5 & 1;
}

#endif
