// The factorisation of fronts.hpp by several threads, to the same bytes whatever their number.
//
// Every number of L is one chain of fused products in rising order of the columns eliminated, whoever computes it and
// however it is cut into blocks: so threads change who works, and blocks of depth keep panels in the cache, but no bit.
#pragma once
#include "fronts.hpp"

namespace {

constexpr int64_t DEPTH = 256, ROWS = 192, PANELS = 96;  // of a packed block; columns eliminated before the rest follows

// One thread's place in the steps that all go through together.
struct Together {
    Team& team;
    int me;
    int step = 0;

    void wait() {
        int64_t now = __atomic_load_n(&team.round, __ATOMIC_ACQUIRE);
        if (__atomic_add_fetch(&team.waiting, 1, __ATOMIC_ACQ_REL) == team.size) {
            __atomic_store_n(&team.waiting, 0, __ATOMIC_RELAXED);
            __atomic_store_n(&team.round, now + 1, __ATOMIC_RELEASE);
            return;
        }
        for (int spins = 0; __atomic_load_n(&team.round, __ATOMIC_ACQUIRE) == now; spins++)
            if (spins > 4000) team.yield();
    }
    // A counter of its own for each step; that of two steps ahead is not in use.
    int64_t* begin() {
        step++;
        if (me == 0) __atomic_store_n(&team.next[(step + 2) & 3], 0, __ATOMIC_RELAXED);
        return &team.next[step & 3];
    }
    static int64_t take(int64_t* counter) { return __atomic_fetch_add(counter, 1, __ATOMIC_RELAXED); }
    bool failed() const { return __atomic_load_n(&team.failed, __ATOMIC_ACQUIRE) != 0; }
    void tell(int64_t negative) {
        if (negative < 0) __atomic_store_n(&team.failed, 1, __ATOMIC_RELEASE);
        else __atomic_fetch_add(&team.negative, negative, __ATOMIC_RELAXED);
    }
    double* claim(int64_t numbers) {
        double* found = team.claim(numbers);
        if (!found) __atomic_store_n(&team.short_of_memory, 1, __ATOMIC_RELAXED), tell(-1);
        return found;
    }
};

struct Front {
    int64_t columns, below, height;
    double* panel;
    double* update;
    double* sign;
};

// C -= P S P^T, or C = -P S P^T, for the rows `low` to `high` of some columns of C, `depth` columns of P from its row
// `shift` on. C begins with row and column `shift`; only what is on or below the diagonal counts.
template <Into INTO>
void multiply_rows(double* c, int64_t ldc, const Front& front, int64_t shift, int64_t depth, int64_t columns, int64_t low,
                   int64_t high, double* packed) {
    double* factors = packed + DEPTH * 256;
    const int64_t rows = high - low;
    for (int64_t begin = 0; begin < depth; begin += DEPTH) {
        const int64_t deep = depth - begin < DEPTH ? depth - begin : DEPTH;
        const double* from = front.panel + begin * front.height + shift;
        for (int64_t k = 0; k < deep; k++) __builtin_memcpy(packed + k * ROWS, from + k * front.height + low, rows * sizeof(double));
        for (int64_t column = 0; column < columns && column < high; column += BLOCK) {
            int count = columns - column < BLOCK ? (int)(columns - column) : BLOCK;
            int64_t start = column > low ? column : low;
            pack(factors, from + column, front.height, front.sign + begin, deep, count);
            double* target = c + column * ldc + start;
            const double* rows_of = packed + (start - low);
            if (INTO == REPLACE && begin == 0) any_strip<REPLACE>(count, target, ldc, rows_of, ROWS, factors, deep, high - start);
            else any_strip<SUBTRACT>(count, target, ldc, rows_of, ROWS, factors, deep, high - start);
        }
    }
}

// Rows that are `rows` high below COUNT columns whose corner is eliminated: times the inverse of the corner.
template <int COUNT> void carry(const double* corner, double* panel, int64_t height, int64_t rows, const double* sign) {
    double scale[COUNT];
    for (int j = 0; j < COUNT; j++) scale[j] = sign[j] / corner[j * height + j];
    for (int64_t row = 0; row < rows; row += LANES) {
        Lanes own[COUNT];
        int left = rows - row < LANES ? (int)(rows - row) : LANES;
        for (int j = 0; j < COUNT; j++) {
            Lanes value = load<Lanes>(panel + j * height + row);
            for (int k = 0; k < j; k++) value -= own[k] * (sign[k] * corner[k * height + j]);
            own[j] = value * scale[j];
        }
        for (int j = 0; j < COUNT; j++) {
            store_rows(panel + j * height + row, own[j], left);
        }
    }
}

INLINE void any_carry(int count, const double* corner, double* panel, int64_t height, int64_t rows, const double* sign) {
    with_count(count, [&](auto known) { carry<known.value>(corner, panel, height, rows, sign); });
}

// Columns `low` to `high` of a front, to which all before `low` have been applied: their own square, or rows below it.
int64_t eliminate_square(const Front& front, int64_t low, int64_t high, double* factors, double least) {
    int64_t negative = 0;
    for (int64_t at = low; at < high; at += BLOCK) {
        int count = high - at < BLOCK ? (int)(high - at) : BLOCK;
        double* corner = front.panel + at * front.height + at;
        pack(factors, front.panel + low * front.height + at, front.height, front.sign + low, at - low, count);
        if (at > low)
            any_strip<SUBTRACT>(count, corner, front.height, front.panel + low * front.height + at, front.height, factors, at - low, high - at);
        int found = any_eliminate(count, corner, front.height, high - at, front.sign + at, least);
        if (found < 0) return -1;
        negative += found;
    }
    return negative;
}

void eliminate_rows(const Front& front, int64_t low, int64_t high, int64_t row, int64_t rows, double* factors) {
    for (int64_t at = low; at < high; at += BLOCK) {
        int count = high - at < BLOCK ? (int)(high - at) : BLOCK;
        double* target = front.panel + at * front.height + row;
        pack(factors, front.panel + low * front.height + at, front.height, front.sign + low, at - low, count);
        if (at > low)
            any_strip<SUBTRACT>(count, target, front.height, front.panel + low * front.height + row, front.height, factors, at - low, rows);
        any_carry(count, front.panel + at * front.height + at, target, front.height, rows, front.sign + at);
    }
}

// So many rows at a time that every thread gets some.
INLINE int64_t chunk(int64_t rows, int threads) {
    int64_t even = (rows / (4 * threads) + 23) / 24 * 24;
    return even < 24 ? 24 : even > ROWS ? ROWS : even;
}

// Which of several threads writes a column of a front that they collect together.
INLINE bool mine(int64_t column, int me, int threads) { return (column >> 4) % threads == me; }

// As `extend_add`, column by column: those of one thread, in the panel or in the update.
void add_columns(const Fronts& fronts, int64_t child, const double* given, const Front& front, bool panel, int me, int threads) {
    const int64_t* row = fronts.table + child * WIDTH;
    const int64_t size = row[BELOW], high = row[WIDTH + RUNS], middle = first_beyond(fronts, child, front.columns);
    const int64_t shift = panel ? 0 : front.columns, lead = panel ? front.height : front.below;
    for (int64_t run = panel ? row[RUNS] : middle; run < (panel ? middle : high); run++) {
        const int64_t* piece = fronts.runs + run * 3;
        for (int64_t step = 0; step < piece[2]; step++) {
            const double* source = given + (piece[0] + step) * size;
            int64_t column = piece[1] + step, start = step;
            if (!mine(column, me, threads)) continue;
            double* target = (panel ? front.panel : front.update) + (column - shift) * lead;
            for (int64_t other = run; other < high; other++, start = 0) {
                const int64_t* part = fronts.runs + other * 3;
                const double* from = source + part[0] + start;
                double* to = target + part[1] + start - shift;
                int64_t length = part[2] - start, place = 0;
                for (; place + LANES <= length; place += LANES)
                    store<Lanes>(to + place, load<Lanes>(to + place) + load<Lanes>(from + place));
                for (; place < length; place++) to[place] += from[place];
            }
        }
    }
}

// Add what the children of a front hand up: each thread its own columns.
void add_children(const Fronts& fronts, const Team& team, int64_t which, const Front& front, bool panel, int me) {
    for (int64_t child = fronts.table[which * WIDTH + CHILD]; child >= 0; child = fronts.table[child * WIDTH + SIBLING])
        add_columns(fronts, child, team.updates[child], front, panel, me, team.size);
}

// Collect the panel of a front: each thread its own columns.
void collect(const Fronts& fronts, const Team& team, int64_t which, const Front& front, const double* data, int me) {
    const int threads = team.size;
    const int64_t* row = fronts.table + which * WIDTH;
    for (int64_t column = 0; column < front.columns; column++)
        if (mine(column, me, threads)) __builtin_memset(front.panel + column * front.height, 0, front.height * sizeof(double));
    for (int64_t entry = row[ENTRIES]; entry < row[WIDTH + ENTRIES]; entry++) {
        int64_t place = fronts.entries[2 * entry + 1];
        if (mine(place / front.height, me, threads)) front.panel[place] = data[fronts.entries[2 * entry]];
    }
    add_children(fronts, team, which, front, true, me);
}

// One front above the subtrees by all threads; false where a pivot was too small.
bool share_front(Together& all, const Front& front, double* packed) {
    for (int64_t low = 0; low < front.columns; low += PANELS) {
        const int64_t high = front.columns - low < PANELS ? front.columns : low + PANELS;
        if (low) {
            int64_t* counter = all.begin();
            const int64_t rows = front.height - low, size = chunk(rows, all.team.size);
            for (int64_t at; (at = size * Together::take(counter)) < rows;)
                multiply_rows<SUBTRACT>(front.panel + low * front.height + low, front.height, front, low, low, high - low, at,
                              at + size < rows ? at + size : rows, packed);
            all.wait();
        }
        if (all.me == 0) all.tell(eliminate_square(front, low, high, packed, all.team.least));
        all.wait();
        if (all.failed()) return false;
        int64_t* counter = all.begin();
        const int64_t rows = front.height - high, size = chunk(rows, all.team.size);
        for (int64_t at; (at = size * Together::take(counter)) < rows;)
            eliminate_rows(front, low, high, high + at, at + size < rows ? size : rows - at, packed);
        all.wait();
    }
    int64_t* counter = all.begin();
    const int64_t size = chunk(front.below, all.team.size), chunks = (front.below + size - 1) / size;
    for (int64_t taken; (taken = Together::take(counter)) < chunks;) {  // the longest rows first
        const int64_t at = (chunks - 1 - taken) * size;
        multiply_rows<REPLACE>(front.update, front.below, front, front.columns, front.columns, front.below, at,
                      at + size < front.below ? at + size : front.below, packed);
    }
    all.wait();
    return true;
}

// Whole subtrees, one thread each; what the last front of each hands up stays for the fronts above.
void own_subtrees(const Fronts& fronts, Together& all, const Room& room, const double* data, double* lower, double* signs) {
    Team& team = all.team;
    int64_t* counter = all.begin();
    for (int64_t taken; (taken = Together::take(counter)) < team.subtrees && !all.failed();) {
        const int64_t begin = team.begins[taken], end = team.ends[taken];
        int64_t base[2] = {INT64_MAX, INT64_MAX}, negative = 0;
        for (int64_t which = begin; which < end; which++) {
            const int64_t* row = fronts.table + which * WIDTH;
            if (row[OFFSET] < base[row[STACK]]) base[row[STACK]] = row[OFFSET];
        }
        double* stacks[2] = {room.first - (begin < end && base[0] != INT64_MAX ? base[0] : 0),
                             room.second - (begin < end && base[1] != INT64_MAX ? base[1] : 0)};
        for (int64_t which = begin; which <= end && negative >= 0; which++) {
            const int64_t* row = fronts.table + which * WIDTH;
            const int64_t below = row[BELOW];
            double* update = which == end ? team.updates[end] = all.claim(below * below + 8) : stacks[row[STACK]] + row[OFFSET];
            if (!update) negative = -1;
            else {
                int64_t found = factorise_front(fronts, which, data, lower, signs, stacks[1 - row[STACK]], update,
                                                room.spare, team.least);
                negative = found < 0 ? -1 : negative + found;
            }
        }
        all.tell(negative);
    }
    all.wait();
}

// What each thread of a team does from beginning to end.
void join(const Fronts& fronts, Team& team, const Room& room, const double* data, double* lower, double* signs) {
    Together all{team, room.me};
    own_subtrees(fronts, all, room, data, lower, signs);
    if (all.failed()) return;
    for (int64_t place = 0; place < team.tops; place++) {  // all threads ask for failures behind the same barriers
        const int64_t which = team.top[place];
        const int64_t* row = fronts.table + which * WIDTH;
        const int64_t below = row[BELOW];
        if (room.me == 0) team.updates[which] = all.claim(below * below + 8);
        all.wait();
        if (all.failed()) return;
        Front front{row[COLUMNS], below, row[COLUMNS] + below, lower + row[PANEL], team.updates[which], signs + row[FIRST]};
        collect(fronts, team, which, front, data, room.me);
        all.wait();
        if (!share_front(all, front, room.packed)) return;
        add_children(fronts, team, which, front, false, room.me);
        all.wait();
        if (room.me == 0)
            for (int64_t child = row[CHILD]; child >= 0; child = fronts.table[child * WIDTH + SIBLING]) {
                team.release(team.updates[child]);
                team.updates[child] = nullptr;
            }
    }
}

}  // namespace
