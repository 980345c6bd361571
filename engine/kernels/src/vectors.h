// Vectors of LANES floats, by the compilers' own extension, and sums over them.
//
// Everything is elementwise, and a sum has one order whatever LANES is: 16 partial sums, then a
// tree. So without contraction the bits depend neither on the instruction set nor on the compiler
// (`tests/engine/world/test_native_bits.py`).
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#if defined(__AVX512F__)
#define ISA avx512
#elif defined(__AVX2__)
#define ISA avx2
#else
#define ISA basic
#endif
#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif
#define INLINE inline __attribute__((always_inline))

namespace microcosmos::ISA {

#if defined(__AVX512F__)
constexpr int LANES = 16;
#elif defined(__AVX2__)
constexpr int LANES = 8;
#else
constexpr int LANES = 4;
#endif
constexpr int BLOCK = 16;  // Cells and slots come in blocks of the widest vector.
constexpr int PARTS = BLOCK / LANES;

typedef float Vec __attribute__((vector_size(4 * LANES)));
typedef int32_t Ints __attribute__((vector_size(4 * LANES)));
typedef uint32_t Words __attribute__((vector_size(4 * LANES)));
typedef float Vec4 __attribute__((vector_size(16)));
typedef float Vec8 __attribute__((vector_size(32)));

template <class V = Vec>
INLINE V load(const float* from) {
  V v;
  memcpy(&v, from, sizeof v);
  return v;
}
template <class V>
INLINE void store(float* to, V v) {
  memcpy(to, &v, sizeof v);
}
INLINE Vec all(float a) { return a - Vec{}; }

// Lanes 0, 1, ... of the 2 LANES lanes of two vectors, from `FIRST` on, `STEP` apart.
template <int FIRST, int STEP, std::size_t... I>
INLINE Vec lanes(Vec a, Vec b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, (FIRST + STEP * int(I))...);
}
template <int HALF, std::size_t... I>
INLINE Vec zip(Vec a, Vec b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, (HALF * LANES / 2 + int(I) / 2 + LANES * (int(I) & 1))...);
}
using Lanes = std::make_index_sequence<LANES>;
// Each lane's left neighbour, the first from the vector before; and its right neighbour.
INLINE Vec left(Vec before, Vec v) { return lanes<LANES - 1, 1>(before, v, Lanes{}); }
INLINE Vec right(Vec v, Vec after) { return lanes<1, 1>(v, after, Lanes{}); }
// Pairs (x, y) side by side in memory: apart and together.
INLINE Vec even(Vec a, Vec b) { return lanes<0, 2>(a, b, Lanes{}); }
INLINE Vec odd(Vec a, Vec b) { return lanes<1, 2>(a, b, Lanes{}); }
INLINE Vec zip_low(Vec x, Vec y) { return zip<0>(x, y, Lanes{}); }
INLINE Vec zip_high(Vec x, Vec y) { return zip<1>(x, y, Lanes{}); }

INLINE Vec4 root(Vec4 a) {
#if defined(__x86_64__)
  return (Vec4)_mm_sqrt_ps((__m128)a);
#elif defined(__aarch64__)
  return (Vec4)vsqrtq_f32((float32x4_t)a);
#elif defined(__wasm_simd128__)
  return (Vec4)wasm_f32x4_sqrt((v128_t)a);
#else
  for (int i = 0; i < 4; i++) a[i] = __builtin_sqrtf(a[i]);
  return a;
#endif
}
INLINE Vec8 root(Vec8 a) {
#if defined(__AVX2__)
  return (Vec8)_mm256_sqrt_ps((__m256)a);
#else
  Vec4 low = root(__builtin_shufflevector(a, a, 0, 1, 2, 3));
  Vec4 high = root(__builtin_shufflevector(a, a, 4, 5, 6, 7));
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}
#if defined(__AVX512F__)
INLINE Vec root(Vec a) { return (Vec)_mm512_sqrt_ps((__m512)a); }
#endif
INLINE float root(float a) { return __builtin_sqrtf(a); }
// What sums over a body are divided by: 1 for one of which nothing has grown.
INLINE float divisor(float a) { return a == 0 ? 1 : a; }

template <class V>
INLINE V least(V a, V b) {
  return a < b ? a : b;
}
template <class V>
INLINE V most(V a, V b) {
  return a > b ? a : b;
}
// The larger of two numbers from 0 on; NaN stays NaN. As whole numbers without a sign such floats
// keep their order, and NaN of either sign is above them all.
INLINE Vec most_or_nan(Vec a, Vec b) {
  const Words x = (Words)a, y = (Words)b;
  return (Vec)(x > y ? x : y);
}
INLINE float most_or_nan(float a, float b) { return a >= b ? a : b > a ? b : a + b; }
INLINE Vec absolute(Vec a) { return (Vec)((Ints)a & 0x7fffffff); }
// Nearest whole number, by the rounding of floats; for |a| below 2^22.
INLINE Vec nearest(Vec a) { return (a + 12582912.0f) - 12582912.0f; }  // 1.5 * 2^23.
INLINE Vec wrapped(Vec angle) { return angle - 6.2831855f * nearest(angle * 0.15915494f); }

// Whether any lane is set.
INLINE bool any(Ints set) {
  uint64_t words[LANES / 2], all = 0;
  memcpy(words, &set, sizeof words);
  for (uint64_t one : words) all |= one;
  return all != 0;
}

// A sum, or the largest value, over blocks of slots.
struct Sum {
  Vec parts[PARTS] = {};
  INLINE void add(int part, Vec v) { parts[part] = parts[part] + v; }
  INLINE float total() const {
    float f[BLOCK];
    memcpy(f, parts, sizeof f);
    Vec8 s = load<Vec8>(f) + load<Vec8>(f + 8);
    Vec4 low = __builtin_shufflevector(s, s, 0, 1, 2, 3);
    Vec4 t = low + __builtin_shufflevector(s, s, 4, 5, 6, 7);
    return (t[0] + t[2]) + (t[1] + t[3]);
  }
};
struct Most {
  Vec parts[PARTS] = {};
  INLINE void add(int part, Vec v) { parts[part] = most(v, parts[part]); }
  INLINE float total() const {
    float f[BLOCK], largest = 0;
    memcpy(f, parts, sizeof f);
    for (float one : f) largest = one > largest ? one : largest;
    return largest;
  }
};

// Call work(slot, part) for each vector of the slots from `from` to `to`, multiples of BLOCK.
template <class Work>
INLINE void each(int from, int to, Work work) {
  for (int block = from; block < to; block += BLOCK)
    for (int part = 0; part < PARTS; part++) work(block + part * LANES, part);
}

struct Range {
  int from = 0, to = 0;
};
template <class Work>
INLINE void each(Range slots, Work work) {
  each(slots.from, slots.to, work);
}

}  // namespace microcosmos::ISA
