/* What every part of the trainer uses: errors that end the program, and memory. */
#ifndef TRAIN_MLP_COMMON_H
#define TRAIN_MLP_COMMON_H

#include "noisefloor.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char *format, ...)
{
    va_list arguments;
    fprintf(stderr, "train_mlp: ");
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\n");
    exit(EXIT_FAILURE);
}

/* Every call into noisefloor that can fail goes through this. */
static void check(nf_status status, const char *what)
{
    if (status != NF_OK)
        fail("%s: %s", what, nf_status_message(status));
}

/* count * size bytes, zeroed; never NULL. Aligned for any type, so for noisefloor's objects too. */
static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (memory == NULL)
        fail("no memory for %.1f MB", (double)count * (double)size / 1e6);
    return memory;
}

#endif
