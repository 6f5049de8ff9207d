// The elastic energy of quadratic simplices, as many at a time as a vector has lanes. Formulas: quadratic_solid.py.
#pragma once
#include "elements.hpp"

namespace {

// Corners and middles of edges, and points of quadrature.
template <int D> struct Quadratic {
    static constexpr int C = (D + 1) * (D + 2) / 2, Q = D + 1;
    const int32_t* nodes;
    const double *gradients, *offsets;
    int count;
    Lanes weights[Q], volume, mu, lame, mean;  // `lame` counts at each point, `mean` for the volume of the element

    Quadratic(const Quadratics& all, int64_t first)
        : nodes(all.stencils + first / PACK * C * PACK + first % PACK),
          gradients(all.gradients + first / PACK * Q * C * D * PACK + first % PACK),
          offsets(all.offsets ? all.offsets + first / PACK * Q * D * D * PACK + first % PACK : nullptr),
          count(all.terms - first < LANES ? (int)(all.terms - first) : LANES), volume{},
          mu(load<Lanes>(all.moduli + first)), lame(load<Lanes>(all.moduli + all.groups * PACK + first)),
          mean(load<Lanes>(all.moduli + 2 * all.groups * PACK + first)) {
        for (int q = 0; q < Q; q++) {
            weights[q] = load<Lanes>(all.weights + first / PACK * Q * PACK + q * PACK + first % PACK);
            volume += weights[q];
        }
        volume = where(volume > Lanes{}, volume, ::all(1.0));  // of lanes that are filled up
    }

    INLINE Lanes slope(int point, int corner, int axis) const {
        return load<Lanes>(gradients + ((point * C + corner) * D + axis) * PACK);
    }

    // F - I at each point; the shape gradients add up to 0, so corner 0 only gives the origin.
    INLINE void differentiate(const double* field, Lanes (&found)[Q][D][D]) const {
        Lanes origin[D], at[C][D];
        for (int i = 0; i < D; i++)
            for (int lane = 0; lane < LANES; lane++) origin[i][lane] = field[(int64_t)nodes[lane] * D + i];
        for (int corner = 1; corner < C; corner++)
            for (int i = 0; i < D; i++) {
                for (int lane = 0; lane < LANES; lane++)
                    at[corner][i][lane] = field[(int64_t)nodes[corner * PACK + lane] * D + i];
                at[corner][i] -= origin[i];
            }
        for (int q = 0; q < Q; q++)
            for (int i = 0; i < D; i++)
                for (int j = 0; j < D; j++) {
                    Lanes sum = offsets ? load<Lanes>(offsets + ((q * D + i) * D + j) * PACK) : Lanes{};
                    for (int corner = 1; corner < C; corner++) sum += at[corner][i] * slope(q, corner, j);
                    found[q][i][j] = sum;
                }
    }
};

// J - 1 of the element: the mean over its points.
template <int D> INLINE Lanes mean_change(const Quadratic<D>& element, const Lanes (&change)[D + 1]) {
    Lanes mean{};
    for (int q = 0; q <= D; q++) mean += element.weights[q] * change[q];
    return mean / element.volume;
}

template <int D, bool THIN> double quadratic_value(const Quadratics& all, const double* displacements) {
    Lanes total{};
    for (int64_t first = 0; first < all.terms; first += LANES) {
        const Quadratic<D> element(all, first);
        Lanes G[D + 1][D][D], change[D + 1];
        element.differentiate(displacements, G);
        for (int q = 0; q <= D; q++) {
            change[q] = change_of<D>(G[q]);
            if (any(~(change[q] > -1.0))) return __builtin_inf();
            Lanes stretch{};
            for (int i = 0; i < D; i++) {
                stretch += G[q][i][i];
                for (int j = 0; j < D; j++) stretch += 0.5 * G[q][i][j] * G[q][i][j];
            }
            const Squeeze found = squeeze<THIN>(change[q], element.mu, element.lame);
            total += element.weights[q] * (element.mu * (stretch - found.log_j) + found.energy);
        }
        Lanes log_mean = log1p(mean_change<D>(element, change));
        total += 0.5 * element.volume * element.mean * log_mean * log_mean;
    }
    return sum(total);
}

template <int D> double quadratic_least(const Quadratics& all, const double* displacements) {
    Lanes least_change{};
    for (int64_t first = 0; first < all.terms; first += LANES) {
        const Quadratic<D> element(all, first);
        Lanes G[D + 1][D][D];
        element.differentiate(displacements, G);
        for (int q = 0; q <= D; q++) least_change = least(least_change, change_of<D>(G[q]));
    }
    double found = 0.0;
    for (int lane = 0; lane < LANES; lane++) found = least_change[lane] < found ? least_change[lane] : found;
    return 1.0 + found;
}

template <int D, bool THIN> void quadratic_gradient(const Quadratics& all, const double* displacements, double* total) {
    constexpr int C = Quadratic<D>::C, Q = Quadratic<D>::Q;
    for (int64_t first = 0; first < all.terms; first += LANES) {
        const Quadratic<D> element(all, first);
        Lanes G[Q][D][D], T[Q][D][D], change[Q];
        element.differentiate(displacements, G);
        for (int q = 0; q < Q; q++) {
            change[q] = change_of<D>(G[q]);
            inverse_transposed<D>(G[q], 1.0 + change[q], T[q]);
        }
        Lanes mean = mean_change<D>(element, change), common = element.mean * log1p(mean) / (1.0 + mean);
        for (int q = 0; q < Q; q++) {
            Lanes pressure = squeeze<THIN>(change[q], element.mu, element.lame).pressure + common * (1.0 + change[q]);
            for (int i = 0; i < D; i++)
                for (int j = 0; j < D; j++) {
                    Lanes rest = i == j ? 1.0 - T[q][i][j] : -T[q][i][j];
                    T[q][i][j] = element.weights[q] * (element.mu * (G[q][i][j] + rest) + pressure * T[q][i][j]);
                }
        }
        Lanes origin[D] = {};
        for (int corner = C - 1; corner >= 0; corner--)
            for (int i = 0; i < D; i++) {
                Lanes force{};
                if (corner == 0) force = -origin[i];
                else {
                    for (int q = 0; q < Q; q++)
                        for (int j = 0; j < D; j++) force += T[q][i][j] * element.slope(q, corner, j);
                    origin[i] += force;
                }
                for (int lane = 0; lane < element.count; lane++)
                    total[(int64_t)element.nodes[corner * PACK + lane] * D + i] += force[lane];
            }
    }
}

template <int D, bool THIN> bool quadratic_hessian(const Quadratics& all, const double* displacements, double share, const Blocks& to) {
    constexpr int C = Quadratic<D>::C, Q = Quadratic<D>::Q;
    for (int64_t first = 0; first < all.terms; first += LANES) {
        const Quadratic<D> element(all, first);
        const int64_t* slots = to.slots + first * C * C;
        if (!is_inside<D, C>(element.nodes, element.count, slots, to)) return false;
        Lanes G[Q][D][D], T[D][D], change[Q], spatial[Q][C][D], push[C][D] = {};
        element.differentiate(displacements, G);
        for (int q = 0; q < Q; q++) {
            change[q] = change_of<D>(G[q]);
            Lanes J = 1.0 + change[q];
            inverse_transposed<D>(G[q], J, T);
            for (int corner = 0; corner < C; corner++)
                for (int i = 0; i < D; i++) {
                    Lanes along{};
                    for (int j = 0; j < D; j++) along += T[i][j] * element.slope(q, corner, j);
                    spatial[q][corner][i] = along;
                    push[corner][i] += element.weights[q] * J * along;
                }
        }
        // The mean: V lambda ((1 - ln J) / J^2 dJ dJ^T + ln J / J d2J), where push = V dJ.
        const Lanes zero{}, mean = mean_change<D>(element, change), J_mean = 1.0 + mean, log_mean = log1p(mean);
        Lanes square = element.mean * (1.0 - log_mean) / (J_mean * J_mean * element.volume);
        square -= share * least(square, zero);
        Lanes straight[Q], crossed[Q], plain[Q], along[Q];
        Negative<D> negative[Q];
        Lanes local[Q][C][D];
        for (int q = 0; q < Q; q++) {
            const Lanes J = 1.0 + change[q];
            const Squeeze squeezed = squeeze<THIN>(change[q], element.mu, element.lame);
            const Lanes bend = element.mean * log_mean / J_mean * element.weights[q] * J;
            const Lanes over = where(bend > zero, bend, zero), under = bend - over;
            straight[q] = element.weights[q] * squeezed.tangent + bend -
                          share * (over * (1.0 / D) + under * (1.0 - 1.0 / D));
            crossed[q] = element.weights[q] * (element.mu - squeezed.pressure) - bend + 0.5 * share * bend;
            plain[q] = 0.5 * share * absolute(bend);
            along[q] = element.weights[q] * element.mu;
            if (share > 0.0) {
                negative[q] = Negative<D>(G[q], element.mu, squeezed.pressure, squeezed.tangent);
                if (negative[q].some)
                    for (int corner = 0; corner < C; corner++)
                        for (int k = 0; k < D; k++) {
                            local[q][corner][k] = Lanes{};
                            for (int j = 0; j < D; j++)
                                local[q][corner][k] += element.slope(q, corner, j) * negative[q].V[j][k];
                        }
            }
        }
        for (int a = 0; a < C; a++)
            for (int b = 0; b <= a; b++) {
                Lanes block[D][D];
                for (int i = 0; i < D; i++)
                    for (int j = 0; j < D; j++) block[i][j] = square * push[a][i] * push[b][j];
                for (int q = 0; q < Q; q++) {
                    Lanes rest{}, now{};
                    for (int i = 0; i < D; i++) {
                        rest += element.slope(q, a, i) * element.slope(q, b, i);
                        now += spatial[q][a][i] * spatial[q][b][i];
                    }
                    const Lanes diagonal = along[q] * rest + plain[q] * now;
                    for (int i = 0; i < D; i++) {
                        block[i][i] += diagonal;
                        const Lanes one = straight[q] * spatial[q][a][i], two = crossed[q] * spatial[q][b][i];
                        for (int j = 0; j < D; j++) block[i][j] += one * spatial[q][b][j] + two * spatial[q][a][j];
                    }
                    if (negative[q].some) {
                        Lanes found[D][D];
                        negative[q].block(local[q][a], local[q][b], found);
                        for (int i = 0; i < D; i++)
                            for (int j = 0; j < D; j++) block[i][j] -= share * element.weights[q] * found[i][j];
                    }
                }
                for (int lane = 0; lane < element.count; lane++) {
                    const int64_t* slot = slots + lane * C * C;
                    const int64_t stride = to.strides[element.nodes[a * PACK + lane]];
                    const int64_t other = to.strides[element.nodes[b * PACK + lane]];
                    double* here = to.data + slot[a * C + b];
                    for (int j = 0; j < D; j++)
                        for (int i = 0; i < D; i++) here[j * other + i] += block[i][j][lane];
                    if (a == b) continue;
                    double* across = to.data + slot[b * C + a];
                    for (int i = 0; i < D; i++)
                        for (int j = 0; j < D; j++) across[i * stride + j] += block[i][j][lane];
                }
            }
    }
    return true;
}

}  // namespace
