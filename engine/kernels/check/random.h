// Random numbers for checks, the same everywhere.
#pragma once
#include <cstdint>

struct Random {
  uint32_t state;
  uint32_t bits() {
    state ^= state << 13, state ^= state >> 17, state ^= state << 5;
    return state;
  }
  int below(int count) { return int((bits() >> 8) % uint32_t(count)); }
  // Multiples of 2^-24, so that no rounding is involved.
  float unit() { return float(bits() >> 8) * (1.0f / 16777216); }
  float between(float low, float high) { return low + (high - low) * unit(); }
};
