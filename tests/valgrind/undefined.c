/* Reads what nothing wrote: valgrind must say so, or its silence elsewhere means nothing. */
#include <stdio.h>
#include <stdlib.h>

int main(void)
{
    /* Volatile, or the compiler sees it too. */
    volatile int *volatile number = (volatile int *)malloc(sizeof(int));
    int is_zero;
    if (!number)
        return 2;
    is_zero = *number == 0;
    printf("%s\n", is_zero ? "zero" : "not zero");
    free((void *)number);
    return 0;
}
