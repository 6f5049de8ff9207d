// Eight numbers at a time, in the vector types that GCC and Clang share; other widths are made of these.
#pragma once
#include <cstdint>

namespace {

typedef double V8 __attribute__((vector_size(64)));
typedef int64_t I8 __attribute__((vector_size(64)));
typedef double V4 __attribute__((vector_size(32)));

#define INLINE inline __attribute__((always_inline))
#define UNROLL _Pragma("GCC unroll 16")  // loops over arrays of vectors, which else stay in memory

template <class V> INLINE V load(const double* at) {  // from any place, aligned or not
    V value;
    __builtin_memcpy(&value, at, sizeof(V));
    return value;
}
template <class V> INLINE void store(double* at, V value) { __builtin_memcpy(at, &value, sizeof(V)); }

INLINE V8 all(double value) { return V8{value, value, value, value, value, value, value, value}; }
INLINE V8 where(I8 yes, V8 one, V8 other) { return (V8)(((I8)one & yes) | ((I8)other & ~yes)); }
INLINE V8 least(V8 a, V8 b) { return where(a < b, a, b); }
INLINE V8 size_of(V8 a) { return (V8)((I8)a & (I8{} + INT64_MAX)); }

INLINE V8 root(V8 a) {
    V8 found;
    for (int lane = 0; lane < 8; lane++) found[lane] = __builtin_sqrt(a[lane]);
    return found;
}

INLINE bool any(I8 yes) {
    int64_t found = 0;
    for (int lane = 0; lane < 8; lane++) found |= yes[lane];
    return found != 0;
}

INLINE double sum(V8 a) { return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7])); }

// ln(1 + x) for x > -1, to about one unit in the last place: 1 + x = 2^k (1 + f), and with s = f / (2 + f) the series
// of ln((1 + s) / (1 - s)) as the minimax polynomial of Sun's fdlibm.
INLINE V8 log1p8(V8 x) {
    const V8 one = all(1.0);
    V8 u = one + x;
    V8 lost = (x - (u - one)) / u;  // what rounding took from u, as a share
    I8 bits = (I8)u;
    I8 high = bits + (I8{} + (0x3ff0000000000000LL - 0x3fe6a09e667f3bcdLL));  // brings 1 + f to sqrt(1/2) .. sqrt(2)
    I8 power = (high >> 52) - 1023;
    V8 f = (V8)((high & 0x000fffffffffffffLL) + 0x3fe6a09e667f3bcdLL) - one;
    I8 same = power == 0;
    f = where(same, x, f);
    V8 k = __builtin_convertvector(power, V8);
    lost = where(same, V8{}, lost);
    V8 s = f / (f + 2.0), z = s * s;
    V8 r = z * (6.666666666666735130e-01 +
           z * (3.999999999940941908e-01 +
           z * (2.857142874366239149e-01 +
           z * (2.222219843214978396e-01 +
           z * (1.818357216161805012e-01 +
           z * (1.531383769920937332e-01 +
           z * 1.479819860511658591e-01))))));
    V8 half = 0.5 * f * f;
    return k * 6.93147180369123816490e-01 - ((half - (s * (half + r) + (k * 1.90821492927058770002e-10 + lost))) - f);
}

}  // namespace
