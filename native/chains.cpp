// Slips along cables with capstan friction: the loops of mechanics/chain_law.py, where they are explained.
#include <cmath>
#include <vector>

#include "arrays.hpp"
#include "spring.hpp"

namespace {

using Int = int64_t;
constexpr int RELAXATIONS = 500;  // most steps towards the slips of a cable; it takes about five, one more a taut span
constexpr int HALVINGS = 60;
constexpr double NOISE = 1e-15;  // an elongation is known to this fraction of the lengths that it is the sum of

// The spans of one cable, from `start` to `end`.
struct Chain {
    Int start, end;
    const double *elongation, *stiffness, *smoothing, *limits;
    double *tension, *tangent, *force, *step, *sign, *work;

    // Tensions and tangents of the spans; the energy.
    double tighten(const double* slips) const {
        double energy = 0.0;
        for (Int span = start; span < end; span++) {
            double own = elongation[span];
            if (span > start) own += slips[span], energy += limits[span] * std::abs(slips[span]);
            if (span + 1 < end) own -= slips[span + 1];
            const Spring found = spring(stiffness[span], smoothing[span], own);
            tension[span] = found.tension, tangent[span] = found.slope;
            energy += found.energy;
        }
        return energy;
    }

    // Forces on the slips that are free, and which way each goes; whether they are balanced.
    bool balanced(const double* slips) const {
        double worst = 0.0, noise = 0.0;
        for (Int span = start; span < end; span++) {
            const double lengths = std::abs(elongation[span]) + std::abs(slips[span]) + smoothing[span];
            noise = std::fmax(noise, NOISE * stiffness[span] * lengths);
        }
        for (Int span = start + 1; span < end; span++) {
            const double drop = tension[span - 1] - tension[span];
            sign[span] = slips[span] != 0.0 ? std::copysign(1.0, slips[span])
                         : std::abs(drop) > limits[span] ? std::copysign(1.0, drop) : 0.0;
            force[span] = sign[span] != 0.0 ? drop - sign[span] * limits[span] : 0.0;
            worst = std::fmax(worst, std::abs(force[span]));
        }
        return worst <= noise;
    }

    // Newton's step of the slips that are free: a tridiagonal system, by elimination.
    void solve() const {
        double before = 0.0;
        for (Int span = start + 1; span < end; span++) {
            if (sign[span] == 0.0) {
                step[span] = before = work[span] = 0.0;
                continue;
            }
            double pivot = tangent[span - 1] + tangent[span] + 1e-6 * stiffness[span], right = force[span];
            if (before > 0.0) {
                const double ratio = tangent[span - 1] / before;
                pivot -= ratio * tangent[span - 1];
                right += ratio * step[span - 1];
            }
            step[span] = right, before = work[span] = pivot;
        }
        for (Int span = end - 1; span > start; span--) {
            if (sign[span] == 0.0) continue;
            double right = step[span];
            if (span + 1 < end) right += tangent[span] * step[span + 1];
            step[span] = right / work[span];
        }
    }

    // The step, in which a slip that would turn back at once stays where it is.
    void find_step(const double* slips) const {
        for (bool held = true; held;) {
            held = false;
            solve();
            for (Int span = start + 1; span < end; span++)
                if (sign[span] != 0.0 && slips[span] == 0.0 && step[span] * sign[span] < 0.0)
                    sign[span] = force[span] = 0.0, held = true;
        }
    }

    void relax(double* slips, double* trial) const {
        double energy = tighten(slips);
        for (int round = 0; round < RELAXATIONS && !balanced(slips); round++) {
            find_step(slips);
            double length = 1.0, reached = 0.0;
            int halving = 0;
            for (; halving < HALVINGS; halving++, length *= 0.5) {
                double gain = 0.0;
                for (Int span = start + 1; span < end; span++) {
                    const double moved = slips[span] + length * step[span];
                    trial[span] = moved * sign[span] > 0.0 ? moved : 0.0;
                    gain += force[span] * (trial[span] - slips[span]);
                }
                reached = tighten(trial);
                if (reached <= energy - 1e-4 * gain + 1e-15 * std::abs(energy)) break;
            }
            if (halving == HALVINGS) return;
            double change = 0.0;
            for (Int span = start + 1; span < end; span++) {
                change = std::fmax(change, std::abs(trial[span] - slips[span]));
                slips[span] = trial[span];
            }
            energy = reached;
            if (change == 0.0) return;
        }
    }
};

// Slips of least energy, by Newton's method on those that are free to slip; 0 is a bound for each.
void relax_chains(Reals<1> elongation, Reals<1> stiffness, Reals<1> smoothing, Reals<1> limits, Counts<1> starts,
                  Array<double, 1> slips) {
    const Int count = (Int)elongation.shape(0), ends = (Int)starts.shape(0);
    demand((Int)stiffness.shape(0) == count && (Int)smoothing.shape(0) == count && (Int)limits.shape(0) == count &&
               (Int)slips.shape(0) == count, "as many spans of each");
    for (Int chain = 0; chain + 1 < ends; chain++)
        demand(starts.data()[chain] >= 0 && starts.data()[chain] <= starts.data()[chain + 1] &&
                   starts.data()[chain + 1] <= count, "a cable has no such span");
    std::vector<double> room(7 * count);
    double* at[7];
    for (int each = 0; each < 7; each++) at[each] = room.data() + each * count;
    Free others(2e3 * (double)count);
    for (Int chain = 0; chain + 1 < ends; chain++) {
        const Int start = starts.data()[chain], end = starts.data()[chain + 1];
        if (end - start < 2) continue;
        const Chain spans{start, end, elongation.data(), stiffness.data(), smoothing.data(), limits.data(),
                          at[0], at[1], at[2], at[3], at[4], at[5]};
        spans.relax(slips.data(), at[6]);
    }
}

}  // namespace

void add_chains(nb::module_& module) {
    module.def("relax_chains", &relax_chains, given(), given(), given(), given(), given(), filled());
}
