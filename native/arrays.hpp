// Arrays as they come from Python.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <stdexcept>

namespace nb = nanobind;
template <class T, int N> using Array = nb::ndarray<T, nb::ndim<N>, nb::c_contig, nb::device::cpu>;
template <int N> using Reals = Array<const double, N>;
template <int N> using Counts = Array<const int64_t, N>;

inline void demand(bool right, const char* what) {
    if (!right) throw std::invalid_argument(what);
}

// Numbers of a list, each from `low` to below `high`.
template <class List> const int64_t* demand_range(const List& list, int64_t low, int64_t high, const char* what) {
    for (size_t place = 0; place < list.size(); place++) demand(list.data()[place] >= low && list.data()[place] < high, what);
    return list.data();
}

// Lets other threads run while a call goes on for longer than handing over takes, some tens of microseconds.
struct Free {
    explicit Free(double nanoseconds) {
        if (nanoseconds > 3e4) state = PyEval_SaveThread();
    }
    ~Free() {
        if (state) PyEval_RestoreThread(state);
    }
    Free(const Free&) = delete;
    Free& operator=(const Free&) = delete;
    PyThreadState* state = nullptr;
};

// What a function fills in must be the caller's own array, not a copy that was converted.
inline auto given() { return nb::arg(); }
inline auto filled() { return nb::arg().noconvert(); }

void add_ordering(nb::module_& module);
void add_sketches(nb::module_& module);
void add_symbolic(nb::module_& module);
void add_cables(nb::module_& module);
void add_improve(nb::module_& module);
void add_contact(nb::module_& module);
void add_pictures(nb::module_& module);
void add_release(nb::module_& module);
void add_limits(nb::module_& module);
void add_paths(nb::module_& module);
void add_perceptrons(nb::module_& module);
void add_chains(nb::module_& module);
void add_complement(nb::module_& module);
void add_patches(nb::module_& module);
