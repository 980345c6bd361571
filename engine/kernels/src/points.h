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

struct Points {
  int slots;                // Layers x slots of nodes.
  Floats x, y;              // Positions.
  Floats x_share, y_share;  // Distance from the first cell of the window.
  Array<int32_t> x_first, y_first;
  Floats weights;       // Eight for each point: of its rows, of its columns.
  Array<int32_t> rows;  // Four for each point: where its rows begin.
  // The order of transfers: neighbours, whose windows overlap, follow each other late, so that
  // loads need not wait for stores.
  std::vector<int32_t> order;

  Points(const Bodies& bodies, const Rollout& r, int layers) : slots(layers * bodies.node_slots) {
    const size_t room = slots + BLOCK;
    for (Floats* one : {&x, &y, &x_share, &y_share}) *one = Floats(room);
    x_first = Array<int32_t>(room), y_first = Array<int32_t>(room);
    weights = Floats(8 * room), rows = Array<int32_t>(4 * room);
    for (const Piece& piece : bodies.pieces)
      for (size_t turn = 0; turn < 4; turn++)
        for (int layer = 0; layer < layers; layer++)
          for (size_t k = (turn & 1) * 2 + turn / 2; k < piece.node_of.size(); k += 4)
            if (r.present[piece.node_of[k]])
              order.push_back(layer * bodies.node_slots + bodies.node_slot[piece.node_of[k]]);
  }
};

// The first cell of each window along one axis, and the position's distance from it.
inline void first_cells(const Points& p, const float* positions, float* share, int32_t* first,
                        int size, float margin) {
  constexpr float FAR = 4194304;  // Positions that are not finite stay within the box.
  const float inverse = 1.0f / size;
  each(0, p.slots, [&](int i, int) __attribute__((always_inline)) {
    Vec x = load(positions + i);
    x = x > -FAR ? x : all(-FAR);
    x = x < FAR ? x : all(FAR);
    const Vec m = x - margin;
    Ints b = __builtin_convertvector(m, Ints);
    b = b + (__builtin_convertvector(b, Vec) > m);
    const Vec floor = __builtin_convertvector(b, Vec);
    store(share + i, x - floor);
    b = b - __builtin_convertvector(floor * inverse, Ints) * size;
    b = b + ((b < 0) & size);
    b = b - ((b >= size) & size);
    std::memcpy(first + i, &b, sizeof b);
  });
}

template <class Work>
INLINE void each_touched(const Lattice& l, Work work) {
  for (int n = 0; n < l.touched_blocks; n++)
    for (int o = l.block[n], end = o + BLOCK; o < end; o += LANES) work(o);
}

// Find windows and their weights, and the blocks of cells that they touch.
inline __attribute__((noinline)) void find_windows(Points& p, Lattice& l, const Weights& delta) {
  std::memset(l.touched, 0, size_t(l.height) * l.blocks);
  std::memset(l.crossing, 0, l.height);
  first_cells(p, p.x, p.x_share, p.x_first, l.height, delta.margin);
  first_cells(p, p.y, p.y_share, p.y_first, l.width, delta.margin);
  auto both = [](const float* a) { return Vec8{a[0], a[1], a[2], a[3], a[0], a[1], a[2], a[3]}; };
  const Vec8 c0 = both(delta.c0), c1 = both(delta.c1), c2 = both(delta.c2);
  const Vec8 s0 = both(delta.s0), s1 = both(delta.s1), s2 = both(delta.s2);
  const Vec8 cell = {0, 1, 2, 3, 0, 1, 2, 3};
  typedef int32_t Ints8 __attribute__((vector_size(32)));
  for (int slot : p.order) {
    const float fx = p.x_share[slot], fy = p.y_share[slot];
    const Vec8 r = Vec8{fx, fx, fx, fx, fy, fy, fy, fy} - cell;
    const Vec8 a = (Vec8)((Ints8)r & 0x7fffffff);
    store(p.weights + 8 * size_t(slot),
          (c0 - c1 * a + c2 * root(s0 + s1 * a + s2 * (a * a))) * delta.c3);
    const int x = p.x_first[slot], y = p.y_first[slot];
    const bool crosses = y + 3 >= l.width;
    const int near = y / BLOCK, far = crosses ? 0 : (y + 3) / BLOCK;
    for (int i = 0; i < 4; i++) {
      const int row = x + i < l.height ? x + i : x + i - l.height;
      uint8_t* touched = l.touched + size_t(row) * l.blocks;
      touched[near] = touched[far] = 1;
      if (crosses) touched[l.blocks - 1] = 1;
      l.crossing[row] |= crosses;
      p.rows[4 * size_t(slot) + i] = int32_t(row * l.wide + y);
    }
  }
  l.touched_blocks = l.beyond_rows = 0;
  for (int x = 0; x < l.height; x++) {
    for (int n = 0; n < l.blocks; n++)
      if (l.touched[size_t(x) * l.blocks + n])
        l.block[l.touched_blocks++] = int32_t(x * l.wide + n * BLOCK);
    if (l.crossing[x]) l.beyond[l.beyond_rows++] = x;
  }
}

INLINE Vec8 twice(Vec4 a) { return __builtin_shufflevector(a, a, 0, 0, 1, 1, 2, 2, 3, 3); }

// Interpolate pairs in cells to the points; with DIVIDED, over the density.
template <bool DIVIDED>
__attribute__((noinline)) void interpolate(const Points& p, const Lattice& l, const float* pairs,
                                           float* x, float* y) {
  for (int slot : p.order) {
    const float* w = p.weights + 8 * size_t(slot);
    const int32_t* row = p.rows + 4 * size_t(slot);
    Vec8 sum = {};
    for (int i = 0; i < 4; i++) {
      Vec8 found = load<Vec8>(pairs + 2 * size_t(row[i]));
      if (DIVIDED) found = found * twice(load<Vec4>(l.volume + row[i]));
      sum = sum + w[i] * found;
    }
    sum = sum * twice(load<Vec4>(w + 4));
    const Vec4 t = __builtin_shufflevector(sum, sum, 0, 1, 2, 3) +
                   __builtin_shufflevector(sum, sum, 4, 5, 6, 7);
    x[slot] = t[0] + t[2], y[slot] = t[1] + t[3];
  }
}

// Spread the vectors at points to the cells' forces.
inline __attribute__((noinline)) void spread(const Points& p, Lattice& l, const float* x,
                                             const float* y) {
  each_touched(l, [&](int o) __attribute__((always_inline)) {
    float* g = l.force + 2 * size_t(o);
    store(g, Vec{}), store(g + LANES, Vec{});
  });
  for (int n = 0; n < l.beyond_rows; n++)
    std::memset(l.force + 2 * (l.wide * l.beyond[n] + l.width), 0, 32);
  for (int slot : p.order) {
    const float *w = p.weights + 8 * size_t(slot), a = x[slot], b = y[slot];
    const int32_t* row = p.rows + 4 * size_t(slot);
    const Vec8 value = Vec8{a, b, a, b, a, b, a, b} * twice(load<Vec4>(w + 4));
    for (int i = 0; i < 4; i++) {
      float* g = l.force + 2 * size_t(row[i]);
      store(g, load<Vec8>(g) + w[i] * value);
    }
  }
  for (int n = 0; n < l.beyond_rows; n++) {
    float *g = l.force + 2 * l.wide * l.beyond[n], *beyond = g + 2 * l.width;
    for (int i = 0; i < 6; i++) beyond[i] = g[i] = g[i] + beyond[i];
  }
}

// Spread 1 at every point: how many points cover each cell.
inline __attribute__((noinline)) void cover(const Points& p, Lattice& l) {
  each_touched(l, [&](int o) __attribute__((always_inline)) { store(l.coverage + o, Vec{}); });
  for (int n = 0; n < l.beyond_rows; n++)
    std::memset(l.coverage + l.wide * l.beyond[n] + l.width, 0, 16);
  for (int slot : p.order) {
    const float* w = p.weights + 8 * size_t(slot);
    const int32_t* row = p.rows + 4 * size_t(slot);
    const Vec4 columns = load<Vec4>(w + 4);
    for (int i = 0; i < 4; i++) {
      float* c = l.coverage + row[i];
      store(c, load<Vec4>(c) + w[i] * columns);
    }
  }
  for (int n = 0; n < l.beyond_rows; n++) {
    float *c = l.coverage + l.wide * l.beyond[n], *beyond = c + l.width;
    for (int i = 0; i < 3; i++) beyond[i] = c[i] = c[i] + beyond[i];
  }
}

// The reciprocal of J S 1 / density at each point: the step of the forcing that always converges.
inline __attribute__((noinline)) void relaxation(const Points& p, const Lattice& l, float* beta) {
  for (int slot : p.order) {
    const float* w = p.weights + 8 * size_t(slot);
    const int32_t* row = p.rows + 4 * size_t(slot);
    Vec4 sum = {};
    for (int i = 0; i < 4; i++)
      sum = sum + w[i] * (load<Vec4>(l.coverage + row[i]) * load<Vec4>(l.volume + row[i]));
    sum = sum * load<Vec4>(w + 4);
    beta[slot] = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  }
  for (int slot : p.order) beta[slot] = 1.0f / beta[slot];
}

}  // namespace microcosmos::ISA
