#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

// Solve a small system in place, with pivoting; false if it is singular.
inline bool eliminate(std::vector<double>& matrix, std::vector<double>& right) {
    int64_t size = (int64_t)right.size();
    for (int64_t column = 0; column < size; column++) {
        int64_t pivot = column;
        for (int64_t row = column + 1; row < size; row++)
            if (std::fabs(matrix[row * size + column]) > std::fabs(matrix[pivot * size + column])) pivot = row;
        if (!(std::fabs(matrix[pivot * size + column]) > 0.0)) return false;
        if (pivot != column) {
            for (int64_t other = column; other < size; other++)
                std::swap(matrix[column * size + other], matrix[pivot * size + other]);
            std::swap(right[column], right[pivot]);
        }
        for (int64_t row = column + 1; row < size; row++) {
            double factor = matrix[row * size + column] / matrix[column * size + column];
            if (factor == 0.0) continue;
            for (int64_t other = column + 1; other < size; other++)
                matrix[row * size + other] -= factor * matrix[column * size + other];
            right[row] -= factor * right[column];
        }
    }
    for (int64_t row = size - 1; row >= 0; row--) {
        double total = right[row];
        for (int64_t other = row + 1; other < size; other++) total -= matrix[row * size + other] * right[other];
        right[row] = total / matrix[row * size + row];
    }
    return true;
}
