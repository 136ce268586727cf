/* Failures end the program, and say why. */
#ifndef FIT_POLYNOMIAL_COMMON_H
#define FIT_POLYNOMIAL_COMMON_H

#include "noisefloor.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static void fail(const char *format, ...)
{
    va_list arguments;
    fprintf(stderr, "fit_polynomial: ");
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\n");
    exit(1);
}

static void check(nf_status status, const char *what)
{
    if (status != NF_OK)
        fail("%s: %s", what, nf_status_message(status));
}

/* malloc's memory is aligned for anything, and a table asks for 8 bytes. */
static void *allocate(size_t bytes)
{
    void *memory = malloc(bytes > 0 ? bytes : 1);
    if (!memory)
        fail("no memory for %.1f MB", (double)bytes / 1e6);
    return memory;
}

#endif
