/* What every board has in common, and what each has of its own: cortex_m4f.c, riscv32.c. */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

#define SYS_WRITE0 0x04u
#define SYS_EXIT 0x18u
#define STOPPED_WELL 0x20026u
#define STOPPED_BY_ERROR 0x20024u

/* Asks the debugger, or the emulator, for a service: each processor has its own instruction for it. */
void board_semihosting(uint32_t operation, const void *argument);

/* What is left to do after the processor's own start. */
void board_reset(void);

/* What an exception leads to. */
void board_fault(void);

#endif
