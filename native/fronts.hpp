// The multifrontal factorisation A = L S L^T of mechanics/fronts.py, with products of its own in place of BLAS.
//
// Panels are column by column, their columns as high as the front. Vectors read past the end of a column, never past
// the end of an array, which must have 8 numbers to spare; what they write ends where the column does.
#pragma once
#include "kernels.hpp"
#include "vectors.hpp"

namespace {

enum { COLUMNS, BELOW, FIRST, PANEL, STARTS, CHILD, SIBLING, STACK, OFFSET, RUNS, ENTRIES, WIDTH };

// A tile of TALL vectors by BLOCK columns: its sums fill three quarters of the registers, 16 or (AVX-512) 32.
constexpr int TALL = 3, BLOCK = LANES == 8 ? 8 : 4;

template <int N> struct Count {
    static constexpr int value = N;
};

// Call with Count<count>, from 1 to BLOCK, so that loops over columns are unrolled.
template <int N = BLOCK, class Call> INLINE auto with_count(int count, const Call& call) {
    if constexpr (N > 1)
        if (count < N) return with_count<N - 1>(count, call);
    return call(Count<N>{});
}

// What a product does to the numbers that are there.
enum Into { SUBTRACT, REPLACE };

// C -= A B^T, or C = -A B^T, for a tile of HIGH vectors x COUNT columns; B is packed, BLOCK numbers a step of the depth.
template <Into INTO, int HIGH, int COUNT>
INLINE void tile(double* c, int64_t ldc, const double* a, int64_t lda, const double* b, int64_t depth, int rows) {
    Lanes sums[COUNT][HIGH];
UNROLL
    for (int j = 0; j < COUNT; j++)
UNROLL
        for (int i = 0; i < HIGH; i++) sums[j][i] = INTO == REPLACE ? Lanes{} : load<Lanes>(c + j * ldc + i * LANES);
    for (int64_t k = 0; k < depth; k++, a += lda, b += BLOCK) {
        Lanes left[HIGH];
UNROLL
        for (int i = 0; i < HIGH; i++) left[i] = load<Lanes>(a + i * LANES);
    UNROLL
    for (int j = 0; j < COUNT; j++)
    UNROLL
        for (int i = 0; i < HIGH; i++) sums[j][i] -= left[i] * b[j];
    }
UNROLL
    for (int j = 0; j < COUNT; j++)
UNROLL
        for (int i = 0; i < HIGH; i++) store_rows(c + j * ldc + i * LANES, sums[j][i], rows - i * LANES);
}

template <Into INTO, int COUNT>
void strip(double* c, int64_t ldc, const double* a, int64_t lda, const double* b, int64_t depth, int64_t rows) {
    int64_t row = 0;
    for (; row + TALL * LANES <= rows; row += TALL * LANES)
        tile<INTO, TALL, COUNT>(c + row, ldc, a + row, lda, b, depth, TALL * LANES);
    const int left = (int)(rows - row);
    if (left > 2 * LANES) tile<INTO, 3, COUNT>(c + row, ldc, a + row, lda, b, depth, left);
    else if (left > LANES) tile<INTO, 2, COUNT>(c + row, ldc, a + row, lda, b, depth, left);
    else if (left > 0) tile<INTO, 1, COUNT>(c + row, ldc, a + row, lda, b, depth, left);
}

template <Into INTO>
INLINE void any_strip(int count, double* c, int64_t ldc, const double* a, int64_t lda, const double* b, int64_t depth,
                      int64_t rows) {
    with_count(count, [&](auto known) { strip<INTO, known.value>(c, ldc, a, lda, b, depth, rows); });
}

// Rows of S P^T, BLOCK numbers for each step of the depth.
INLINE void pack(double* packed, const double* panel, int64_t height, const double* sign, int64_t depth, int count) {
    if (count == BLOCK)
        for (int64_t k = 0; k < depth; k++)
            for (int at = 0; at < BLOCK; at += LANES)
                store<Lanes>(packed + k * BLOCK + at, sign[k] * load<Lanes>(panel + k * height + at));
    else
        for (int64_t k = 0; k < depth; k++)
            for (int j = 0; j < count; j++) packed[k * BLOCK + j] = sign[k] * panel[k * height + j];
}

// C = -P S P^T below the diagonal, for some columns of C; P begins at the row of C's first column.
INLINE void multiply(double* c, int64_t ldc, const double* panel, int64_t height, int64_t depth, const double* sign,
                     int64_t columns, int64_t rows, double* packed) {
    for (int64_t column = 0; column < columns; column += BLOCK) {
        int count = columns - column < BLOCK ? (int)(columns - column) : BLOCK;
        pack(packed, panel + column, height, sign, depth, count);
        any_strip<REPLACE>(count, c + column * ldc + column, ldc, panel + column, height, packed, depth, rows - column);
    }
}

// Divide `MANY` vectors of rows by the triangle that COUNT columns make; `factors` is S L, row by row.
template <int COUNT, int MANY>
INLINE void divide(double* panel, int64_t height, const double* factors, const double* scale, int rows) {
    Lanes own[COUNT][MANY];
UNROLL
    for (int j = 0; j < COUNT; j++) {
UNROLL
        for (int v = 0; v < MANY; v++) own[j][v] = load<Lanes>(panel + j * height + v * LANES);
UNROLL
        for (int k = 0; k < j; k++)
    UNROLL
        for (int v = 0; v < MANY; v++) own[j][v] -= own[k][v] * factors[j * COUNT + k];
UNROLL
        for (int v = 0; v < MANY; v++) own[j][v] *= scale[j];
    }
UNROLL
    for (int j = 0; j < COUNT; j++)
UNROLL
        for (int v = 0; v < MANY; v++) store_rows(panel + j * height + v * LANES, own[j][v], rows - v * LANES);
}

// Eliminate COUNT columns of a panel, `rows` high from the first pivot on; how many pivots are negative, -1: too small.
template <int COUNT> int eliminate(double* panel, int64_t height, int64_t rows, double* sign, double least) {
    double L[COUNT][COUNT], scale[COUNT], factors[COUNT * COUNT];
    int negative = 0;
UNROLL
    for (int j = 0; j < COUNT; j++)
UNROLL
        for (int i = j; i < COUNT; i++) L[i][j] = panel[j * height + i];
UNROLL
    for (int j = 0; j < COUNT; j++) {
UNROLL
        for (int k = 0; k < j; k++)
    UNROLL
        for (int i = j; i < COUNT; i++) L[i][j] -= L[i][k] * factors[j * COUNT + k];
        double pivot = L[j][j], size = pivot < 0 ? -pivot : pivot;
        if (!(size > least && size < __builtin_inf())) return -1;
        sign[j] = pivot > 0 ? 1.0 : -1.0;
        negative += pivot < 0;
        L[j][j] = __builtin_sqrt(size);
        scale[j] = sign[j] / L[j][j];
UNROLL
        for (int i = j + 1; i < COUNT; i++) L[i][j] *= scale[j], factors[i * COUNT + j] = sign[j] * L[i][j];
    }
    int64_t row = COUNT;
    for (; row + 2 * LANES <= rows; row += 2 * LANES)
        divide<COUNT, 2>(panel + row, height, factors, scale, 2 * LANES);
    for (; row < rows; row += LANES)
        divide<COUNT, 1>(panel + row, height, factors, scale, (int)(rows - row));
    for (int j = 0; j < COUNT; j++)
        for (int i = j; i < COUNT; i++) panel[j * height + i] = L[i][j];
    return negative;
}

INLINE int any_eliminate(int count, double* panel, int64_t height, int64_t rows, double* sign, double least) {
    return with_count(count, [&](auto known) { return eliminate<known.value>(panel, height, rows, sign, least); });
}

// C += A for blocks of HIGH rows.
template <int HIGH>
INLINE void add_rows(double* __restrict to, int64_t ldt, const double* __restrict from, int64_t ldf, int64_t columns) {
    for (; columns > 0; columns--, to += ldt, from += ldf)
        for (int i = 0; i < HIGH; i++) to[i] += from[i];
}

INLINE void add_block(double* to, int64_t ldt, const double* from, int64_t ldf, int64_t columns, int64_t rows) {
    for (; rows >= 8; rows -= 8, to += 8, from += 8) add_rows<8>(to, ldt, from, ldf, columns);
    switch (rows) {
        case 1: return add_rows<1>(to, ldt, from, ldf, columns);
        case 2: return add_rows<2>(to, ldt, from, ldf, columns);
        case 3: return add_rows<3>(to, ldt, from, ldf, columns);
        case 4: return add_rows<4>(to, ldt, from, ldf, columns);
        case 5: return add_rows<5>(to, ldt, from, ldf, columns);
        case 6: return add_rows<6>(to, ldt, from, ldf, columns);
        case 7: return add_rows<7>(to, ldt, from, ldf, columns);
    }
}

// First run of a child's rows beyond its parent's own columns; no run lies half in them.
INLINE int64_t first_beyond(const Fronts& fronts, int64_t child, int64_t columns) {
    const int64_t* row = fronts.table + child * WIDTH;
    int64_t run = row[RUNS];
    while (run < row[WIDTH + RUNS] && fronts.runs[run * 3 + 1] < columns) run++;
    return run;
}

// Add the columns `begin` to `end`, as runs, of what a child hands up to its parent's panel (`shift` 0) or update
// (`shift` is the parent's number of columns); lower triangle only, block by block of rows that lie together.
INLINE void extend_add(const Fronts& fronts, int64_t child, const double* stack, int64_t begin, int64_t end,
                       double* to, int64_t lead, int64_t shift) {
    const int64_t* row = fronts.table + child * WIDTH;
    const int64_t size = row[BELOW], high = row[WIDTH + RUNS];
    const double* given = stack + row[OFFSET];
    for (int64_t run = begin; run < end; run++) {
        const int64_t* piece = fronts.runs + run * 3;
        double* target = to + (piece[1] - shift) * lead - shift;
        const double* source = given + piece[0] * size;
        for (int64_t step = 0; step < piece[2]; step++)
            for (int64_t i = step; i < piece[2]; i++) target[step * lead + piece[1] + i] += source[step * size + piece[0] + i];
        for (const int64_t* other = piece + 3; other < fronts.runs + high * 3; other += 3)
            add_block(target + other[1], lead, source + other[0], size, piece[2], other[2]);
    }
}

// Largest entry of the diagonal; not finite if one of them is not.
INLINE double largest_diagonal(const Fronts& fronts, const double* data) {
    double largest = 0.0;
    for (int64_t dof = 0; dof < fronts.dofs; dof++)
        if (fronts.diagonal[dof] >= 0) {
            double size = data[fronts.diagonal[dof]];
            size = size < 0 ? -size : size;
            if (!(size <= largest)) largest = size;
        }
    return largest;
}

// Factorise one front, to whose stack `theirs` its children have handed up; how many pivots are negative, -1: too small.
INLINE int64_t factorise_front(const Fronts& fronts, int64_t which, const double* data, double* lower, double* signs,
                               const double* theirs, double* update, double* spare, double least) {
    const int64_t* row = fronts.table + which * WIDTH;
    const int64_t columns = row[COLUMNS], below = row[BELOW], height = columns + below;
    double* panel = lower + row[PANEL];
    __builtin_memset(panel, 0, columns * height * sizeof(double));
    for (int64_t entry = row[ENTRIES]; entry < row[WIDTH + ENTRIES]; entry++)
        panel[fronts.entries[2 * entry + 1]] = data[fronts.entries[2 * entry]];
    for (int64_t child = row[CHILD]; child >= 0; child = fronts.table[child * WIDTH + SIBLING])
        extend_add(fronts, child, theirs, fronts.table[child * WIDTH + RUNS], first_beyond(fronts, child, columns), panel, height, 0);
    double* sign = signs + row[FIRST];
    int64_t negative = 0;
    for (int64_t low = 0; low < columns; low += BLOCK) {
        int count = columns - low < BLOCK ? (int)(columns - low) : BLOCK;
        double* corner = panel + low * height + low;
        if (low) {
            pack(spare, panel + low, height, sign, low, count);
            any_strip<SUBTRACT>(count, corner, height, panel + low, height, spare, low, height - low);
        }
        int found = any_eliminate(count, corner, height, height - low, sign + low, least);
        if (found < 0) return -1;
        negative += found;
    }
    if (!below) return negative;
    multiply(update, below, panel + columns, height, columns, sign, below, below, spare);
    for (int64_t child = row[CHILD]; child >= 0; child = fronts.table[child * WIDTH + SIBLING])
        extend_add(fronts, child, theirs, first_beyond(fronts, child, columns), fronts.table[(child + 1) * WIDTH + RUNS],
                   update, below, columns);
    return negative;
}

int64_t factorise(const Fronts& fronts, const double* data, double* lower, double* signs, double* first,
                  double* second, double* spare, double tiny) {
    double largest = largest_diagonal(fronts, data);
    if (!(largest < __builtin_inf())) return -1;
    int64_t negative = 0;
    for (int64_t which = 0; which < fronts.count; which++) {
        const int64_t* row = fronts.table + which * WIDTH;
        double* mine = row[STACK] ? second : first;
        double* theirs = row[STACK] ? first : second;
        int64_t found = factorise_front(fronts, which, data, lower, signs, theirs, mine + row[OFFSET], spare, tiny * largest);
        if (found < 0) return -1;
        negative += found;
    }
    return negative;
}

// Whether numbers are all 0: right-hand sides of few places leave most fronts as they are.
INLINE bool all_zero(const double* numbers, int64_t count) {
    for (int64_t at = 0; at < count; at++)
        if (numbers[at] != 0.0) return false;
    return true;
}

// Rows of right-hand sides at a time, so that their sums stay in registers.
template <int VECTORS> constexpr int tile_of = VECTORS > 4 ? 1 : VECTORS > 3 ? 2 : 4;

// Right-hand sides row by row, VECTORS vectors T a row; `work` holds as many rows as the highest front has.
template <class T, int VECTORS> void forward(const Fronts& fronts, const double* lower, double* values, double* work) {
    constexpr int W = width_of<T>, ROW = VECTORS * W, TILE = tile_of<VECTORS>;
    for (int64_t which = 0; which < fronts.count; which++) {
        const int64_t* row = fronts.table + which * WIDTH;
        const int64_t columns = row[COLUMNS], below = row[BELOW], height = columns + below;
        const double* panel = lower + row[PANEL];
        const int64_t* rows = fronts.rows + row[STARTS];
        double* own = values + row[FIRST] * ROW;
        if (all_zero(own, columns * ROW)) continue;
        for (int64_t column = 0; column < columns; column++) {
            T sums[VECTORS];
            for (int v = 0; v < VECTORS; v++) sums[v] = load<T>(own + column * ROW + v * W);
            for (int64_t k = 0; k < column; k++) {
                double factor = panel[k * height + column];
                for (int v = 0; v < VECTORS; v++) sums[v] -= factor * load<T>(own + k * ROW + v * W);
            }
            double scale = 1.0 / panel[column * height + column];
            for (int v = 0; v < VECTORS; v++) store<T>(own + column * ROW + v * W, sums[v] * scale);
        }
        int64_t at = 0;
        for (; at + TILE <= below; at += TILE) {
            T sums[TILE][VECTORS] = {};
            const double* factors = panel + columns + at;
            for (int64_t k = 0; k < columns; k++, factors += height)
                for (int v = 0; v < VECTORS; v++) {
                    T value = load<T>(own + k * ROW + v * W);
                    for (int i = 0; i < TILE; i++) sums[i][v] += factors[i] * value;
                }
            for (int i = 0; i < TILE; i++)
                for (int v = 0; v < VECTORS; v++) {
                    double* to = values + rows[at + i] * ROW + v * W;
                    store<T>(to, load<T>(to) - sums[i][v]);
                }
        }
        for (; at < below; at++)
            for (int v = 0; v < VECTORS; v++) {
                double* to = values + rows[at] * ROW + v * W;
                T total = load<T>(to);
                for (int64_t k = 0; k < columns; k++)
                    total -= panel[k * height + columns + at] * load<T>(own + k * ROW + v * W);
                store<T>(to, total);
            }
    }
}

template <class T, int VECTORS> void backward(const Fronts& fronts, const double* lower, double* values, double* work) {
    constexpr int W = width_of<T>, ROW = VECTORS * W, TILE = tile_of<VECTORS>;
    for (int64_t which = fronts.count - 1; which >= 0; which--) {
        const int64_t* row = fronts.table + which * WIDTH;
        const int64_t columns = row[COLUMNS], below = row[BELOW], height = columns + below;
        const double* panel = lower + row[PANEL];
        const int64_t* rows = fronts.rows + row[STARTS];
        double* own = values + row[FIRST] * ROW;
        for (int64_t i = 0; i < below; i++)
            for (int v = 0; v < VECTORS; v++)
                store<T>(work + i * ROW + v * W, load<T>(values + rows[i] * ROW + v * W));
        int64_t high = columns;
        while (high > 0) {
            int64_t low = high >= TILE ? high - TILE : 0;
            int count = (int)(high - low);
            T sums[TILE][VECTORS] = {};
            if (count == TILE)
                for (int64_t i = 0; i < below; i++)
                    for (int v = 0; v < VECTORS; v++) {
                        T value = load<T>(work + i * ROW + v * W);
                        for (int j = 0; j < TILE; j++) sums[j][v] += panel[(low + j) * height + columns + i] * value;
                    }
            else
                for (int64_t i = 0; i < below; i++)
                    for (int v = 0; v < VECTORS; v++) {
                        T value = load<T>(work + i * ROW + v * W);
                        for (int j = 0; j < count; j++) sums[j][v] += panel[(low + j) * height + columns + i] * value;
                    }
            for (int64_t i = high; i < columns; i++)
                for (int v = 0; v < VECTORS; v++) {
                    T value = load<T>(own + i * ROW + v * W);
                    for (int j = 0; j < count; j++) sums[j][v] += panel[(low + j) * height + i] * value;
                }
            for (int j = count - 1; j >= 0; j--)
                for (int v = 0; v < VECTORS; v++) {
                    T value = load<T>(own + (low + j) * ROW + v * W) - sums[j][v];
                    for (int i = j + 1; i < count; i++)
                        value -= panel[(low + j) * height + low + i] * load<T>(own + (low + i) * ROW + v * W);
                    store<T>(own + (low + j) * ROW + v * W, value / panel[(low + j) * height + low + j]);
                }
            high = low;
        }
    }
}

// One right-hand side: along the columns of the panels, four at a time.
void forward_one(const Fronts& fronts, const double* lower, double* values, double* work) {
    for (int64_t which = 0; which < fronts.count; which++) {
        const int64_t* row = fronts.table + which * WIDTH;
        const int64_t columns = row[COLUMNS], below = row[BELOW], height = columns + below;
        const double* panel = lower + row[PANEL];
        const int64_t* rows = fronts.rows + row[STARTS];
        double* own = values + row[FIRST];
        for (int64_t i = 0; i < columns; i++) work[i] = own[i];
        for (int64_t i = columns; i < height; i++) work[i] = 0.0;
        for (int64_t low = 0; low < columns; low += 4) {
            int count = columns - low < 4 ? (int)(columns - low) : 4;
            double factor[4] = {};
            for (int j = 0; j < count; j++) {
                double value = work[low + j];
                for (int k = 0; k < j; k++) value -= panel[(low + k) * height + low + j] * factor[k];
                own[low + j] = factor[j] = value / panel[(low + j) * height + low + j];
            }
            const double* one = panel + low * height;
            const double* two = one + (count > 1 ? height : 0);
            const double* three = two + (count > 2 ? height : 0);
            const double* four = three + (count > 3 ? height : 0);
            int64_t i = low + count;
            for (; i + LANES <= height; i += LANES)
                store<Lanes>(work + i, load<Lanes>(work + i) - (factor[0] * load<Lanes>(one + i) + factor[1] * load<Lanes>(two + i) +
                                                              (factor[2] * load<Lanes>(three + i) + factor[3] * load<Lanes>(four + i))));
            for (; i < height; i++)
                work[i] -= factor[0] * one[i] + factor[1] * two[i] + (factor[2] * three[i] + factor[3] * four[i]);
        }
        for (int64_t i = 0; i < below; i++) values[rows[i]] += work[columns + i];
    }
}

void backward_one(const Fronts& fronts, const double* lower, double* values, double* work) {
    for (int64_t which = fronts.count - 1; which >= 0; which--) {
        const int64_t* row = fronts.table + which * WIDTH;
        const int64_t columns = row[COLUMNS], below = row[BELOW], height = columns + below;
        const double* panel = lower + row[PANEL];
        const int64_t* rows = fronts.rows + row[STARTS];
        double* own = values + row[FIRST];
        for (int64_t i = 0; i < below; i++) work[columns + i] = values[rows[i]];
        int64_t high = columns;
        while (high > 0) {
            int count = high % 4 ? (int)(high % 4) : 4;
            int64_t low = high - count;
            const double* one = panel + low * height;
            const double* two = one + (count > 1 ? height : 0);
            const double* three = two + (count > 2 ? height : 0);
            const double* four = three + (count > 3 ? height : 0);
            Lanes a{}, b{}, c{}, d{};
            int64_t i = high;
            for (; i + LANES <= height; i += LANES) {
                Lanes value = load<Lanes>(work + i);
                a += load<Lanes>(one + i) * value, b += load<Lanes>(two + i) * value;
                c += load<Lanes>(three + i) * value, d += load<Lanes>(four + i) * value;
            }
            double sums[4] = {sum(a), sum(b), sum(c), sum(d)};
            for (; i < height; i++) {
                sums[0] += one[i] * work[i], sums[1] += two[i] * work[i];
                sums[2] += three[i] * work[i], sums[3] += four[i] * work[i];
            }
            for (int j = count - 1; j >= 0; j--) {
                double value = own[low + j] - sums[j];
                for (int k = j + 1; k < count; k++) value -= panel[(low + j) * height + low + k] * own[low + k];
                own[low + j] = work[low + j] = value / panel[(low + j) * height + low + j];
            }
            high = low;
        }
    }
}

// `sides` right-hand sides a row: 1, 4, 8, 12 or 16.
void any_forward(const Fronts& fronts, const double* lower, double* values, int sides, double* work) {
    switch (sides) {
        case 1: return forward_one(fronts, lower, values, work);
        case 4: return forward<Narrow, 4 / FEW>(fronts, lower, values, work);
        case 8: return forward<Lanes, 8 / LANES>(fronts, lower, values, work);
        case 12: return forward<Narrow, 12 / FEW>(fronts, lower, values, work);
        default: return forward<Lanes, 16 / LANES>(fronts, lower, values, work);
    }
}

void any_backward(const Fronts& fronts, const double* lower, double* values, int sides, double* work) {
    switch (sides) {
        case 1: return backward_one(fronts, lower, values, work);
        case 4: return backward<Narrow, 4 / FEW>(fronts, lower, values, work);
        case 8: return backward<Lanes, 8 / LANES>(fronts, lower, values, work);
        case 12: return backward<Narrow, 12 / FEW>(fronts, lower, values, work);
        default: return backward<Lanes, 16 / LANES>(fronts, lower, values, work);
    }
}

}  // namespace
