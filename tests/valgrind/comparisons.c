/* Whether the processor, or what emulates it, compares with NaN as AVX says: `x != y`, ordered, is false where x or y
 * is NaN. Compilers make this instruction of "is finite". Valgrind 3.19 returns true. Exit status: 0 right, 1 wrong. */
#include <stdio.h>

#if defined(__x86_64__)
#include <immintrin.h>

__attribute__((target("avx"))) static int not_equal(float a, float b)
{
    return _mm256_movemask_ps(_mm256_cmp_ps(_mm256_set1_ps(a), _mm256_set1_ps(b), _CMP_NEQ_OQ));
}

int main(void)
{
    volatile float zero = 0.0f;
    int with_nan;
    if (!__builtin_cpu_supports("avx"))
        return 0;
    if (not_equal(1.0f, 2.0f) != 0xFF || not_equal(2.0f, 2.0f) != 0) {
        fprintf(stderr, "vcmpneq_oqps is wrong without NaN too\n");
        return 2;
    }
    with_nan = not_equal(zero / zero, 1.0f);
    printf("1 != NaN, ordered: %02x in eight lanes\n", (unsigned)with_nan);
    return with_nan == 0 ? 0 : 1;
}
#else
int main(void) { return 0; }
#endif
