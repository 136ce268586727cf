/* How deep calls go: the free part of the stack is painted before, and looked at after. stack_limit is where it ends.
 */
#include "platform.h"

#define PAINT 0xC0DEC0DEu

extern uint32_t stack_limit[];
static uint32_t *painted_to;

/* The pattern ends a little below this function's own frame. */
__attribute__((noinline)) void platform_stack_paint(void)
{
    uint32_t *here = (uint32_t *)__builtin_frame_address(0) - 8;
    volatile uint32_t *word;
    for (word = stack_limit; word < here; ++word)
        *word = PAINT;
    painted_to = here;
}

__attribute__((noinline)) uint32_t platform_stack_used(void)
{
    uint32_t *word = stack_limit;
    while (word < painted_to && *(volatile uint32_t *)word == PAINT)
        ++word;
    return (uint32_t)((painted_to + 8 - word) * 4);
}
