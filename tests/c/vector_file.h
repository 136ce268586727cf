/* A file of tests/vectors, line by line. Before all other headers, so that they declare feenableexcept(). */
#ifndef NF_TESTS_VECTOR_FILE_H
#define NF_TESTS_VECTOR_FILE_H

#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "check.h"
#include <fenv.h>
#ifdef __x86_64__
#include <xmmintrin.h>
#endif

/* As some hosts set the processor: invalid operations, divisions by zero and overflows end the program, and subnormal
 * numbers are flushed to zero. x86-64 alone. */
static inline void set_as_hosts_do(void)
{
#if defined(__x86_64__) && defined(__GLIBC__)
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
#endif
#ifdef __x86_64__
    _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
}

/* Calls check for every line but comments and empty ones, with its number; returns how many. Ends the program if there
   is no file. */
static inline int each_vector(const char *path, void (*check)(const char *line, int number))
{
    char line[512];
    int number = 0, used = 0;
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(stderr, "cannot open %s: run this in the repository's root\n", path);
        exit(2);
    }
    while (fgets(line, sizeof line, file)) {
        ++number;
        if (line[0] != '#' && line[0] != '\n') {
            check(line, number);
            ++used;
        }
    }
    fclose(file);
    return used;
}

#endif
