// Products of small matrices, row after row, in loops that a compiler turns into vector instructions.
#pragma once
#include <cstddef>

namespace fit {

// c[m][n] = a[m][k] b[k][n].
inline void multiply(std::size_t m, std::size_t k, std::size_t n, const float *a, const float *b, float *c)
{
    constexpr std::size_t ROWS = 4, COLUMNS = 16; // of c: what fits into registers
    std::size_t row = 0;
    for (; row + ROWS <= m; row += ROWS) {
        std::size_t column = 0;
        for (; column + COLUMNS <= n; column += COLUMNS) {
            float sum0[COLUMNS] = {}, sum1[COLUMNS] = {}, sum2[COLUMNS] = {}, sum3[COLUMNS] = {};
            const float *a0 = a + row * k, *a1 = a0 + k, *a2 = a1 + k, *a3 = a2 + k;
            for (std::size_t i = 0; i < k; ++i) {
                const float *values = b + i * n + column;
                for (std::size_t j = 0; j < COLUMNS; ++j) {
                    sum0[j] += a0[i] * values[j];
                    sum1[j] += a1[i] * values[j];
                    sum2[j] += a2[i] * values[j];
                    sum3[j] += a3[i] * values[j];
                }
            }
            float *out = c + row * n + column;
            for (std::size_t j = 0; j < COLUMNS; ++j) {
                out[j] = sum0[j];
                out[n + j] = sum1[j];
                out[2 * n + j] = sum2[j];
                out[3 * n + j] = sum3[j];
            }
        }
        for (; column < n; ++column)
            for (std::size_t r = row; r < row + ROWS; ++r) {
                float sum = 0.0f;
                for (std::size_t i = 0; i < k; ++i)
                    sum += a[r * k + i] * b[i * n + column];
                c[r * n + column] = sum;
            }
    }
    for (; row < m; ++row) {
        for (std::size_t column = 0; column < n; ++column)
            c[row * n + column] = 0.0f;
        for (std::size_t i = 0; i < k; ++i)
            for (std::size_t column = 0; column < n; ++column)
                c[row * n + column] += a[row * k + i] * b[i * n + column];
    }
}

// out[columns][rows] = the transpose of in[rows][columns].
inline void transpose(std::size_t rows, std::size_t columns, const float *in, float *out)
{
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
            out[column * rows + row] = in[row * columns + column];
}

} // namespace fit
