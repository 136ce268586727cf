/* A Cortex-M4F: its reset, its floating-point unit, its semihosting. */
#include "board.h"

#define CPACR (*(volatile uint32_t *)0xE000ED88u) /* coprocessor access control */

extern uint32_t stack_top[];

void board_semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void reset(void)
{
    CPACR |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb");
    board_reset();
}

/* The initial stack pointer, reset, and the other fourteen exceptions that every Cortex-M has. */
__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {stack_top,
             {reset, board_fault, board_fault, board_fault, board_fault, board_fault, board_fault, board_fault,
              board_fault, board_fault, board_fault, board_fault, board_fault, board_fault, board_fault}};
