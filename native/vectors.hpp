// Vectors as wide as the processor's: 8 doubles with AVX-512, 4 with AVX2, 2 with SSE2 and NEON. They are the vector
// types that GCC and Clang share; intrinsics serve only where these have no operation.
#pragma once
#include <cstdint>
#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace {

#if defined(__AVX512F__)
constexpr int LANES = 8;
#elif defined(__AVX__)
constexpr int LANES = 4;
#else
constexpr int LANES = 2;
#endif

typedef double Lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t Bits __attribute__((vector_size(8 * LANES)));
typedef uint64_t Places __attribute__((vector_size(8 * LANES)));

// Vectors of 4 doubles at most, for rows of 4 right-hand sides.
constexpr int FEW = LANES < 4 ? LANES : 4;
typedef double Narrow __attribute__((vector_size(8 * FEW)));

#define INLINE inline __attribute__((always_inline))
#define UNROLL _Pragma("GCC unroll 16")  // without it GCC leaves arrays of vectors in memory

template <class T> constexpr int width_of = sizeof(T) / sizeof(double);

template <class T> INLINE T load(const double* at) {  // from any address, aligned or not
    T value;
    __builtin_memcpy(&value, at, sizeof(T));
    return value;
}
template <class T> INLINE void store(double* at, T value) { __builtin_memcpy(at, &value, sizeof(T)); }

// The first `rows` numbers of a vector, all if there are as many.
INLINE void store_rows(double* at, Lanes value, int rows) {
    if (rows >= LANES) return store<Lanes>(at, value);
#if defined(__AVX512F__)
    _mm512_mask_storeu_pd(at, (__mmask8)((1 << rows) - 1), (__m512d)value);
#elif defined(__AVX__)
    static const int64_t mask[8] = {-1, -1, -1, -1, 0, 0, 0, 0};
    _mm256_maskstore_pd(at, _mm256_loadu_si256((const __m256i*)(mask + 4 - rows)), (__m256d)value);
#else
    for (int lane = 0; lane < rows; lane++) at[lane] = value[lane];
#endif
}

INLINE Lanes all(double value) { return Lanes{} + value; }
INLINE Lanes where(Bits yes, Lanes one, Lanes other) { return (Lanes)(((Bits)one & yes) | ((Bits)other & ~yes)); }
INLINE Lanes least(Lanes a, Lanes b) { return where(a < b, a, b); }
INLINE Lanes absolute(Lanes a) { return (Lanes)((Bits)a & (Bits{} + INT64_MAX)); }

INLINE Lanes root(Lanes a) {
#if defined(__AVX512F__)
    return (Lanes)_mm512_sqrt_pd((__m512d)a);
#elif defined(__AVX__)
    return (Lanes)_mm256_sqrt_pd((__m256d)a);
#else
    Lanes found;
    for (int lane = 0; lane < LANES; lane++) found[lane] = __builtin_sqrt(a[lane]);
    return found;
#endif
}

INLINE bool any(Bits yes) {
#if defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)yes, (__m512i)yes) != 0;
#elif defined(__AVX__)
    return !_mm256_testz_si256((__m256i)yes, (__m256i)yes);
#else
    return (yes[0] | yes[1]) != 0;
#endif
}

template <class T> INLINE double sum(T a) {
    double found = a[0];
    for (int lane = 1; lane < width_of<T>; lane++) found += a[lane];
    return found;
}

// ln(1 + x) for x > -1, to about one unit in the last place: 1 + x = 2^k (1 + f), and with s = f / (2 + f) the series
// of ln((1 + s) / (1 - s)) as the minimax polynomial of Sun's fdlibm.
INLINE Lanes log1p(Lanes x) {
    const Lanes one = all(1.0);
    Lanes u = one + x;
    Lanes lost = (x - (u - one)) / u;  // rounding error of u, as a share of it
    Bits bits = (Bits)u;
    Bits high = bits + (Bits{} + (0x3ff0000000000000LL - 0x3fe6a09e667f3bcdLL));  // brings 1 + f to sqrt(1/2) .. sqrt(2)
    Bits power = (high >> 52) - 1023;
    Lanes f = (Lanes)((high & 0x000fffffffffffffLL) + 0x3fe6a09e667f3bcdLL) - one;
    Bits same = power == 0;
    f = where(same, x, f);
    Lanes k = __builtin_convertvector(power, Lanes);
    lost = where(same, Lanes{}, lost);
    Lanes s = f / (f + 2.0), z = s * s;
    Lanes r = z * (6.666666666666735130e-01 +
           z * (3.999999999940941908e-01 +
           z * (2.857142874366239149e-01 +
           z * (2.222219843214978396e-01 +
           z * (1.818357216161805012e-01 +
           z * (1.531383769920937332e-01 +
           z * 1.479819860511658591e-01))))));
    Lanes half = 0.5 * f * f;
    return k * 6.93147180369123816490e-01 - ((half - (s * (half + r) + (k * 1.90821492927058770002e-10 + lost))) - f);
}

}  // namespace
