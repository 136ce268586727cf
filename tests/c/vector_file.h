/* A file of tests/vectors, line by line. */
#ifndef NF_TESTS_VECTOR_FILE_H
#define NF_TESTS_VECTOR_FILE_H

#include "check.h"

/* Calls check for every line but comments and empty ones, with its number; returns how many. Ends the program if there is no
   file. */
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
