/* The same services on a computer: what the board's output is compared with. */
#include "platform.h"
#include <stdio.h>

void platform_print(const char *text)
{
    fputs(text, stdout);
}

void platform_stack_paint(void)
{
}

uint32_t platform_stack_used(void)
{
    return 0;
}

int main(void)
{
    return services();
}
