// Elementary functions on vectors, elementwise and without the C library, whose versions round
// differently. `portable` has the same for JAX.
#pragma once
#include "vectors.h"

namespace microcosmos::ISA {

// Sine and cosine: Cody and Waite's reduction in three parts, then the polynomials of Cephes.
INLINE void sine_cosine(Vec x, Vec& sine, Vec& cosine) {
  Vec k = nearest(x * 0.63661977f);
  Vec r = ((x - k * 1.5703125f) - k * 4.8375129699707031e-4f) - k * 7.54978995489188216e-8f;
  Ints quarter = __builtin_convertvector(k, Ints);
  Vec z = r * r;
  Vec s = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * r + r;
  Vec c = (2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f;
  c = c * z * z - 0.5f * z + 1.0f;
  Ints swap = (quarter & 1) != 0;
  sine = (Vec)((Ints)(swap ? c : s) ^ ((quarter & 2) << 30));
  cosine = (Vec)((Ints)(swap ? s : c) ^ (((quarter + 1) & 2) << 30));
}

// The angle of (x, y), by the polynomial of Cephes; 0 at the origin.
INLINE Vec arctangent(Vec y, Vec x) {
  Vec ax = absolute(x), ay = absolute(y);
  Vec big = most(ax, ay), small = least(ax, ay);
  big = big > 0.0f ? big : all(1.0f);
  Vec t = small / big;
  Ints far = t > 0.41421356f;
  Vec u = far ? (t - 1.0f) / (t + 1.0f) : t;
  Vec z = u * u;
  Vec p = ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z;
  p = (p - 3.33329491539e-1f) * z * u + u;
  p = far ? p + 0.78539816f : p;
  p = ay > ax ? 1.5707963f - p : p;
  p = x < 0.0f ? 3.1415927f - p : p;
  return (Vec)((Ints)p | ((Ints)y & INT32_MIN));
}

// The same for a single angle of any size: the reduction in double precision.
INLINE void sine_cosine_far(float x, float& sine, float& cosine) {
  if (!(x > -1e15f && x < 1e15f)) {  // Beyond any angle; NaN stays.
    sine = x - x, cosine = x - x + 1;
    return;
  }
  const double turns = x * 0.63661977236758134;
  // 1.5 * 2^52: where doubles are whole numbers, the addition rounds to the nearest.
  const double k = (turns + 6755399441055744.0) - 6755399441055744.0;
  Vec s, c;
  sine_cosine(all(float((x - k * 1.5707963267948966) - k * 6.123233995736766e-17)), s, c);
  const int quarter = int(k - 4 * double(int64_t(k / 4))) & 3;
  sine = quarter & 1 ? c[0] : s[0], cosine = quarter & 1 ? s[0] : c[0];
  sine = quarter & 2 ? -sine : sine, cosine = (quarter + 1) & 2 ? -cosine : cosine;
}

// Sine and cosine of any angles; beyond 8192 rad lane by lane.
INLINE void sine_cosine_any(Vec x, Vec& sine, Vec& cosine) {
  // Up to here multiples of the first two parts of a quarter turn are exact, as Cephes demands.
  constexpr float NEAR = 8192;
  sine_cosine(x, sine, cosine);
  const Ints far = absolute(x) > NEAR;
  for (int l = 0; l < LANES; l++)
    if (__builtin_expect(far[l], 0)) {
      float s, c;
      sine_cosine_far(x[l], s, c);
      sine[l] = s, cosine[l] = c;
    }
}

// The exponential, by the polynomial of Cephes; 0 below -87, the largest power of e above 88.
INLINE Vec exponential(Vec x) {
  constexpr float LEAST = -87.33f, MOST = 88.37f;
  const Ints vanishes = x < LEAST;
  x = x < LEAST ? all(LEAST) : x;  // What is no number stays so.
  x = x > MOST ? all(MOST) : x;
  const Vec k = nearest(x * 1.44269504f);
  const Vec r = (x - k * 0.693359375f) - k * -2.12194440e-4f;
  Vec p = ((1.9875691500e-4f * r + 1.3981999507e-3f) * r + 8.3334519073e-3f) * r;
  p = ((p + 4.1665795894e-2f) * r + 1.6666665459e-1f) * r + 5.0000001201e-1f;
  p = p * (r * r) + r + 1.0f;
  const Ints power = (__builtin_convertvector(k, Ints) + 127) << 23;
  return vanishes ? Vec{} : p * (Vec)power;
}

// The hyperbolic tangent: a polynomial of Cephes near 0, elsewhere by the exponential.
INLINE Vec hyperbolic_tangent(Vec x) {
  const Vec size = absolute(x), z = x * x;
  Vec near = ((-5.70498872745e-3f * z + 2.06390887954e-2f) * z - 5.37397155531e-2f) * z;
  near = ((near + 1.33314422036e-1f) * z - 3.33332819422e-1f) * z * x + x;
  const Vec far = 1.0f - 2.0f / (exponential(2.0f * size) + 1.0f);
  return size < 0.625f ? near : (Vec)((Ints)far | ((Ints)x & INT32_MIN));
}

}  // namespace microcosmos::ISA
