/* A file of tests/vectors in memory. */
#ifndef NF_TESTS_TILE_FILE_H
#define NF_TESTS_TILE_FILE_H

#include "check.h"

/* The bytes of tests/vectors/NAME, in memory of exactly that size; ends the program if there is none. */
static inline memory tile_file(const char *name)
{
    char path[256];
    memory bytes;
    long size;
    FILE *file;
    snprintf(path, sizeof path, "tests/vectors/%s", name);
    file = fopen(path, "rb");
    if (!file) {
        fprintf(stderr, "cannot open %s: run this in the repository's root\n", path);
        exit(2);
    }
    fseek(file, 0, SEEK_END);
    size = ftell(file);
    rewind(file);
    bytes = memory_new(size > 0 ? (size_t)size : 0);
    if (size <= 0 || fread(bytes.start, 1, bytes.bytes, file) != bytes.bytes) {
        fprintf(stderr, "cannot read %s\n", path);
        exit(2);
    }
    fclose(file);
    return bytes;
}

#endif
