/* A Cortex-M4F with nothing on it: reset, the floating-point unit, output by semihosting, and the depth of the stack.
   Built for QEMU's mps2-an386; another board needs another linker script and another platform_print(). */
#include "platform.h"

#include <stddef.h>

#define PAINT 0xC0DEC0DEu
#define CPACR (*(volatile uint32_t *)0xE000ED88u) /* coprocessor access control */
#define SYS_WRITE0 0x04u
#define SYS_EXIT 0x18u
#define STOPPED_WELL 0x20026u
#define STOPPED_BY_ERROR 0x20024u

extern uint32_t stack_limit[], stack_top[], data_start[], data_end[], bss_start[], bss_end[];
extern const uint32_t data_image[];
static uint32_t *painted_to;

static void semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void stop(uint32_t reason)
{
    semihosting(SYS_EXIT, (const void *)reason);
    for (;;)
        ;
}

void platform_print(const char *text)
{
    semihosting(SYS_WRITE0, text);
}

/* What compilers call without being asked, written so that they do not make it call itself. The library brings its own. */
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

void reset(void)
{
    const uint32_t *from = data_image;
    volatile uint32_t *to;
    CPACR |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb");
    for (to = data_start; to < data_end; ++to)
        *to = *from++;
    for (to = bss_start; to < bss_end; ++to)
        *to = 0;
    stop(services() == 0 ? STOPPED_WELL : STOPPED_BY_ERROR);
}

static void fault(void)
{
    platform_print("fault\n");
    stop(STOPPED_BY_ERROR);
}

/* The initial stack pointer, reset, and the fifteen exceptions that every Cortex-M has. */
__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {stack_top,
             {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault}};
