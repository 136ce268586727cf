/* A board with nothing on it: variables, and output by semihosting. Another board needs another linker script and
   another platform_print(). */
#include "board.h"
#include "platform.h"

#include <stddef.h>

extern uint32_t data_start[], data_end[], bss_start[], bss_end[];
extern const uint32_t data_image[];

static void stop(uint32_t reason)
{
    board_semihosting(SYS_EXIT, (const void *)reason);
    for (;;)
        ;
}

void platform_print(const char *text)
{
    board_semihosting(SYS_WRITE0, text);
}

/* What compilers call without being asked, written so that they do not make it call itself. The library brings its own.
 */
void *memset(void *to, int value, size_t bytes)
{
    volatile unsigned char *byte = to;
    while (bytes--)
        *byte++ = (unsigned char)value;
    return to;
}

void *memcpy(void *to, const void *from, size_t bytes)
{
    volatile unsigned char *byte = to;
    const unsigned char *source = from;
    while (bytes--)
        *byte++ = *source++;
    return to;
}

void board_reset(void)
{
    const uint32_t *from = data_image;
    volatile uint32_t *to;
    for (to = data_start; to < data_end; ++to)
        *to = *from++;
    for (to = bss_start; to < bss_end; ++to)
        *to = 0;
    stop(services() == 0 ? STOPPED_WELL : STOPPED_BY_ERROR);
}

void board_fault(void)
{
    platform_print("fault\n");
    stop(STOPPED_BY_ERROR);
}
