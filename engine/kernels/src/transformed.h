// The gradient of the nodes' density, smoothed by a Fourier transform: `fields.gaussian`.
//
// Such smoothing is a periodic convolution with products of weights along both axes. Each node
// adds its weights along rows to the two rows around it; reading weighs all rows that nodes touch.
#pragma once
#include <algorithm>
#include <vector>

#include "memory.h"
#include "rollout.h"

namespace microcosmos::ISA {

struct Place {
  int x, y;      // The cell before a node.
  float dx, dy;  // The node's distance from it.
};

class Transformed {
 public:
  explicit Transformed(const Rollout& r) : height_(r.height), width_(r.width) {
    if (!r.transformed) return;
    stride_ = (2 * (size_t(width_) + 1) + BLOCK - 1) / BLOCK * BLOCK;
    rows_ = Floats(height_ * stride_), added_ = Floats(stride_);
    touched_.resize(height_);
    along_ = Floats(4 * size_t(width_) + 2 * BLOCK);
    for (int i = 0; i <= 2 * width_; i++)
      for (int part : {0, 1}) along_[2 * i + part] = r.smoothing_y[part * width_ + i % width_];
    across_ = Floats(4 * (2 * size_t(height_) + 1));
    for (int i = 0; i <= 2 * height_; i++)
      for (int part : {0, 1, 2, 3})
        across_[4 * i + part] = r.smoothing_x[(part % 2 ? 0 : height_) + i % height_];
  }

  // Take the density of nodes, each shared by the four cells around it.
  void deposit(const std::vector<Place>& places) {
    std::fill(touched_.begin(), touched_.end(), 0);
    for (const Place& p : places) {
      const float* weights = along_ + 2 * (width_ - p.y);
      for (size_t i = 0; i < stride_; i += LANES)
        store(added_ + i, (1 - p.dy) * load(weights + i) + p.dy * load(weights + i - 2));
      add(p.x, 1 - p.dx), add(p.x + 1 < height_ ? p.x + 1 : 0, p.dx);
    }
    occupied_.clear();
    for (int x = 0; x < height_; x++)
      if (touched_[x]) occupied_.push_back(x);
  }

  // The gradient at a place, interpolated between the four cells around it.
  void read(const Place& p, float& gx, float& gy) const {
    const float share = p.dx, *weights = across_ + 4 * size_t(p.x + height_);
    Vec4 sum = {};
    for (int x : occupied_) {
      const float* at = weights - 4 * x;
      const Vec4 weight = (1 - share) * load<Vec4>(at) + share * load<Vec4>(at + 4);
      sum = sum + weight * load<Vec4>(rows_ + x * stride_ + 2 * p.y);
    }
    gx = (1 - p.dy) * sum[0] + p.dy * sum[2], gy = (1 - p.dy) * sum[1] + p.dy * sum[3];
  }

 private:
  void add(int x, float share) {
    float* row = rows_ + x * stride_;
    if (!touched_[x]) std::memset(row, 0, 4 * stride_);
    touched_[x] = 1;
    for (size_t i = 0; i < stride_; i += LANES)
      store(row + i, load(row + i) + share * load(added_ + i));
  }

  int height_, width_;
  size_t stride_ = 0;
  Floats rows_;    // Pairs of the density with weights of smoothing and of slope along rows.
  Floats added_;   // What a node adds.
  Floats along_;   // Pairs of both weights along a row, twice.
  Floats across_;  // Of slope and smoothing, slope and smoothing again, across rows, twice.
  std::vector<uint8_t> touched_;
  std::vector<int> occupied_;
};

}  // namespace microcosmos::ISA
