// Points where bodies and fluid meet: their windows of cells, and transfers between both.
//
// Interpolation and spreading use the same weights. A window is 4 x 4 cells; a narrower delta has
// weights of 0. Windows that cross the edge of a row continue beyond it.
#pragma once
#include "bodies.h"
#include "fluid.h"

namespace microcosmos::ISA {

// Coefficients of a delta: its weight at the distance r is (c0 - c1 |r| + c2 root(s0 + s1 |r| + s2
// r^2)) c3, with others for each of the four cells. Peskin, Acta Numerica 11, 479 (2002), eq. 6.27;
// Roma, Peskin and Berger, J. Comput. Phys. 153, 509 (1999).
struct Weights {
  float margin;  // Cells before the position.
  float c0[4], c1[4], c2[4], s0[4], s1[4], s2[4], c3;
};
constexpr Weights WEIGHTS[] = {
    {1,
     {5, 3, 3, 5},
     {2, 2, 2, 2},
     {-1, 1, 1, -1},
     {-7, 1, 1, -7},
     {12, 4, 4, 12},
     {-4, -4, -4, -4},
     0.125f},
    {0.5f,
     {5, 2, 5, 0},
     {3, 0, 3, 0},
     {-1, 2, -1, 0},
     {-2, 1, -2, 0},
     {6, 0, 6, 0},
     {-3, -3, -3, 0},
     1.0f / 6},
    {0, {1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, 1},
};

// The window of a point: weights of its rows, then of its columns; where its first row begins.
struct Window {
  float weights[8];
  int32_t first, slot;
};

struct Points {
  int slots;                // Layers x slots of nodes.
  Floats x, y;              // Positions.
  Floats x_share, y_share;  // Distance from the first cell of the window.
  Array<int32_t> x_first, y_first;
  // Slots in the order of transfers: neighbours, whose windows overlap, follow each other late, so
  // that loads need not wait for stores. Windows in that order. And the part of each share.
  List<int32_t> order;
  Array<Window> windows;
  Array<int32_t> number;  // Of each slot: the place of its window.
  List<Range> parts;
  int layers, layer_slots;

  Points(const Bodies& bodies, const Rollout& r, const List<Share>& shares, int layers)
      : slots(layers * bodies.node_slots), layers(layers), layer_slots(bodies.node_slots) {
    const size_t room = slots + BLOCK;
    for (Floats* one : {&x, &y, &x_share, &y_share}) *one = Floats(room);
    x_first = Array<int32_t>(room), y_first = Array<int32_t>(room);
    order.reserve(size_t(layers) * r.nodes);
    for (const Share& share : shares) {
      const int from = int(order.size());
      for (int p = share.pieces.from; p < share.pieces.to; p++) place(bodies.pieces[p], bodies, r);
      parts.push_back({from, int(order.size())});
    }
    windows = Array<Window>(order.size()), number = Array<int32_t>(room);
    for (size_t n = 0; n < order.size(); n++) number[order[n]] = int32_t(n);
  }

  const Window& window(int slot) const { return windows[number[slot]]; }

  // Call work(window) for each point of a share.
  template <class Work>
  INLINE void each_of(int member, Work work) const {
    for (int n = parts[member].from; n < parts[member].to; n++) work(windows[n]);
  }

 private:
  void place(const Piece& piece, const Bodies& bodies, const Rollout& r) {
    for (size_t turn = 0; turn < 4; turn++)
      for (int layer = 0; layer < layers; layer++)
        for (size_t k = (turn & 1) * 2 + turn / 2; k < piece.node_of.size(); k += 4)
          if (r.present[piece.node_of[k]])
            order.push_back(layer * layer_slots + bodies.node_slot[piece.node_of[k]]);
  }
};

// The first cell of each window along one axis, and the position's distance from it.
inline void first_cells(Range slots, const float* positions, float* share, int32_t* first, int size,
                        float margin) {
  constexpr float FAR = 4194304;  // Positions that are not finite stay within the box.
  const float inverse = 1.0f / size;
  each(slots.from, slots.to, [&](int i, int) __attribute__((always_inline)) {
    Vec x = load(positions + i);
    x = x > -FAR ? x : all(-FAR);
    x = x < FAR ? x : all(FAR);
    const Vec m = x - margin;
    // Conversion rounds towards zero; the comparison makes it the floor.
    Ints b = __builtin_convertvector(m, Ints);
    b = b + (__builtin_convertvector(b, Vec) > m);
    const Vec floor = __builtin_convertvector(b, Vec);
    store(share + i, x - floor);
    // The quotient may be one off by rounding, which the two corrections below mend.
    b = b - __builtin_convertvector(floor * inverse, Ints) * size;
    b = b + ((b < 0) & size);
    b = b - ((b >= size) & size);
    std::memcpy(first + i, &b, sizeof b);
  });
}

template <class Work>
INLINE void each_touched(const Band& band, Work work) {
  for (int n = 0; n < band.touched_blocks; n++)
    for (int o = band.block[n], end = o + BLOCK; o < end; o += LANES) work(o);
}

// The windows of a share's points, and their weights.
inline __attribute__((noinline)) void weigh(Points& p, const Lattice& l, const Weights& delta,
                                            const Member& me) {
  for (int layer = 0; layer < p.layers; layer++) {
    const int start = layer * p.layer_slots;
    const Range slots = {start + me.share.nodes.from, start + me.share.nodes.to};
    first_cells(slots, p.x, p.x_share, p.x_first, l.height, delta.margin);
    first_cells(slots, p.y, p.y_share, p.y_first, l.width, delta.margin);
  }
  auto both = [](const float* a) { return Vec8{a[0], a[1], a[2], a[3], a[0], a[1], a[2], a[3]}; };
  const Vec8 c0 = both(delta.c0), c1 = both(delta.c1), c2 = both(delta.c2);
  const Vec8 s0 = both(delta.s0), s1 = both(delta.s1), s2 = both(delta.s2);
  const Vec8 cell = {0, 1, 2, 3, 0, 1, 2, 3};
  typedef int32_t Ints8 __attribute__((vector_size(32)));
  for (int n = p.parts[me.number].from; n < p.parts[me.number].to; n++) {
    const int slot = p.order[n];
    Window& window = p.windows[n];
    const float fx = p.x_share[slot], fy = p.y_share[slot];
    const Vec8 r = Vec8{fx, fx, fx, fx, fy, fy, fy, fy} - cell;
    const Vec8 a = (Vec8)((Ints8)r & 0x7fffffff);
    store(window.weights, (c0 - c1 * a + c2 * root(s0 + s1 * a + s2 * (a * a))) * delta.c3);
    window.first = int32_t(p.x_first[slot] * l.wide) + p.y_first[slot], window.slot = slot;
  }
}

// Call work(number, place) for each row of a window, which begins at that place.
template <class Work>
INLINE void each_row(const Window& window, const Lattice& l, Work work) {
  const int32_t wide = int32_t(l.wide), end = wide * l.height;
  int32_t at = window.first;
  for (int i = 0; i < 4; i++) {
    work(i, at);
    at += wide;
    at -= at >= end ? end : 0;
  }
}

// Call work(n) for each byte that is set. Most are not, so eight are looked at together.
template <class Work>
INLINE void each_set(const uint8_t* bytes, int from, int to, Work work) {
  for (int start = from; start < to; start += 8) {
    const int count = to - start < 8 ? to - start : 8;
    uint64_t eight = 0;
    std::memcpy(&eight, bytes + start, count);
    for (int n = 0; eight && n < count; n++)
      if (bytes[start + n]) work(start + n);
  }
}

// The points that reach a band, and the blocks of cells in it that they touch.
inline __attribute__((noinline)) void touch(const Points& p, Lattice& l, Band& band) {
  std::memset(l.touched + size_t(band.from) * l.blocks, 0, size_t(band.to - band.from) * l.blocks);
  std::memset(l.crossing + band.from, 0, band.to - band.from);
  band.points.clear();
  for (int number = 0; number < int(p.order.size()); number++) {
    const int slot = p.order[number];
    const int x = p.x_first[slot], y = p.y_first[slot];
    // Rows from the band's first to the window's, around the edge of the box.
    const int after = x - band.from + (x < band.from ? l.height : 0);
    if (after >= band.to - band.from && after + 3 < l.height) continue;
    band.points.push_back(number);
    const bool crosses = y + 3 >= l.width;
    const int near = y / BLOCK, far = crosses ? 0 : (y + 3) / BLOCK;
    for (int i = 0; i < 4; i++) {
      const int row = x + i < l.height ? x + i : x + i - l.height;
      if (row < band.from || row >= band.to) continue;
      uint8_t* touched = l.touched + size_t(row) * l.blocks;
      touched[near] = touched[far] = 1;
      if (crosses) touched[l.blocks - 1] = 1;
      l.crossing[row] |= crosses;
    }
  }
  band.touched_blocks = band.beyond_rows = 0;
  each_set(l.touched, band.from * l.blocks, band.to * l.blocks, [&](int n) {
    const int x = n / l.blocks;
    band.block[band.touched_blocks++] = int32_t(x * l.wide + (n - x * l.blocks) * BLOCK);
  });
  each_set(l.crossing, band.from, band.to, [&](int x) { band.beyond[band.beyond_rows++] = x; });
}

// Find windows and their weights, and the blocks of cells that they touch.
inline void find_windows(Points& p, Lattice& l, const Weights& delta, const Member& me) {
  weigh(p, l, delta, me);
  me.wait();  // A band looks at the windows of all points.
  touch(p, l, l.bands[me.number]);
}

INLINE Vec8 twice(Vec4 a) { return __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3); }

// Interpolate pairs in cells to the points of a share; with DIVIDED, over the density.
template <bool DIVIDED>
__attribute__((noinline)) void interpolate(const Points& p, const Lattice& l, const float* pairs,
                                           float* x, float* y, const Member& me) {
  p.each_of(me.number, [&](const Window& window) __attribute__((always_inline)) {
    const float* w = window.weights;
    const int slot = window.slot;
    Vec8 sum = {};
    each_row(window, l, [&](int i, int32_t row) __attribute__((always_inline)) {
      Vec8 values = load<Vec8>(pairs + 2 * size_t(row));
      if (DIVIDED) values = values * twice(load<Vec4>(l.volume + row));
      sum = sum + w[i] * values;
    });
    sum = sum * twice(load<Vec4>(w + 4));
    const Vec4 t = __builtin_shufflevector(sum, sum, 0, 1, 2, 3) +
                   __builtin_shufflevector(sum, sum, 4, 5, 6, 7);
    x[slot] = t[0] + t[2], y[slot] = t[1] + t[3];
  });
}

// Test whether a row of a window, by its first cell in memory, is in a band.
struct Inside {
  uint32_t start, cells;
  Inside(const Lattice& l, const Band& band)
      : start(uint32_t(band.from * l.wide)), cells(uint32_t(band.to * l.wide) - start) {}
  INLINE bool operator()(int32_t row) const { return uint32_t(row) - start < cells; }
};

// Spread the vectors at points to the forces in the cells of a band. With WHOLE all cells of
// touched blocks are set; otherwise only those in windows, which points read.
template <bool WHOLE>
__attribute__((noinline)) void spread(const Points& p, Lattice& l, const float* x, const float* y,
                                      const Member& me) {
  const Band& band = l.bands[me.number];
  const Inside inside(l, band);
  if (WHOLE)
    each_touched(band, [&](int o) __attribute__((always_inline)) {
      float* g = l.force + 2 * size_t(o);
      store(g, Vec{}), store(g + LANES, Vec{});
    });
  else
    for (int number : band.points)
      each_row(p.windows[number], l, [&](int, int32_t row) __attribute__((always_inline)) {
        if (inside(row)) store(l.force + 2 * size_t(row), Vec8{});
      });
  for (int n = 0; n < band.beyond_rows; n++) {
    float* g = l.force + 2 * l.wide * band.beyond[n];
    std::memset(g, 0, 32), std::memset(g + 2 * l.width, 0, 32);
  }
  for (int number : band.points) {
    const Window& window = p.windows[number];
    const float *w = window.weights, a = x[window.slot], b = y[window.slot];
    const Vec8 value = Vec8{a, b, a, b, a, b, a, b} * twice(load<Vec4>(w + 4));
    each_row(window, l, [&](int i, int32_t row) __attribute__((always_inline)) {
      if (!inside(row)) return;
      float* g = l.force + 2 * size_t(row);
      store(g, load<Vec8>(g) + w[i] * value);
    });
  }
  // Cells beyond the edge are the first of the row: both copies get the sum.
  for (int n = 0; n < band.beyond_rows; n++) {
    float *g = l.force + 2 * l.wide * band.beyond[n], *beyond = g + 2 * l.width;
    for (int i = 0; i < 6; i++) beyond[i] = g[i] = g[i] + beyond[i];
  }
}

// Spread 1 at every point: how many points cover each cell of a band.
inline __attribute__((noinline)) void cover(const Points& p, Lattice& l, const Member& me) {
  const Band& band = l.bands[me.number];
  each_touched(band, [&](int o) __attribute__((always_inline)) { store(l.coverage + o, Vec{}); });
  for (int n = 0; n < band.beyond_rows; n++)
    std::memset(l.coverage + l.wide * band.beyond[n] + l.width, 0, 16);
  const Inside inside(l, band);
  for (int number : band.points) {
    const Window& window = p.windows[number];
    const float* w = window.weights;
    const Vec4 columns = load<Vec4>(w + 4);
    each_row(window, l, [&](int i, int32_t row) __attribute__((always_inline)) {
      if (!inside(row)) return;
      float* c = l.coverage + row;
      store(c, load<Vec4>(c) + w[i] * columns);
    });
  }
  for (int n = 0; n < band.beyond_rows; n++) {
    float *c = l.coverage + l.wide * band.beyond[n], *beyond = c + l.width;
    for (int i = 0; i < 3; i++) beyond[i] = c[i] = c[i] + beyond[i];
  }
}

// The reciprocal of J S 1 / density at each point: the step of the forcing that always converges.
inline __attribute__((noinline)) void relaxation(const Points& p, const Lattice& l, float* beta,
                                                 const Member& me) {
  p.each_of(me.number, [&](const Window& window) __attribute__((always_inline)) {
    const float* w = window.weights;
    Vec4 sum = {};
    each_row(window, l, [&](int i, int32_t row) __attribute__((always_inline)) {
      sum = sum + w[i] * (load<Vec4>(l.coverage + row) * load<Vec4>(l.volume + row));
    });
    sum = sum * load<Vec4>(w + 4);
    beta[window.slot] = 1.0f / ((sum[0] + sum[2]) + (sum[1] + sum[3]));
  });
}

}  // namespace microcosmos::ISA
