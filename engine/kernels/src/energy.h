// Energy that nodes sense and collect, as in `world.nodes` and `fields.energy`.
#pragma once
#include "density.h"
#include "points.h"

namespace microcosmos::ISA {

class Energy {
 public:
  Floats sensed;     // At each node.
  Floats collected;  // By each node since the start.

  Energy(const Bodies& b, const Rollout& r, const Lattice& l) : b_(b), r_(r) {
    sensed = Floats(r.nodes), collected = Floats(r.nodes);
    if (!r.energetic) return;
    const size_t cells = (l.height + 1) * l.wide;
    field_ = Floats(cells), next_ = Floats(cells), taken_ = Floats(cells);
    for (int x = 0; x < l.height; x++)
      std::memcpy(field_ + x * l.wide, r.energy + size_t(x) * l.width, 4 * size_t(l.width));
    std::copy_n(r.collected, r.nodes, (float*)collected);
    for (const Band& band : l.bands) continue_rows(l, band);
  }

  // Read the energy at the nodes, whose windows are those of points in one layer.
  void sense(const Points& p, const Lattice& l, const Member& me) {
    me.wait();
    const Range nodes = me.part(r_.nodes);
    for (int n = nodes.from; n < nodes.to; n++)
      sensed[n] = r_.present[n] ? at(p.window(b_.node_slot[n]), l, field_) : 0;
  }

  // Take energy at the points, then let the rest spread. The coverage of cells by points is known.
  void collect(const Points& p, Lattice& l, const Member& me) {
    const Band& band = l.bands[me.number];
    const bool consumed = r_.parameters[ENERGY_RATE] >= 0, spreads = r_.parameters[DIFFUSION] > 0;
    if (consumed) {
      consume(l, band);
      me.wait();  // A node reads what its cells give from the bands of other members.
    }
    const Range nodes = me.part(r_.nodes);
    for (int n = nodes.from; n < nodes.to; n++) {
      if (!r_.present[n]) continue;
      float taken = 0;
      for (int layer = 0; layer < r_.layers; layer++)
        taken +=
            at(p.window(layer * b_.node_slots + b_.node_slot[n]), l, consumed ? taken_ : field_);
      collected[n] = collected[n] + taken / float(r_.layers);
    }
    me.wait();
    if (spreads) {
      diffuse(l, band);
      me.wait();  // Neighbours of a band read the old field.
      if (me.first()) std::swap(field_, next_);
      me.wait();  // Every member goes on with the new one.
    }
    if (consumed || spreads) continue_rows(l, band);
  }

  // The energy at a node whose windows are those of its points.
  float near(const Points& p, const Lattice& l, int slot) const {
    float sum = 0;
    for (int layer = 0; layer < r_.layers; layer++)
      sum += at(p.window(layer * b_.node_slots + slot), l, field_);
    return sum / float(r_.layers);
  }

  // The energy at any place, between the four cells around it.
  float at(float x, float y, const Lattice& l) const {
    float dx, dy;
    const int i = cell(x, l.height, dx), j = cell(y, l.width, dy);
    const float* one = field_ + size_t(i) * l.wide;
    const float* other = field_ + size_t(i + 1 < l.height ? i + 1 : 0) * l.wide;
    const int next = j + 1 < l.width ? j + 1 : 0;
    return (1 - dx) * ((1 - dy) * one[j] + dy * one[next]) +
           dx * ((1 - dy) * other[j] + dy * other[next]);
  }

  void end(const Lattice& l) const {
    if (!r_.energetic) return;
    for (int x = 0; x < l.height; x++)
      std::memcpy(r_.end_energy + size_t(x) * l.width, field_ + x * l.wide, 4 * size_t(l.width));
    std::copy_n((float*)collected, r_.nodes, r_.end_collected);
  }

 private:
  static float at(const Window& window, const Lattice& l, const float* plane) {
    const float* w = window.weights;
    Vec4 sum = {};
    each_row(window, l, [&](int i, int32_t row) { sum = sum + w[i] * load<Vec4>(plane + row); });
    sum = sum * load<Vec4>(w + 4);
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
  }

  // Windows that cross the edge of a row continue beyond it.
  void continue_rows(const Lattice& l, const Band& band) {
    for (int x = band.from; x < band.to; x++)
      for (int i = 0; i < 3; i++) field_[x * l.wide + l.width + i] = field_[x * l.wide + i];
  }

  // Remove what nodes take, which together is at most all of a cell.
  void consume(Lattice& l, const Band& band) {
    const float rate = r_.parameters[ENERGY_RATE], share = 1.0f / float(r_.layers);
    each_touched(band, [&](int o) __attribute__((always_inline)) {
      const Vec field = load(field_ + o), covered = share * load(l.coverage + o);
      const Vec taken = rate / most(all(1), rate * covered);
      store(taken_ + o, field * taken), store(field_ + o, field * (1.0f - taken * covered));
    });
    for (int n = 0; n < band.beyond_rows; n++) {
      float* row = taken_ + l.wide * band.beyond[n];
      for (int i = 0; i < 3; i++) row[l.width + i] = row[i];
    }
  }

  void diffuse(const Lattice& l, const Band& band) {
    const float diffusion = r_.parameters[DIFFUSION];
    const int W = l.width, H = l.height;
    for (int x = band.from; x < band.to; x++) {
      const float* row = field_ + size_t(x) * l.wide;
      const float* above = field_ + size_t(x ? x - 1 : H - 1) * l.wide;
      const float* below = field_ + size_t(x + 1 < H ? x + 1 : 0) * l.wide;
      float* out = next_ + size_t(x) * l.wide;
      auto step = [&](int y, int before, int after) __attribute__((always_inline)) {
        const float around = ((below[y] + above[y]) + row[after]) + row[before];
        out[y] = row[y] + diffusion * (around - 4 * row[y]);
      };
      step(0, W - 1, 1), step(W - 1, W - 2, 0);
      for (int y = 1; y < W - 1; y++) step(y, y - 1, y + 1);
    }
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats field_, next_, taken_;
};

}  // namespace microcosmos::ISA
