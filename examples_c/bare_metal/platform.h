/* What services.c needs from where it runs: board.c has it for microcontrollers, host.c for a computer. */
#ifndef PLATFORM_H
#define PLATFORM_H

#include <stdint.h>

void platform_print(const char *text);

/* Fills the free part of the stack with a pattern, so that platform_stack_used() can tell how deep a call went. */
void platform_stack_paint(void);

/* Bytes of stack that were written below the caller's own since the last painting. */
uint32_t platform_stack_used(void);

/* Calls these services, prints what each returned, and returns 0 if all succeeded. */
int services(void);

#endif
