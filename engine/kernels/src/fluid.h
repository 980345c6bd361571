// The fluid: D2Q9 with two relaxation times and Guo's forcing, collided and streamed in place.
#pragma once

#include "memory.h"
#include "vectors.h"

namespace microcosmos::ISA {

// Rows of cells that one member of a team works on, and which of them bodies touch.
struct Band {
  int from, to;                  // Rows.
  Array<int32_t> block, beyond;  // Touched blocks; rows whose windows continue beyond the edge.
  int touched_blocks = 0, beyond_rows = 0;
  List<int32_t> points;       // Points whose windows reach these rows, in their order.
  Floats next_row, last_row;  // Populations on their way to the band after, and before.
  float fastest = 0;          // Square of the largest speed.

  Band(int from, int to, int blocks) : from(from), to(to) {
    const size_t rows = to - from, row = size_t(blocks) * BLOCK;
    block = Array<int32_t>(rows * blocks), beyond = Array<int32_t>(rows);
    next_row = Floats(3 * row + 64), last_row = Floats(3 * row + 64);
  }
};

// Forces on the fluid besides those of bodies: none, one for all cells, or one for each.
enum Drive { UNDRIVEN, UNIFORM, VARIED };

// Planes of populations, of velocities and of forces, and the blocks that bodies touch.
struct Lattice {
  int height, width, blocks;  // Blocks in a row.
  size_t row, plane;          // Floats from a row, and from a plane, to the next.
  size_t wide;                // The same for rows that continue beyond the edge.
  Floats populations;
  Floats velocity, force;        // Pairs (x, y).
  Floats volume, coverage;       // 1 / density; nodes over a cell.
  Array<uint8_t> touched;        // (row, block)
  Array<uint8_t> crossing;       // Rows whose windows continue beyond the edge.
  List<Band> bands;              // Together all rows.
  Drive drive = UNDRIVEN;
  float push_x = 0, push_y = 0;  // The uniform force.
  Floats pushes_x, pushes_y;     // The force in each cell, if it varies.

  Lattice(int height, int width, int parts)
      : height(height), width(width), blocks((width + BLOCK - 1) / BLOCK) {
    row = size_t(blocks) * BLOCK;
    plane = row * height + 48;  // Planes must not meet in the same lines of a cache.
    wide = row + BLOCK;
    populations = Floats(9 * plane);
    const size_t cells = (height + 1) * wide;
    velocity = Floats(2 * cells), force = Floats(2 * cells);
    volume = Floats(cells), coverage = Floats(cells);
    touched = Array<uint8_t>(size_t(height) * blocks);
    crossing = Array<uint8_t>(height);
    bands.reserve(parts);
    for (int64_t n = 0; n < parts; n++)
      bands.emplace_back(int(height * n / parts), int(height * (n + 1) / parts), blocks);
  }
};

struct Rates {
  float keep, same, other, even, even45, forced3, forced9, odd1, odd2, push1, push2;
  static constexpr float REST = 4.0f / 9, STRAIGHT = 1.0f / 9, DIAGONAL = 1.0f / 36;
  Rates(float viscosity, bool fixed_magic) {
    const float even_time = 3 * viscosity + 0.5f, excess = even_time - 0.5f;
    // See `fluid.capped_magic`: 3/16, lowered so that the odd time is at most 1.
    const float capped = 0.5f * excess < 0.1875f ? 0.5f * excess : 0.1875f;
    const float odd_time = (fixed_magic ? 0.1875f : capped) / excess + 0.5f;
    const float odd = 1 / odd_time;
    even = 1 / even_time;
    const float half_even = 1 - 0.5f * even, half_odd = 1 - 0.5f * odd;
    keep = 1 - even, same = keep * 0.5f, other = (1 - odd) * 0.5f;
    even45 = 4.5f * even, forced3 = half_even * 3, forced9 = 9 * half_even;
    odd1 = 3 * STRAIGHT * odd, odd2 = 3 * DIAGONAL * odd;
    push1 = 3 * STRAIGHT * half_odd, push2 = 3 * DIAGONAL * half_odd;
  }
};

// Collide under a force, of which `push` is the part of the surroundings. Return the square of the
// speed before, with the half step of that part; that of bodies is not known at its time.
template <bool FORCED, bool PUSHED>
INLINE Vec collide(Vec* f, Vec fx, Vec fy, Vec push_x, Vec push_y, const Rates& k) {
  const Vec s1 = f[1] + f[2], d1 = f[1] - f[2], s3 = f[3] + f[4], d3 = f[3] - f[4];
  const Vec s5 = f[5] + f[6], d5 = f[5] - f[6], s7 = f[7] + f[8], d7 = f[7] - f[8];
  const Vec deviation = f[0] + (s1 + s3) + (s5 + s7);
  Vec jx = d1 + (d5 + d7), jy = d3 + (d5 - d7);
  const Vec volume = 1.0f / (1.0f + deviation);
  Vec ux = jx * volume, uy = jy * volume;
  Vec square = ux * ux + uy * uy;
  if (PUSHED) {
    const Vec x = (jx + 0.5f * push_x) * volume, y = (jy + 0.5f * push_y) * volume;
    square = x * x + y * y;
  }
  // The velocity of Guo's scheme is that at the half step: half of the force has acted.
  if (FORCED) {
    jx = jx + 0.5f * fx, jy = jy + 0.5f * fy;
    ux = jx * volume, uy = jy * volume;
  }
  Vec common = k.even * (deviation - 1.5f * (jx * ux + jy * uy));
  if (FORCED) common = common - k.forced3 * (ux * fx + uy * fy);
  f[0] = k.keep * f[0] + Rates::REST * common;
  auto pair = [&](int i, Vec sum, Vec difference, Vec u, Vec j, Vec force, float weight, float odd,
                  float push) __attribute__((always_inline)) {
    Vec flow = k.even45 * j;
    if (FORCED) flow = flow + k.forced9 * force;
    const Vec even = k.same * sum + weight * (common + u * flow);
    Vec uneven = k.other * difference + odd * j;
    if (FORCED) uneven = uneven + push * force;
    f[i] = even + uneven, f[i + 1] = even - uneven;
  };
  pair(1, s1, d1, ux, jx, fx, Rates::STRAIGHT, k.odd1, k.push1);
  pair(3, s3, d3, uy, jy, fy, Rates::STRAIGHT, k.odd1, k.push1);
  pair(5, s5, d5, ux + uy, jx + jy, fx + fy, Rates::DIAGONAL, k.odd2, k.push2);
  pair(7, s7, d7, ux - uy, jx - jy, fx - fy, Rates::DIAGONAL, k.odd2, k.push2);
  return square;
}

// Collide and stream the rows of a band in place, one at a time: what goes to the next row waits
// until that has been read, what goes to the row before is written at once. What leaves the band
// waits for `join`.
template <bool FILLED, Drive DRIVE>
__attribute__((noinline)) void advance(Lattice& l, Band& band, const Rates& k) {
  const size_t P = l.plane, S = l.row, W = l.width;
  const size_t end = (W - 1) / LANES * LANES,
               last = W - 1 - end;  // The last vector and its last lane.
  float *const t1 = band.next_row, *const t5 = t1 + S, *const t7 = t5 + S;
  Ints inside;
  for (int i = 0; i < LANES; i++) inside[i] = end + i < W ? -1 : 0;
  Vec push_x = all(l.push_x), push_y = all(l.push_y);
  Vec fastest = {};
  const size_t first_row = band.from, end_row = band.to;
  for (size_t x = first_row; x < end_row; x++) {
    float* const r = l.populations + x * S;
    // Directions 2, 6 and 8 go to the row before.
    const bool leaves = x == first_row;
    float* const u2 = leaves ? band.last_row : r - S + 2 * P;
    float* const u6 = leaves ? band.last_row + S : r - S + 6 * P;
    float* const u8 = leaves ? band.last_row + 2 * S : r - S + 8 * P;
    const float* const g = l.force + 2 * x * l.wide;
    const uint8_t* const touched = l.touched + x * l.blocks;
    Vec first[9],
        before[9];  // The populations of the first vector of the row, and of the one before.
    auto collided = [&](size_t y, Vec* f) __attribute__((always_inline)) {
      for (int i = 0; i < 9; i++) f[i] = load(r + i * P + y);
      // Lanes beyond the row hold what earlier steps stored there: they must not be the fastest.
      if (!FILLED && y == end)
        for (int i = 0; i < 9; i++) f[i] = (Vec)((Ints)f[i] & inside);
      if (DRIVE == VARIED)
        push_x = load(l.pushes_x + x * S + y), push_y = load(l.pushes_y + x * S + y);
      Vec square;
      if (__builtin_expect(touched[y / BLOCK], 0)) {
        const Vec a = load(g + 2 * y), b = load(g + 2 * y + LANES);
        Vec fx = even(a, b), fy = odd(a, b);
        if (DRIVE != UNDRIVEN) fx = fx + push_x, fy = fy + push_y;
        square = collide<true, DRIVE != UNDRIVEN>(f, fx, fy, push_x, push_y, k);
      } else
        square =
            collide<DRIVE != UNDRIVEN, DRIVE != UNDRIVEN>(f, push_x, push_y, push_x, push_y, k);
      fastest = most_or_nan(square, fastest);
      store(r + y, f[0]);
      store(u2 + y, f[2]);
      // What the row before sent here is stored only now, after this cell has been read.
      store(r + P + y, load(t1 + y)), store(t1 + y, f[1]);
      store(r + 5 * P + y, load(t5 + y)), store(r + 7 * P + y, load(t7 + y));
    };
    collided(0, first);
    for (int i = 3; i < 9; i++) before[i] = first[i];
    for (size_t y = LANES; y < W; y += LANES) {
      Vec f[9];
      collided(y, f);
      store(r + 3 * P + y, left(before[3], f[3])),
          store(r + 4 * P + y - LANES, right(before[4], f[4]));
      store(t5 + y, left(before[5], f[5])), store(u6 + y - LANES, right(before[6], f[6]));
      store(t7 + y - LANES, right(before[7], f[7])), store(u8 + y, left(before[8], f[8]));
      for (int i = 3; i < 9; i++) before[i] = f[i];
    }
    // The last and the first cell of a row are neighbours.
    store(r + 4 * P + end, right(before[4], first[4])), store(u6 + end, right(before[6], first[6]));
    store(t7 + end, right(before[7], first[7])), store(r + 3 * P, left(before[3], first[3]));
    store(t5, left(before[5], first[5])), store(u8, left(before[8], first[8]));
    if (!FILLED) {
      r[4 * P + W - 1] = first[4][0], u6[W - 1] = first[6][0], t7[W - 1] = first[7][0];
      r[3 * P] = before[3][last], t5[0] = before[5][last], u8[0] = before[8][last];
    }
  }
  band.fastest = 0;
  for (int i = 0; i < LANES; i++) band.fastest = most_or_nan(fastest[i], band.fastest);
}

// Take what has streamed into a band from those beside it.
inline void join(Lattice& l, const Band& before, const Band& band, const Band& after) {
  const size_t P = l.plane, S = l.row;
  float *const top = l.populations + band.from * S, *const bottom =
                                                        l.populations + (band.to - 1) * S;
  const int down[] = {1, 5, 7}, up[] = {2, 6, 8};
  for (int i = 0; i < 3; i++) {
    std::memcpy(top + down[i] * P, before.next_row + i * S, 4 * S);
    std::memcpy(bottom + up[i] * P, after.last_row + i * S, 4 * S);
  }
}

// Velocity and 1 / density in the touched blocks of a band, continued beyond the edge. Half a step
// of the surroundings' force has acted on the velocity.
template <Drive DRIVE>
__attribute__((noinline)) void moments(Lattice& l, const Band& band) {
  Vec push_x = all(l.push_x), push_y = all(l.push_y);
  for (int n = 0; n < band.touched_blocks; n++)
    for (int o = band.block[n], end = o + BLOCK; o < end; o += LANES) {
      const size_t x = o / l.wide, y = o % l.wide;
      const float* r = l.populations + x * l.row + y;
      Vec f[9];
      for (int i = 0; i < 9; i++) f[i] = load(r + i * l.plane);
      const Vec deviation =
          f[0] + ((f[1] + f[2]) + (f[3] + f[4])) + ((f[5] + f[6]) + (f[7] + f[8]));
      const Vec d5 = f[5] - f[6], d7 = f[7] - f[8], volume = 1.0f / (1.0f + deviation);
      Vec jx = (f[1] - f[2]) + (d5 + d7), jy = (f[3] - f[4]) + (d5 - d7);
      if (DRIVE == VARIED)
        push_x = load(l.pushes_x + x * l.row + y), push_y = load(l.pushes_y + x * l.row + y);
      if (DRIVE != UNDRIVEN) jx = jx + 0.5f * push_x, jy = jy + 0.5f * push_y;
      const Vec ux = jx * volume, uy = jy * volume;
      store(l.velocity + 2 * size_t(o), zip_low(ux, uy));
      store(l.velocity + 2 * size_t(o) + LANES, zip_high(ux, uy));
      store(l.volume + o, volume);
    }
  for (int n = 0; n < band.beyond_rows; n++) {
    float* u = l.velocity + 2 * l.wide * band.beyond[n];
    float* v = l.volume + l.wide * band.beyond[n];
    for (int i = 0; i < 6; i++) u[2 * l.width + i] = u[i];
    for (int i = 0; i < 3; i++) v[l.width + i] = v[i];
  }
}

}  // namespace microcosmos::ISA
