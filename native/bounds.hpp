// Checks of lists of numbers before they serve as places in arrays: a wrong list is a ValueError, never a wrong write.
#pragma once
#include "arrays.hpp"

// The sign bit is set where a number is negative or not below `count`: such bits are gathered without branches.
inline uint64_t outside(int64_t number, int64_t count) {
    return (uint64_t)number | ((uint64_t)count - 1 - (uint64_t)number);
}

// Numbers from 0 to below `count`.
inline const int64_t* demand_below(const int64_t* numbers, int64_t size, int64_t count, const char* what) {
    uint64_t wrong = 0;
    for (int64_t i = 0; i < size; i++) wrong |= outside(numbers[i], count);
    demand(wrong >> 63 == 0, what);
    return numbers;
}
template <class List> const int64_t* demand_below(const List& list, int64_t count, const char* what) {
    return demand_below(list.data(), (int64_t)list.size(), count, what);
}

// Starts of lists that lie one behind the other among `size` numbers, the last their end.
template <class List> const int64_t* demand_starts(const List& list, int64_t size, const char* what) {
    const int64_t* starts = list.data();
    int64_t before = 0;
    for (size_t place = 0; place < list.size(); before = starts[place++]) demand(starts[place] >= before, what);
    demand(before <= size, what);
    return starts;
}

// Next vertex of each in a forest, -1 for none: of a higher number, so that no chain of them has a circle.
template <class List> const int64_t* demand_rising(const List& list, const char* what) {
    const int64_t* next = list.data();
    for (int64_t vertex = 0; vertex < (int64_t)list.size(); vertex++)
        demand(next[vertex] == -1 || (next[vertex] > vertex && next[vertex] < (int64_t)list.size()), what);
    return next;
}
