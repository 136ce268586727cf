/* A RISC-V of 32 bits without a floating-point unit: its reset, its semihosting. */
#include "board.h"

/* A debugger knows the request by the two instructions around it, which do nothing; none may be a short one. */
void board_semihosting(uint32_t operation, const void *argument)
{
    register uint32_t a0 __asm__("a0") = operation;
    register const void *a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n\t.option norvc\n\t.balign 16\n\t"
                     "slli x0, x0, 0x1f\n\tebreak\n\tsrai x0, x0, 7\n\t.option pop"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
}

/* What stands first in memory: the stack, where exceptions lead, and the rest in C. */
__asm__(".section .vectors, \"ax\"\n"
        ".global reset\n"
        ".option push\n.option arch, +zicsr\n"
        "reset:\n\tla sp, stack_top\n\tla t0, exception\n\tcsrw mtvec, t0\n\tj board_reset\n"
        ".option pop\n.balign 4\n"
        "exception:\n\tj board_fault\n"
        ".previous\n");
