// The elastic energy of simplices, as many at a time as a vector has lanes. Formulas: neo_hookean.py and warp.py.
#pragma once
#include "kernels.hpp"
#include "vectors.hpp"

namespace {

constexpr int PACK = 8;  // elements whose numbers lie side by side in memory, at every level

// LANES elements, `first` and those after it.
template <int D> struct Group {
    static constexpr int C = D + 1;
    const int32_t* nodes;  // corner by corner, PACK apart
    const double* gradients;
    Lanes volume;
    int count;  // elements in it; the others are filled up

    Group(const Elements& all, int64_t first)
        : nodes(all.stencils + first / PACK * C * PACK + first % PACK),
          gradients(all.gradients + first / PACK * C * D * PACK + first % PACK),
          volume(load<Lanes>(all.volumes + first)), count(all.terms - first < LANES ? (int)(all.terms - first) : LANES) {}

    INLINE Lanes slope(int corner, int axis) const { return load<Lanes>(gradients + (corner * D + axis) * PACK); }

    // Sum of field x shape gradient; the gradients of a simplex add up to 0, so corner 0 only gives the origin.
    INLINE void differentiate(const double* field, Lanes (&found)[D][D]) const {
        Lanes origin[D], at;
        for (int i = 0; i < D; i++) {
            for (int lane = 0; lane < LANES; lane++) origin[i][lane] = field[(int64_t)nodes[lane] * D + i];
            for (int j = 0; j < D; j++) found[i][j] = Lanes{};
        }
        for (int corner = 1; corner < C; corner++)
            for (int i = 0; i < D; i++) {
                for (int lane = 0; lane < LANES; lane++) at[lane] = field[(int64_t)nodes[corner * PACK + lane] * D + i];
                at -= origin[i];
                for (int j = 0; j < D; j++) found[i][j] += at * slope(corner, j);
            }
    }
};

// J - 1 without cancellation.
template <int D> INLINE Lanes change_of(const Lanes (&G)[D][D]) {
    if constexpr (D == 2) return G[0][0] + G[1][1] + (G[0][0] * G[1][1] - G[0][1] * G[1][0]);
    else {
        Lanes a = G[1][1] * G[2][2] - G[1][2] * G[2][1], b = G[1][0] * G[2][2] - G[1][2] * G[2][0],
           c = G[1][0] * G[2][1] - G[1][1] * G[2][0];
        Lanes minors = (G[0][0] * G[1][1] - G[0][1] * G[1][0]) + (G[0][0] * G[2][2] - G[0][2] * G[2][0]) + a;
        return G[0][0] + G[1][1] + G[2][2] + minors + (G[0][0] * a - G[0][1] * b + G[0][2] * c);
    }
}

// F^-T, with F = I + G and J = det F.
template <int D> INLINE void inverse_transposed(const Lanes (&G)[D][D], Lanes J, Lanes (&found)[D][D]) {
    Lanes scale = 1.0 / J;
    if constexpr (D == 2) {
        found[0][0] = (1.0 + G[1][1]) * scale, found[0][1] = -G[1][0] * scale;
        found[1][0] = -G[0][1] * scale, found[1][1] = (1.0 + G[0][0]) * scale;
    } else {
        Lanes F[3][3];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) F[i][j] = i == j ? 1.0 + G[i][j] : G[i][j];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
                found[i][j] = (F[p][r] * F[q][s] - F[p][s] * F[q][r]) * scale;
            }
    }
}

// Resistance to a change of volume, and its derivatives by ln J.
struct Squeeze {
    Lanes log_j, energy, pressure, tangent;
};

// At J - 1; in plane stress the least over the stretch across, whose square less 1 is w: plane_stress.py.
template <bool THIN> INLINE Squeeze squeeze(Lanes change, Lanes mu, Lanes lame) {
    const Lanes log_j = log1p(change);
    if constexpr (!THIN) return {log_j, 0.5 * lame * log_j * log_j, lame * log_j, lame};
    else {
        const Lanes zero{}, J = 1.0 + change, low = all(-1.0 + 1e-15);  // from J = 3e7 on w is -1 but for rounding
        Lanes w = where(change > zero, -change * (2.0 + change) / (J * J), zero);
        w = where(w > low, w, low);
        Lanes log = log1p(w);
        for (int step = 0; step < 60; step++) {
            const Lanes steep = mu + 0.5 * lame / (1.0 + w);
            const Lanes move = (mu * w + lame * (log_j + 0.5 * log)) / where(steep > zero, steep, all(1.0));
            w = where(w - move > low, w - move, low), log = log1p(w);
            if (!any(absolute(move) > 1e-15 * (1.0 + absolute(w)))) break;
        }
        const Lanes stretched = log_j + 0.5 * log, twice = 2.0 * (1.0 + w) * mu, both = twice + lame;
        return {log_j, 0.5 * mu * (w - log) + 0.5 * lame * stretched * stretched, -mu * w,
                twice * lame / where(both > zero, both, all(1.0))};
    }
}

template <int D, bool THIN> double value(const Elements& all, const double* displacements) {
    Lanes total{};
    for (int64_t element = 0; element < all.terms; element += LANES) {
        Group<D> group(all, element);
        Lanes G[D][D];
        group.differentiate(displacements, G);
        Lanes change = change_of<D>(G);
        if (any(~(change > -1.0))) return __builtin_inf();
        Lanes stretch{};
        for (int i = 0; i < D; i++) {
            stretch += G[i][i];
            for (int j = 0; j < D; j++) stretch += 0.5 * G[i][j] * G[i][j];
        }
        Lanes mu = load<Lanes>(all.mu + element);
        const Squeeze found = squeeze<THIN>(change, mu, load<Lanes>(all.lame + element));
        total += group.volume * (mu * (stretch - found.log_j) + found.energy);
    }
    return sum(total);
}

// P grad N of each element, with P = mu (F - F^-T) + lambda ln J F^-T = mu (G + (I - F^-T)) + ...
template <int D, bool THIN> void gradient(const Elements& all, const double* displacements, double* total) {
    constexpr int C = D + 1;
    for (int64_t element = 0; element < all.terms; element += LANES) {
        Group<D> group(all, element);
        Lanes G[D][D], T[D][D], forces[C][D];
        group.differentiate(displacements, G);
        Lanes change = change_of<D>(G);
        inverse_transposed<D>(G, 1.0 + change, T);
        Lanes mu = load<Lanes>(all.mu + element);
        const Lanes pressure = squeeze<THIN>(change, mu, load<Lanes>(all.lame + element)).pressure;
        for (int i = 0; i < D; i++)  // P = mu (G + I - F^-T) + pressure F^-T
            for (int j = 0; j < D; j++) {
                Lanes rest = i == j ? 1.0 - T[i][j] : -T[i][j];
                T[i][j] = group.volume * (mu * (G[i][j] + rest) + pressure * T[i][j]);
            }
        for (int i = 0; i < D; i++) forces[0][i] = Lanes{};
        for (int corner = 1; corner < C; corner++)
            for (int i = 0; i < D; i++) {
                Lanes force{};
                for (int j = 0; j < D; j++) force += T[i][j] * group.slope(corner, j);
                forces[corner][i] = force;
                forces[0][i] -= force;
            }
        for (int lane = 0; lane < group.count; lane++)
            for (int corner = 0; corner < C; corner++)
                for (int i = 0; i < D; i++)
                    total[(int64_t)group.nodes[corner * PACK + lane] * D + i] += forces[corner][i][lane];
    }
}

// Eigenvalues, on the diagonal of A, and eigenvectors, the columns of Q, by Jacobi's rotations.
template <int D> INLINE void eigen(Lanes (&A)[D][D], Lanes (&Q)[D][D]) {
    Lanes size{};
    for (int i = 0; i < D; i++) {
        size += absolute(A[i][i]);
        for (int j = 0; j < D; j++) Q[i][j] = all(i == j ? 1.0 : 0.0);
    }
    for (int sweep = 0; sweep < 12; sweep++) {
        Lanes off{};
        for (int p = 0; p < D; p++)
            for (int q = p + 1; q < D; q++) off += absolute(A[p][q]);
        if (!any(off > 1e-15 * size)) return;
        for (int p = 0; p < D - 1; p++)
            for (int q = p + 1; q < D; q++) {
                Bits none = A[p][q] == Lanes{};
                Lanes tilt = 0.5 * (A[q][q] - A[p][p]) / where(none, all(1.0), A[p][q]);
                Lanes t = 1.0 / (absolute(tilt) + root(tilt * tilt + 1.0));
                t = where(tilt < Lanes{}, -t, t);
                t = where(none, Lanes{}, t);
                Lanes c = 1.0 / root(t * t + 1.0), s = t * c, turn = t * A[p][q];
                A[p][p] -= turn, A[q][q] += turn;
                A[p][q] = A[q][p] = Lanes{};
                if constexpr (D == 3) {
                    int r = 3 - p - q;
                    Lanes x = A[r][p], y = A[r][q];
                    A[r][p] = A[p][r] = c * x - s * y;
                    A[r][q] = A[q][r] = s * x + c * y;
                }
                for (int i = 0; i < D; i++) {
                    Lanes x = Q[i][p], y = Q[i][q];
                    Q[i][p] = c * x - s * y;
                    Q[i][q] = s * x + c * y;
                }
            }
    }
}

// What is negative in the Hessian of Psi by F, in the axes of F = U diag(s) V^T (Smith, de Goes and Kim 2019):
// `stretch` for the stretches; for each pair of axes `even` on the product of equal places and `odd` across.
template <int D> struct Negative {
    Lanes U[D][D], V[D][D], stretch[D][D], even[D][D], odd[D][D];
    bool some = false;

    Negative() = default;
    INLINE Negative(const Lanes (&G)[D][D], Lanes mu, Lanes pressure, Lanes tangent) {
        Lanes F[D][D], squares[D][D], s[D];
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) F[i][j] = i == j ? 1.0 + G[i][j] : G[i][j];
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) {
                squares[i][j] = Lanes{};
                for (int k = 0; k < D; k++) squares[i][j] += F[k][i] * F[k][j];
            }
        eigen<D>(squares, V);
        for (int k = 0; k < D; k++) {
            s[k] = root(where(squares[k][k] > 1e-300, squares[k][k], all(1e-300)));
            for (int i = 0; i < D; i++) {
                Lanes along{};
                for (int j = 0; j < D; j++) along += F[i][j] * V[j][k];
                U[i][k] = along / s[k];
            }
        }
        Lanes pull = pressure - mu, zero{};
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) {
                Lanes product = 1.0 / (s[i] * s[j]);
                squares[i][j] = i == j ? mu + (tangent - pull) * product : tangent * product;
                if (i != j) {
                    // The twist and the flip of two axes: mu -+ (pressure - mu) / (s_i s_j).
                    Lanes plus = least(mu - pull * product, zero), minus = least(mu + pull * product, zero);
                    even[i][j] = 0.5 * (minus + plus);
                    odd[i][j] = 0.5 * (plus - minus);
                    some = some || any((plus < zero) | (minus < zero));
                }
            }
        Lanes Q[D][D];
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) stretch[i][j] = Lanes{};
        eigen<D>(squares, Q);
        for (int k = 0; k < D; k++) {
            Lanes below = least(squares[k][k], zero);
            if (!any(below < zero)) continue;
            some = true;
            for (int i = 0; i < D; i++)
                for (int j = 0; j < D; j++) stretch[i][j] += below * Q[i][k] * Q[j][k];
        }
    }

    // Its part of the block of two corners with shape gradients a and b, which are in the axes V.
    INLINE void block(const Lanes (&a)[D], const Lanes (&b)[D], Lanes (&found)[D][D]) const {
        Lanes inner[D][D], half[D][D];
        for (int i = 0; i < D; i++)
            for (int k = 0; k < D; k++) {
                inner[i][k] = stretch[i][k] * a[i] * b[k];
                if (i != k) inner[i][k] += odd[i][k] * a[k] * b[i];
                else
                    for (int j = 0; j < D; j++)
                        if (j != i) inner[i][i] += even[i][j] * a[j] * b[j];
            }
        for (int i = 0; i < D; i++)
            for (int k = 0; k < D; k++) {
                half[i][k] = Lanes{};
                for (int j = 0; j < D; j++) half[i][k] += U[i][j] * inner[j][k];
            }
        for (int i = 0; i < D; i++)
            for (int k = 0; k < D; k++) {
                found[i][k] = Lanes{};
                for (int j = 0; j < D; j++) found[i][k] += half[i][j] * U[k][j];
            }
    }
};

// Whether the blocks of a group lie within the matrix: first by the longest column, then, only where that leaves doubt,
// each by its own. The sign bit is set where a number is negative or above the last.
template <int D, int C> INLINE bool is_inside(const int32_t* nodes, int count, const int64_t* slot, const Blocks& to) {
    const int many = count * C * C;
    const int64_t last = to.size - (D - 1) * to.widest - D;
    Places unsure{};
    int at = 0;
    for (; at + LANES <= many; at += LANES) {
        Places some;
        __builtin_memcpy(&some, slot + at, sizeof(some));
        unsure |= some | ((uint64_t)last - some);
    }
    uint64_t left = 0;
    for (; at < many; at++) left |= (uint64_t)slot[at] | ((uint64_t)last - (uint64_t)slot[at]);
    if (!any((Bits)unsure < 0) && left >> 63 == 0) return true;
    for (int lane = 0; lane < count; lane++)
        for (int b = 0; b < C; b++) {
            const int64_t end = to.size - (D - 1) * to.strides[nodes[b * PACK + lane]] - D;
            for (int a = 0; a < C; a++)
                if (slot[(lane * C + a) * C + b] < 0 || slot[(lane * C + a) * C + b] > end) return false;
        }
    return true;
}

template <int D, bool THIN> bool hessian(const Elements& all, const double* displacements, double share, const Blocks& to) {
    constexpr int C = D + 1, PAIRS = C * (C + 1) / 2;
    for (int64_t element = 0; element < all.terms; element += LANES) {
        Group<D> group(all, element);
        Lanes G[D][D], T[D][D], spatial[C][D], blocks[PAIRS][D][D];
        group.differentiate(displacements, G);
        Lanes change = change_of<D>(G);
        inverse_transposed<D>(G, 1.0 + change, T);
        for (int corner = 0; corner < C; corner++)
            for (int i = 0; i < D; i++) {
                spatial[corner][i] = Lanes{};
                for (int j = 0; j < D; j++) spatial[corner][i] += T[i][j] * group.slope(corner, j);
            }
        Lanes mu = load<Lanes>(all.mu + element);
        const Squeeze squeezed = squeeze<THIN>(change, mu, load<Lanes>(all.lame + element));
        Lanes straight = group.volume * squeezed.tangent, crossed = group.volume * (mu - squeezed.pressure);
        for (int a = 0, pair = 0; a < C; a++)
            for (int b = 0; b <= a; b++, pair++) {
                Lanes along{};
                for (int i = 0; i < D; i++) along += group.slope(a, i) * group.slope(b, i);
                along *= group.volume * mu;
                for (int i = 0; i < D; i++)
                    for (int j = 0; j < D; j++) {
                        Lanes entry = straight * spatial[a][i] * spatial[b][j] + crossed * spatial[b][i] * spatial[a][j];
                        blocks[pair][i][j] = i == j ? entry + along : entry;
                    }
            }
        if (share > 0.0) {
            Negative<D> negative(G, mu, squeezed.pressure, squeezed.tangent);
            if (negative.some) {
                Lanes local[C][D], found[D][D];
                for (int corner = 0; corner < C; corner++)
                    for (int k = 0; k < D; k++) {
                        local[corner][k] = Lanes{};
                        for (int j = 0; j < D; j++) local[corner][k] += group.slope(corner, j) * negative.V[j][k];
                    }
                for (int a = 0, pair = 0; a < C; a++)
                    for (int b = 0; b <= a; b++, pair++) {
                        negative.block(local[a], local[b], found);
                        for (int i = 0; i < D; i++)
                            for (int j = 0; j < D; j++) blocks[pair][i][j] -= share * group.volume * found[i][j];
                    }
            }
        }
        if (!is_inside<D, C>(group.nodes, group.count, to.slots + element * C * C, to)) return false;
        for (int lane = 0; lane < group.count; lane++) {
            const int64_t* slot = to.slots + (element + lane) * C * C;
            for (int a = 0, pair = 0; a < C; a++) {
                int64_t stride = to.strides[group.nodes[a * PACK + lane]];
                for (int b = 0; b <= a; b++, pair++) {
                    double* here = to.data + slot[a * C + b];
                    int64_t other = to.strides[group.nodes[b * PACK + lane]];
                    for (int j = 0; j < D; j++)
                        for (int i = 0; i < D; i++) here[j * other + i] += blocks[pair][i][j][lane];
                    if (a == b) continue;
                    double* across = to.data + slot[b * C + a];
                    for (int i = 0; i < D; i++)
                        for (int j = 0; j < D; j++) across[i * stride + j] += blocks[pair][i][j][lane];
                }
            }
        }
    }
    return true;
}

// sin(t) / t - 1 and (1 - cos t) / t^2 from t^2, by their series where t is below 1, else by the library.
INLINE void arc(Lanes square, Lanes& first, Lanes& second) {
    if (!any(square > 1.0)) {
        Lanes x = square;
        first = -x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0 * (1.0 - x / 110.0 *
                (1.0 - x / 156.0 * (1.0 - x / 210.0 * (1.0 - x / 272.0)))))));
        second = 0.5 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0 * (1.0 - x / 90.0 *
                 (1.0 - x / 132.0 * (1.0 - x / 182.0 * (1.0 - x / 240.0)))))));
        return;
    }
    for (int lane = 0; lane < LANES; lane++) {
        double angle = __builtin_sqrt(square[lane]);
        bool tiny = angle < 1e-3;
        first[lane] = tiny ? -square[lane] / 6.0 : __builtin_sin(angle) / angle - 1.0;
        second[lane] = tiny ? 0.5 - square[lane] / 24.0 : (1.0 - __builtin_cos(angle)) / square[lane];
    }
}

// Sum of volume x (exp(W) (I + S) F - F - dF) grad N over the elements, where dF F^-1 = S + W.
//
// The difference is of second order; it is taken as ((exp W - I - W) + (exp W - I) S) F, so nothing cancels.
template <int D> void turn(const Elements& all, const double* nodes, const double* step, double* right) {
    constexpr int C = D + 1;
    for (int64_t element = 0; element < all.terms; element += LANES) {
        Group<D> group(all, element);
        Lanes F[D][D], A[D][D], T[D][D], G[D][D], S[D][D], bent[D][D];
        group.differentiate(nodes, F);
        group.differentiate(step, G);
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) T[i][j] = i == j ? F[i][j] - 1.0 : F[i][j];
        Lanes J = 1.0 + change_of<D>(T), inverse[D][D], first, second;
        inverse_transposed<D>(T, J, inverse);
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) {
                A[i][j] = Lanes{};
                for (int k = 0; k < D; k++) A[i][j] += G[i][k] * inverse[j][k];
            }
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) S[i][j] = 0.5 * (A[i][j] + A[j][i]);
        // exp W - I - W, then (exp W - I) S is added
        if constexpr (D == 2) {
            Lanes z = 0.5 * (A[1][0] - A[0][1]);
            arc(z * z, first, second);
            Lanes across = z + first * z, along = -second * z * z;
            bent[0][0] = bent[1][1] = along;
            bent[0][1] = -first * z, bent[1][0] = first * z;
            for (int j = 0; j < 2; j++) {
                bent[0][j] += along * S[0][j] - across * S[1][j];
                bent[1][j] += across * S[0][j] + along * S[1][j];
            }
        } else {
            Lanes x = 0.5 * (A[2][1] - A[1][2]), y = 0.5 * (A[0][2] - A[2][0]), z = 0.5 * (A[1][0] - A[0][1]);
            arc(x * x + y * y + z * z, first, second);
            Lanes spin[3][3] = {{Lanes{}, -z, y}, {z, Lanes{}, -x}, {-y, x, Lanes{}}}, turned[3][3];
            Lanes xy = second * x * y, xz = second * x * z, yz = second * y * z;
            Lanes more[3][3] = {{-second * (y * y + z * z), xy, xz},
                             {xy, -second * (x * x + z * z), yz},
                             {xz, yz, -second * (x * x + y * y)}};
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    bent[i][j] = first * spin[i][j] + more[i][j];
                    turned[i][j] = bent[i][j] + spin[i][j];
                }
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    for (int k = 0; k < 3; k++) bent[i][j] += turned[i][k] * S[k][j];
        }
        Lanes whole[D][D], parts[C][D];
        for (int i = 0; i < D; i++)
            for (int j = 0; j < D; j++) {
                whole[i][j] = Lanes{};
                for (int k = 0; k < D; k++) whole[i][j] += bent[i][k] * F[k][j];
                whole[i][j] *= group.volume;
            }
        for (int i = 0; i < D; i++) parts[0][i] = Lanes{};
        for (int corner = 1; corner < C; corner++)
            for (int i = 0; i < D; i++) {
                Lanes part{};
                for (int j = 0; j < D; j++) part += whole[i][j] * group.slope(corner, j);
                parts[corner][i] = part;
                parts[0][i] -= part;
            }
        for (int lane = 0; lane < group.count; lane++)
            for (int corner = 0; corner < C; corner++)
                for (int i = 0; i < D; i++)
                    right[(int64_t)group.nodes[corner * PACK + lane] * D + i] += parts[corner][i][lane];
    }
}

}  // namespace
