// Error of sets of straight-drawn cables on a linear body: the loop of design/routes/sketch.py.
#include <algorithm>
#include <cmath>
#include <vector>

#include "arrays.hpp"

namespace {

using Int = int64_t;
using Numbers = std::vector<double>;

// Solves with a symmetric positive matrix of `size` rows in place, by Cholesky; `sides` right-hand sides, row by row.
bool solve(Numbers& matrix, Numbers& right, Int size, Int sides) {
    for (Int column = 0; column < size; column++) {
        double pivot = matrix[column * size + column];
        for (Int k = 0; k < column; k++) pivot -= matrix[column * size + k] * matrix[column * size + k];
        if (!(pivot > 0.0)) return false;
        matrix[column * size + column] = pivot = std::sqrt(pivot);
        for (Int row = column + 1; row < size; row++) {
            double value = matrix[row * size + column];
            for (Int k = 0; k < column; k++) value -= matrix[row * size + k] * matrix[column * size + k];
            matrix[row * size + column] = value / pivot;
        }
    }
    for (Int side = 0; side < sides; side++) {
        for (Int row = 0; row < size; row++) {
            double value = right[row * sides + side];
            for (Int k = 0; k < row; k++) value -= matrix[row * size + k] * right[k * sides + side];
            right[row * sides + side] = value / matrix[row * size + row];
        }
        for (Int row = size; row-- > 0;) {
            double value = right[row * sides + side];
            for (Int k = row + 1; k < size; k++) value -= matrix[k * size + row] * right[k * sides + side];
            right[row * sides + side] = value / matrix[row * size + row];
        }
    }
    return true;
}

// Nonnegative x of least x G x / 2 - g x (Lawson and Hanson 1974, by normal equations); what it takes from the square.
double take(const Numbers& gram, const Numbers& aim, Int size, Numbers& x) {
    x.assign(size, 0.0);
    std::vector<char> free(size, 0);
    Numbers slope(aim), part, step;
    std::vector<Int> own;
    double largest = 0.0;
    for (double value : aim) largest = std::max(largest, std::abs(value));
    for (Int round = 0; round < 3 * size; round++) {
        Int best = -1;
        for (Int j = 0; j < size; j++)
            if (!free[j] && slope[j] > 1e-12 * largest && (best < 0 || slope[j] > slope[best])) best = j;
        if (best < 0) break;
        free[best] = 1;
        while (true) {
            own.clear();
            for (Int j = 0; j < size; j++) if (free[j]) own.push_back(j);
            const Int count = (Int)own.size();
            part.resize(count * count), step.resize(count);
            for (Int i = 0; i < count; i++) {
                step[i] = aim[own[i]];
                for (Int j = 0; j < count; j++) part[i * count + j] = gram[own[i] * size + own[j]];
                part[i * count + i] *= 1.0 + 1e-12;
            }
            if (!solve(part, step, count, 1)) { free[best] = 0; break; }
            double share = 1.0;
            for (Int i = 0; i < count; i++)
                if (step[i] <= 0.0) share = std::min(share, x[own[i]] / std::max(x[own[i]] - step[i], 1e-300));
            for (Int i = 0; i < count; i++) x[own[i]] += share * (step[i] - x[own[i]]);
            if (share >= 1.0) break;
            for (Int i = 0; i < count; i++)
                if (step[i] <= 0.0 && x[own[i]] <= 1e-14 * std::abs(step[i])) free[own[i]] = 0, x[own[i]] = 0.0;
            if (std::none_of(free.begin(), free.end(), [](char one) { return one; })) break;
        }
        for (Int i = 0; i < size; i++) {
            slope[i] = aim[i];
            for (Int j = 0; j < size; j++) slope[i] -= gram[i * size + j] * x[j];
        }
    }
    double taken = 0.0;
    for (Int i = 0; i < size; i++) taken += x[i] * (aim[i] + slope[i]);
    return taken;
}

// One linear model of a body with lines drawn on it.
struct Lines {
    Int count, poses;
    const double *gives, *grams, *aims, *squares, *ridges;
    const Int* places;
    Numbers part, tensions, gram, aim, x;
    std::vector<Int> taut, winches;

    // Square of the error of a pose and of its effort; lines that would have to push are left slack, in a few rounds.
    double missed(const Int* chosen, Int size, Int pose, Int rounds) {
        winches.assign(1, places[chosen[0]]);
        for (Int k = 0; k < size; k++)
            if (std::find(winches.begin(), winches.end(), places[chosen[k]]) == winches.end()) winches.push_back(places[chosen[k]]);
        const Int width = (Int)winches.size();
        taut.assign(chosen, chosen + size);
        for (Int round = 0; round < rounds; round++) {
            const Int own = (Int)taut.size();
            part.resize(own * own), tensions.assign(own * width, 0.0);
            for (Int i = 0; i < own; i++) {
                for (Int j = 0; j < own; j++) part[i * own + j] = gives[taut[i] * count + taut[j]];
                tensions[i * width + (std::find(winches.begin(), winches.end(), places[taut[i]]) - winches.begin())] = 1.0;
            }
            if (!solve(part, tensions, own, width)) return squares[pose];
            project(own, width, pose);
            const double left = squares[pose] - take(gram, aim, width, x);
            if (!leave_slack(own, width)) return std::max(left, 0.0);
            if (taut.empty()) break;
        }
        return squares[pose];
    }
    // Normal equations of the pulls of the winches.
    void project(Int own, Int width, Int pose) {
        const double *product = grams + pose * count * count, ridge = ridges[pose] * ridges[pose];
        gram.assign(width * width, 0.0), aim.assign(width, 0.0);
        for (Int i = 0; i < own; i++)
            for (Int w = 0; w < width; w++) {
                const double pull = tensions[i * width + w];
                aim[w] += pull * aims[pose * count + taut[i]];
                for (Int j = 0; j < own; j++) {
                    const double both = pull * (product[taut[i] * count + taut[j]] + (i == j ? ridge : 0.0));
                    for (Int v = 0; v < width; v++) gram[w * width + v] += both * tensions[j * width + v];
                }
            }
    }
    // True where some would have to push; these are left out.
    bool leave_slack(Int own, Int width) {
        Numbers pulls(own, 0.0);
        double most = 0.0;
        for (Int i = 0; i < own; i++) {
            for (Int w = 0; w < width; w++) pulls[i] += tensions[i * width + w] * x[w];
            most = std::max(most, pulls[i]);
        }
        std::vector<Int> kept;
        for (Int i = 0; i < own; i++)
            if (!(pulls[i] < -1e-6 * most)) kept.push_back(taut[i]);
        if ((Int)kept.size() == own) return false;
        taut = kept;
        return true;
    }
};

// Error of sets of lines, each a row of `sets` that ends with -1: root of the sum over poses of squares.
void line_errors(Reals<2> gives, Reals<3> grams, Reals<2> aims, Reals<1> squares, Reals<1> ridges, Counts<1> places,
                 Counts<2> sets, Int rounds, Array<double, 1> errors) {
    const Int count = (Int)places.shape(0), poses = (Int)squares.shape(0), most = (Int)sets.shape(1);
    demand((Int)gives.shape(0) == count && (Int)gives.shape(1) == count && (Int)grams.shape(0) == poses &&
               (Int)grams.shape(1) == count && (Int)grams.shape(2) == count && (Int)aims.shape(0) == poses &&
               (Int)aims.shape(1) == count && (Int)ridges.shape(0) == poses && errors.shape(0) == sets.shape(0),
           "lines of one model");
    demand_range(sets, -1, count, "no such line");
    Lines lines{count, poses, gives.data(), grams.data(), aims.data(), squares.data(), ridges.data(), places.data()};
    for (Int row = 0; row < (Int)sets.shape(0); row++) {
        const Int* chosen = sets.data() + row * most;
        const Int size = std::find(chosen, chosen + most, -1) - chosen;
        double total = 0.0;
        for (Int pose = 0; pose < poses; pose++) total += size ? lines.missed(chosen, size, pose, rounds) : lines.squares[pose];
        errors.data()[row] = std::sqrt(total);
    }
}

}  // namespace

void add_sketches(nb::module_& module) {
    module.def("line_errors", &line_errors, given(), given(), given(), given(), given(), given(), given(), given(), filled());
}
