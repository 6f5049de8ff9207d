// A linear complementarity problem: the loops of mechanics/capstan.py, where it is explained.
#include <cmath>
#include <vector>

#include "arrays.hpp"
#include "eliminate.hpp"

namespace {

using Int = int64_t;
constexpr int GUESSES = 12;     // sets of unknowns above 0 that are tried before Lemke's algorithm
constexpr double NOISE = 1e-13;  // a sum of terms is known to this fraction of their sizes
constexpr double LIFT = 1e-11;   // added to the right-hand side so that no two rows of Lemke's tableau tie

// z >= 0, w = matrix z + right >= 0, z w = 0.
struct Complement {
    Int size;
    const double *matrix, *right;
    double* found;

    // Newton on the set of unknowns above 0, from those of the guess; false if it does not settle.
    bool refine() const {
        std::vector<char> above(size);
        for (Int row = 0; row < size; row++) above[row] = found[row] > 0.0;
        std::vector<Int> rows;
        std::vector<double> part, solved, guess(size);
        for (int round = 0; round < GUESSES; round++) {
            rows.clear();
            for (Int row = 0; row < size; row++)
                if (above[row]) rows.push_back(row);
            const Int count = (Int)rows.size();
            part.resize(count * count), solved.resize(count);
            for (Int i = 0; i < count; i++) {
                solved[i] = -right[rows[i]];
                for (Int j = 0; j < count; j++) part[i * count + j] = matrix[rows[i] * size + rows[j]];
            }
            if (!eliminate(part, solved)) return false;
            std::fill(guess.begin(), guess.end(), 0.0);
            for (Int i = 0; i < count; i++) guess[rows[i]] = solved[i];
            if (!exchange(above, guess)) {
                for (Int row = 0; row < size; row++) found[row] = guess[row];
                return true;
            }
        }
        return false;
    }

    // Move unknowns of the wrong sign out of the set, and those whose row is negative into it; whether any moved.
    bool exchange(std::vector<char>& above, const std::vector<double>& guess) const {
        bool moved = false;
        for (Int row = 0; row < size; row++) {
            double rest = right[row], noise = std::fabs(right[row]);
            for (Int column = 0; column < size; column++) {
                const double term = matrix[row * size + column] * guess[column];
                rest += term, noise += std::fabs(term);
            }
            const bool wrong = above[row] ? !(guess[row] >= 0.0) : !(rest >= -NOISE * noise);
            if (wrong) above[row] = !above[row], moved = true;
        }
        return moved;
    }

    // Lemke's algorithm; false if it ends in a ray. Column `size` + i of the tableau is unknown i, the last two are the
    // artificial unknown and the right-hand side.
    bool pivot() const {
        const Int wide = 2 * size + 2, artificial = 2 * size;
        std::vector<double> table(size * wide, 0.0);
        std::vector<Int> basis(size);
        Int row = 0;
        for (Int i = 0; i < size; i++) {
            basis[i] = i;
            table[i * wide + i] = 1.0;
            for (Int j = 0; j < size; j++) table[i * wide + size + j] = -matrix[i * size + j];
            table[i * wide + artificial] = -1.0;
            table[i * wide + artificial + 1] = right[i] + LIFT * (1.0 + (double)i / (double)size);
            if (table[i * wide + artificial + 1] < table[row * wide + artificial + 1]) row = i;
        }
        for (Int i = 0; i < size; i++) found[i] = 0.0;
        if (table[row * wide + artificial + 1] >= 0.0) return true;
        Int entering = artificial;
        for (Int step = 0; step < 20 * size; step++) {
            turn(table, row, entering);
            const Int leaving = basis[row];
            basis[row] = entering;
            if (leaving == artificial) {
                for (Int i = 0; i < size; i++)
                    if (basis[i] >= size) found[basis[i] - size] = table[i * wide + artificial + 1];
                return true;
            }
            entering = leaving < size ? leaving + size : leaving - size;
            if ((row = leaver(table, basis, entering)) < 0) return false;
        }
        return false;
    }

    void turn(std::vector<double>& table, Int row, Int entering) const {
        const Int wide = 2 * size + 2;
        double* own = table.data() + row * wide;
        const double scale = 1.0 / own[entering];
        for (Int j = 0; j < wide; j++) own[j] *= scale;
        for (Int i = 0; i < size; i++) {
            double* other = table.data() + i * wide;
            const double factor = other[entering];
            if (i == row || factor == 0.0) continue;
            for (Int j = 0; j < wide; j++) other[j] -= factor * own[j];
        }
    }

    // Row that leaves the basis: the artificial one where it may, else that of the largest pivot; -1 for a ray.
    Int leaver(const std::vector<double>& table, const std::vector<Int>& basis, Int entering) const {
        const Int wide = 2 * size + 2, last = wide - 1;
        double largest = 0.0, least = INFINITY, best = 0.0;
        for (Int i = 0; i < size; i++) largest = std::fmax(largest, std::fabs(table[i * wide + entering]));
        for (Int i = 0; i < size; i++)
            if (const double one = table[i * wide + entering]; one > 1e-11 * largest)
                least = std::fmin(least, table[i * wide + last] / one);
        Int row = -1;
        for (Int i = 0; i < size; i++) {
            const double one = table[i * wide + entering];
            if (!(one > 1e-11 * largest) || table[i * wide + last] / one > least + 1e-13 * std::fabs(least)) continue;
            if (basis[i] == 2 * size) return i;
            if (one > best) best = one, row = i;
        }
        return row;
    }
};

// A solution near the guess in `found`, else any if `far`; false if none is found.
bool complement(Reals<2> matrix, Reals<1> right, bool far, Array<double, 1> found) {
    const Int size = (Int)found.shape(0);
    demand((Int)matrix.shape(0) == size && (Int)matrix.shape(1) == size && (Int)right.shape(0) == size,
           "a row and a column for each unknown");
    const Complement problem{size, matrix.data(), right.data(), found.data()};
    Free others((double)size * (double)size * 1e2);
    return problem.refine() || (far && problem.pivot());
}

}  // namespace

void add_complement(nb::module_& module) {
    module.def("complement", &complement, given(), given(), given(), filled());
}
