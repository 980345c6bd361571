// Random arrays for checks, each of exactly its size, with some numbers that are not finite.
#pragma once
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <memory>
#include <vector>

#include "random.h"

constexpr float WILD[] = {NAN,    INFINITY, -INFINITY, FLT_MAX, -FLT_MAX, 1e30f,
                          1e-40f, -1e9f,    4194304,   1e6f,    -0.0f,    -1};

template <class T, size_t N>
T any(Random& random, const T (&of)[N]) {
  return of[random.below(int(N))];
}

class Made {
 protected:
  Random random_;
  int odds_;  // One number in so many is wild; 0: none.
  std::vector<std::unique_ptr<float[]>> floats_;
  std::vector<size_t> counts_;
  std::vector<std::unique_ptr<int32_t[]>> ints_;

  explicit Made(uint32_t number) : random_{(number + 1) * 2654435761u | 1} {
    for (int i = 0; i < 8; i++) random_.bits();
    const int odds[] = {0, 0, 200, 5};
    odds_ = any(random_, odds);
  }

  bool coin() { return random_.below(2); }
  bool few() { return random_.below(8) == 0; }

  float* room(size_t count) {
    floats_.emplace_back(new float[count]());
    counts_.push_back(count);
    return floats_.back().get();
  }

  float* numbers(size_t count, float low, float high) {
    float* found = room(count);
    for (size_t i = 0; i < count; i++) found[i] = tamed(random_.between(low, high));
    return found;
  }

  float tamed(float value) {
    return odds_ && random_.below(odds_) == 0 ? any(random_, WILD) : value;
  }

  int32_t* indices(const std::vector<int32_t>& given) {
    ints_.emplace_back(new int32_t[given.size()]);
    std::copy(given.begin(), given.end(), ints_.back().get());
    return ints_.back().get();
  }

  int32_t* indices(size_t count, int least, int limit) {
    std::vector<int32_t> found(count);
    for (int32_t& one : found) one = least + random_.below(limit - least);
    return indices(found);
  }
};
