// The gradient of the nodes' density, smoothed with weights along both axes of a periodic box:
// `fields.gaussian` and `fields.binomial`.
//
// Each node is shared by the four cells around it. Rows are smoothed first, then columns, both
// only where nodes are.
#pragma once
#include <optional>

#include "bodies.h"
#include "memory.h"
#include "rollout.h"

namespace microcosmos::ISA {

// The cell before a position along a periodic axis, and the distance from it.
inline int cell(float position, int size, float& share) {
  constexpr float FAR = 4194304;  // Positions that are not finite stay within the box.
  const float x = position > -FAR ? (position < FAR ? position : FAR) : -FAR;
  int first = int(x);
  first -= float(first) > x;
  share = x - float(first);
  first %= size;
  return first < 0 ? first + size : first;
}

struct Place {
  int x, y;      // The cell before a node.
  float dx, dy;  // The node's distance from it.
};

// Weights along an axis: of smoothing, then of the slope. Those that are not zero reach from the
// cell `before` places back to the one `after` places ahead; each has a block of room.
struct Smoothing {
  int cells, before = 0, after = 0;
  Floats smooth, slope;

  Smoothing(const float* weights, int cells) : cells(cells) {
    auto zero = [&](int distance) {
      return weights[distance] == 0 && weights[cells + distance] == 0;
    };
    for (int d = 1; d <= cells / 2; d++) {
      if (!zero(d)) after = d;
      if (!zero(cells - d)) before = d;
    }
    // Weights that reach around the box would overlap themselves: each cell then counts once.
    if (before + after + 1 >= cells) before = 0, after = cells - 1;
    smooth = Floats(room()), slope = Floats(room());
    for (int i = 0; i < count(); i++) {
      const int distance = (i - before + cells) % cells;
      smooth[i] = weights[distance], slope[i] = weights[cells + distance];
    }
  }

  int count() const { return before + after + 1; }
  int room() const { return (count() + BLOCK - 1) / BLOCK * BLOCK; }
};

class Density {
 public:
  Density(const Rollout& r, int members) : height_(r.height), width_(r.width) {
    if (!r.repelled || r.paired) return;
    along_x_.emplace(r.smoothing_x, height_), along_y_.emplace(r.smoothing_y, width_);
    blocks_ = (width_ + BLOCK - 1) / BLOCK;
    row_ = size_t(blocks_) * BLOCK;
    wide_ = row_ + along_y_->room() + BLOCK;
    density_ = Floats(height_ * row_);
    touched_ = Array<uint8_t>(size_t(height_) * blocks_);
    occupied_ = Array<uint8_t>(height_);
    for (Floats* one : {&smooth_, &slope_}) *one = Floats(height_ * wide_);
    for (Floats* one : {&gradient_x_, &gradient_y_}) *one = Floats(height_ * row_);
    near_.resize(members);
    for (List<Near>& one : near_) one.reserve(along_x_->count());
  }

  Place place(float x, float y) const {
    Place p;
    p.x = cell(x, height_, p.dx), p.y = cell(y, width_, p.dy);
    return p;
  }

  // Add up the density of all nodes in a member's rows, and smooth these rows. Each member reads
  // all nodes in one order, so that a cell's sum does not depend on the number of members.
  void deposit(const List<Place>& places, const Member& me) {
    const Range rows = me.part(height_);
    clear(rows);
    for (const Place& p : places)
      for (int i = 0; i < 2; i++) {
        const int x = p.x + i < height_ ? p.x + i : 0;
        if (x < rows.from || x >= rows.to) continue;
        occupied_[x] = 1;
        for (int j = 0; j < 2; j++) {
          const int y = p.y + j < width_ ? p.y + j : 0;
          float& at = density_[x * row_ + y];
          at = at + (i ? p.dx : 1 - p.dx) * (j ? p.dy : 1 - p.dy);
          touched_[size_t(x) * blocks_ + y / BLOCK] = 1;
        }
      }
    for (int x = rows.from; x < rows.to; x++)
      if (occupied_[x]) smooth_row(x);
  }

  // Smooth columns, in the blocks of a member's rows that nodes touch.
  void differentiate(const Member& me) {
    const Range rows = me.part(height_);
    List<Near>& near = near_[me.number];
    for (int x = rows.from; x < rows.to; x++) {
      if (!occupied_[x]) continue;
      find_near(x, near);
      for (int block = 0; block < blocks_; block++) {
        if (!touched_[size_t(x) * blocks_ + block]) continue;
        for (int y = block * BLOCK; y < (block + 1) * BLOCK; y += LANES) {
          Vec gx = {}, gy = {};
          for (const Near& one : near) {
            gx = gx + one.slope * load(smooth_ + one.row + y);
            gy = gy + one.smooth * load(slope_ + one.row + y);
          }
          store(gradient_x_ + x * row_ + y, gx), store(gradient_y_ + x * row_ + y, gy);
        }
      }
    }
  }

  // The gradient at a place, interpolated between the four cells around it.
  void read(const Place& p, float& gx, float& gy) const {
    const size_t one = p.x * row_, other = (p.x + 1 < height_ ? p.x + 1 : 0) * row_;
    const int y = p.y, next = p.y + 1 < width_ ? p.y + 1 : 0;
    auto between = [&](const float* g) {
      return (1 - p.dx) * ((1 - p.dy) * g[one + y] + p.dy * g[one + next]) +
             p.dx * ((1 - p.dy) * g[other + y] + p.dy * g[other + next]);
    };
    gx = between(gradient_x_), gy = between(gradient_y_);
  }

 private:
  // A row that reaches another: where it begins, and its weights there.
  struct Near {
    size_t row;
    float smooth, slope;
  };

  // Clear the rows that nodes occupied in the step before, instead of the whole plane.
  void clear(Range rows) {
    for (int x = rows.from; x < rows.to; x++) {
      if (!occupied_[x]) continue;
      std::memset(density_ + x * row_, 0, 4 * row_);
      std::memset(touched_ + size_t(x) * blocks_, 0, blocks_);
      occupied_[x] = 0;
    }
  }

  // Smooth a row of the density. Cells before the row's first and beyond its last are those of its
  // other end.
  void smooth_row(int x) {
    const Smoothing& along = *along_y_;
    float *smooth = smooth_ + x * wide_, *slope = slope_ + x * wide_;
    std::memset(smooth, 0, 4 * wide_), std::memset(slope, 0, 4 * wide_);
    for (int block = 0; block < blocks_; block++) {
      if (!touched_[size_t(x) * blocks_ + block]) continue;
      for (int y = block * BLOCK; y < (block + 1) * BLOCK; y++) {
        const float density = density_[x * row_ + y];
        if (density == 0) continue;
        for (int i = 0; i < along.room(); i += LANES) {
          store(smooth + y + i, load(smooth + y + i) + density * load(along.smooth + i));
          store(slope + y + i, load(slope + y + i) + density * load(along.slope + i));
        }
      }
    }
    for (float* row : {smooth, slope}) {
      float* first = row + along.before;
      for (int i = 0; i < along.before; i++) first[width_ - along.before + i] += row[i];
      for (int i = 0; i < along.after; i++) first[i] += first[width_ + i];
    }
  }

  void find_near(int x, List<Near>& near) const {
    const Smoothing& along = *along_x_;
    near.clear();
    for (int i = 0; i < along.count(); i++) {
      int from = x + along.before - i;
      from = from < 0 ? from + height_ : from >= height_ ? from - height_ : from;
      if (occupied_[from])
        near.push_back({from * wide_ + along_y_->before, along.smooth[i], along.slope[i]});
    }
  }

  int height_, width_, blocks_ = 0;
  size_t row_ = 0, wide_ = 0;  // Floats from a row to the next; with room for what is smoothed.
  std::optional<Smoothing> along_x_, along_y_;
  Floats density_, smooth_, slope_, gradient_x_, gradient_y_;
  Array<uint8_t> touched_, occupied_;  // (row, block), (row)
  List<List<Near>> near_;              // Of each member.
};

}  // namespace microcosmos::ISA
