// Small networks, their slopes, and a search on them: the loops of learning/perceptrons.py, where they are explained.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "arrays.hpp"

namespace {

using Int = int64_t;
constexpr int TRIES = 8;         // dampings tried for one step
constexpr double STEP = 1e-6;    // a step that changes no input by more is the last
constexpr double GAIN = 1e-3;    // so is one that takes away less of what is left
constexpr double FLAT = 1e-14;   // slopes below this share of what they could be are none

// Networks of one shape. An answer is a row for the value, then, where asked, one for the slope by each input.
template <class Real> struct Networks {
    Int members, layers, inputs, outputs, widest, each;
    const Int* sizes;
    const Real* numbers;
    std::vector<Real> come, gone;

    Networks(const Counts<1>& sizes, const Array<const Real, 2>& numbers, Int point)
        : members((Int)numbers.shape(0)), layers((Int)sizes.shape(0) - 1), widest(0), each((Int)numbers.shape(1)),
          sizes(sizes.data()), numbers(numbers.data()) {
        demand(layers >= 1 && members >= 1, "a network has layers");
        Int count = 0;
        for (Int layer = 0; layer <= layers; layer++) {
            demand(this->sizes[layer] >= 1 && this->sizes[layer] <= 1'000'000, "sizes of layers");
            widest = std::max(widest, this->sizes[layer]);
            if (layer) count += (this->sizes[layer - 1] + 1) * this->sizes[layer];
        }
        inputs = this->sizes[0], outputs = this->sizes[layers];
        demand(count + inputs * outputs == each && point == inputs, "numbers of the networks");
        come.resize((inputs + 1) * widest), gone.resize((inputs + 1) * widest);
    }

    // A row through a layer: moved = move @ weights, four rows of weights at a time.
    static void pass(const Real* __restrict weights, const Real* __restrict move, Real* __restrict moved, Int rows, Int columns) {
        std::fill(moved, moved + columns, (Real)0);
        Int row = 0;
        for (; row + 4 <= rows; row += 4) {
            const Real a = move[row], b = move[row + 1], c = move[row + 2], d = move[row + 3];
            const Real *one = weights + row * columns, *two = one + columns, *three = two + columns, *four = three + columns;
            for (Int column = 0; column < columns; column++)
                moved[column] += (a * one[column] + b * two[column]) + (c * three[column] + d * four[column]);
        }
        for (; row < rows; row++)
            for (Int column = 0; column < columns; column++) moved[column] += move[row] * weights[row * columns + column];
    }

    // One network at a point; slopes (inputs, outputs) too unless they are null.
    void answer(Int member, const Real* point, Real* value, Real* slopes) {
        const Real* at = numbers + member * each;
        const Int rows = slopes ? inputs + 1 : 1;
        Real *old = come.data(), *next = gone.data();
        std::fill(old, old + rows * widest, (Real)0);
        std::copy(point, point + inputs, old);
        for (Int row = 1; row < rows; row++) old[row * widest + row - 1] = (Real)1;
        for (Int layer = 0; layer < layers; layer++) {
            const Int from = sizes[layer], to = sizes[layer + 1];
            const Real* offsets = at + from * to;
            for (Int row = 0; row < rows; row++) pass(at, old + row * widest, next + row * widest, from, to);
            for (Int column = 0; column < to; column++) next[column] += offsets[column];
            if (layer + 1 < layers)
                for (Int column = 0; column < to; column++) {  // SiLU
                    const Real gate = (Real)1 / ((Real)1 + std::exp(-next[column])), out = next[column] * gate;
                    const Real slope = gate + out * ((Real)1 - gate);
                    next[column] = out;
                    for (Int row = 1; row < rows; row++) next[row * widest + column] *= slope;
                }
            std::swap(old, next);
            at = offsets + to;
        }
        for (Int column = 0; column < outputs; column++) {
            value[column] = old[column];
            for (Int row = 0; row < inputs; row++) {
                const Real beside = at[row * outputs + column];
                value[column] += point[row] * beside;
                if (slopes) slopes[row * outputs + column] = old[(row + 1) * widest + column] + beside;
            }
        }
    }

    // Mean answer, and its slopes (inputs, outputs) unless they are null.
    void mean(const Real* point, double* value, double* slopes) {
        std::vector<Real> one(outputs), its(slopes ? inputs * outputs : 0);
        std::fill(value, value + outputs, 0.0);
        if (slopes) std::fill(slopes, slopes + inputs * outputs, 0.0);
        for (Int member = 0; member < members; member++) {
            answer(member, point, one.data(), slopes ? its.data() : nullptr);
            for (Int column = 0; column < outputs; column++) value[column] += one[column] / (double)members;
            for (size_t place = 0; place < its.size(); place++) slopes[place] += its[place] / (double)members;
        }
    }
};

void network_values(Counts<1> sizes, Reals<2> numbers, Reals<1> point, Array<double, 2> found) {
    Networks<double> all(sizes, numbers, (Int)point.shape(0));
    demand((Int)found.shape(0) == all.members && (Int)found.shape(1) == all.outputs, "an answer of each network");
    for (Int member = 0; member < all.members; member++)
        all.answer(member, point.data(), found.data() + member * all.outputs, nullptr);
}

// Mean answer in single precision, and the root of the mean square of how far the networks are from it.
void network_agreement(Counts<1> sizes, Array<const float, 2> numbers, Array<const float, 1> point, Array<double, 1> mean,
                       Array<double, 1> spread) {
    Networks<float> all(sizes, numbers, (Int)point.shape(0));
    demand((Int)mean.shape(0) == all.outputs && (Int)spread.shape(0) == all.outputs, "a mean of each output");
    std::vector<float> found(all.members * all.outputs);
    for (Int member = 0; member < all.members; member++)
        all.answer(member, point.data(), found.data() + member * all.outputs, nullptr);
    for (Int column = 0; column < all.outputs; column++) {
        double middle = 0.0, square = 0.0;
        for (Int member = 0; member < all.members; member++) middle += found[member * all.outputs + column] / (double)all.members;
        for (Int member = 0; member < all.members; member++) {
            const double off = found[member * all.outputs + column] - middle;
            square += off * off / (double)all.members;
        }
        mean.data()[column] = middle, spread.data()[column] = std::sqrt(square);
    }
}

void network_mean(Counts<1> sizes, Reals<2> numbers, Reals<1> point, Array<double, 1> value, Array<double, 2> slopes) {
    Networks<double> all(sizes, numbers, (Int)point.shape(0));
    demand((Int)value.shape(0) == all.outputs && (Int)slopes.shape(0) == all.inputs && (Int)slopes.shape(1) == all.outputs,
           "a value and its slopes");
    all.mean(point.data(), value.data(), slopes.data());
}

// Solution of (normal + damping) change = -gradient on what is free, by Cholesky's factors.
std::vector<double> damped(const std::vector<double>& normal, const std::vector<double>& gradient,
                           const std::vector<double>& free, double damping, double largest) {
    const Int size = (Int)gradient.size();
    std::vector<double> lower(size * size), change(size);
    for (Int one = 0; one < size; one++)
        for (Int two = 0; two <= one; two++) {
            double value = normal[one * size + two] * free[one] * free[two];
            if (one == two) value += damping * std::max(normal[one * size + one], 1e-3 * largest) + (1.0 - free[one]) + FLAT;
            for (Int inner = 0; inner < two; inner++) value -= lower[one * size + inner] * lower[two * size + inner];
            lower[one * size + two] = one == two ? std::sqrt(std::max(value, 1e-300)) : value / lower[two * size + two];
        }
    for (Int one = 0; one < size; one++) {
        double value = -gradient[one] * free[one];
        for (Int inner = 0; inner < one; inner++) value -= lower[one * size + inner] * change[inner];
        change[one] = value / lower[one * size + one];
    }
    for (Int one = size - 1; one >= 0; one--) {
        double value = change[one];
        for (Int inner = one + 1; inner < size; inner++) value -= lower[inner * size + one] * change[inner];
        change[one] = value / lower[one * size + one];
    }
    return change;
}

// Levenberg and Marquardt's descent within a box; `point` is where it begins, and ends. Returns what is left there.
double network_descent(Counts<1> sizes, Reals<2> numbers, Array<double, 1> point, Reals<1> goal, Reals<1> weights, Reals<1> low,
                       Reals<1> high, int64_t rounds) {
    Networks<double> all(sizes, numbers, (Int)point.shape(0));
    const Int inputs = all.inputs, outputs = all.outputs;
    demand((Int)goal.shape(0) == outputs && (Int)weights.shape(0) == outputs && (Int)low.shape(0) == inputs &&
               (Int)high.shape(0) == inputs, "a goal of each output, a range of each input");
    double* at = point.data();
    double damping = 1e-3, left = std::numeric_limits<double>::infinity();
    std::vector<double> value(outputs), slopes(inputs * outputs), residual(outputs), free(inputs), trial(inputs);
    auto squares = [&] {
        double total = 0.0;
        for (Int column = 0; column < outputs; column++) {
            residual[column] = weights.data()[column] * (value[column] - goal.data()[column]);
            total += residual[column] * residual[column];
        }
        return total;
    };
    Free others(1e4 * (double)(rounds * all.members));
    for (Int round = 0; round < rounds; round++) {
        all.mean(at, value.data(), slopes.data());
        left = squares();
        std::vector<double> normal(inputs * inputs), gradient(inputs);
        double largest = 0.0, freest = 0.0;
        for (Int one = 0; one < inputs; one++) {
            for (Int column = 0; column < outputs; column++) {
                const double slope = slopes[one * outputs + column] * weights.data()[column];
                gradient[one] += slope * residual[column];
                for (Int two = 0; two <= one; two++)
                    normal[one * inputs + two] += slope * slopes[two * outputs + column] * weights.data()[column];
            }
            largest = std::max(largest, normal[one * inputs + one]);
        }
        for (Int one = 0; one < inputs; one++) {  // what presses against the box stays
            const bool pressed = (at[one] <= low.data()[one] && gradient[one] >= 0.0) || (at[one] >= high.data()[one] && gradient[one] <= 0.0);
            free[one] = pressed ? 0.0 : 1.0;
            freest = std::max(freest, free[one] * gradient[one] * gradient[one]);
        }
        if (freest <= FLAT * largest * std::max(left, FLAT)) break;
        bool better = false;
        double moved = 0.0, gained = 0.0;
        for (int attempt = 0; attempt < TRIES && !better; attempt++) {
            const std::vector<double> change = damped(normal, gradient, free, damping, largest);
            moved = 0.0;
            for (Int one = 0; one < inputs; one++) {
                trial[one] = std::min(std::max(at[one] + change[one], low.data()[one]), high.data()[one]);
                moved = std::max(moved, std::abs(trial[one] - at[one]));
            }
            all.mean(trial.data(), value.data(), nullptr);
            const double found = squares();
            if (found < left) {
                better = true, damping = std::max(0.1 * damping, 1e-9), gained = left - found, left = found;
                std::copy(trial.begin(), trial.end(), at);
            } else damping *= 8.0;
        }
        if (!better || moved < STEP || gained < GAIN * left) break;
    }
    return left;
}

}  // namespace

void add_perceptrons(nb::module_& module) {
    module.def("network_values", &network_values, given(), given(), given(), filled());
    module.def("network_agreement", &network_agreement, given(), given(), given(), filled(), filled());
    module.def("network_mean", &network_mean, given(), given(), given(), filled(), filled());
    module.def("network_descent", &network_descent, given(), given(), filled(), given(), given(), given(), given(), given());
}
