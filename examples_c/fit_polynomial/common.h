/* Failures end the program, and say why. */
#ifndef FIT_POLYNOMIAL_COMMON_H
#define FIT_POLYNOMIAL_COMMON_H

#include "noisefloor.h"
#include <stdio.h>
#include <stdlib.h>

static void fail(const char *what, const char *why)
{
    fprintf(stderr, "fit_polynomial: %s: %s\n", what, why);
    exit(1);
}

static void check(nf_status status, const char *what)
{
    if (status != NF_OK)
        fail(what, nf_status_message(status));
}

/* malloc's memory is aligned for anything, and a table asks for 8 bytes. */
static void *allocate(size_t bytes)
{
    void *memory = malloc(bytes > 0 ? bytes : 1);
    if (!memory)
        fail("no memory", "malloc failed");
    return memory;
}

#endif
