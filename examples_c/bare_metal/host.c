/* The same services on a computer: what the board's output is compared with. They run in a thread, as its stack is a
   place that is known. */
#include "platform.h"
#include <pthread.h>
#include <stdio.h>

#define STACK_BYTES (256 * 1024)

uint32_t stack_limit[STACK_BYTES / 4] __attribute__((aligned(4096)));

void platform_print(const char *text)
{
    fputs(text, stdout);
}

static void *run(void *failures)
{
    *(int *)failures = services();
    return NULL;
}

int main(void)
{
    int failures = 1;
    pthread_attr_t attributes;
    pthread_t thread;
    if (pthread_attr_init(&attributes) != 0 || pthread_attr_setstack(&attributes, stack_limit, STACK_BYTES) != 0 ||
        pthread_create(&thread, &attributes, run, &failures) != 0 || pthread_join(thread, NULL) != 0) {
        fputs("error: no thread with a stack of its own\n", stderr);
        return 2;
    }
    return failures;
}
