// Filaments that pass through each other, as in `search.crossing`, which the page has no JAX for.
//
// Only WebAssembly exports it: programs of JAX compute it themselves, and their calls stay as they
// are, because another call would be another program with other bits.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calls.h"

namespace microcosmos {

constexpr int64_t MOST_PAIRS = 1 << 23;  // Over all poses: of larger bodies not each pose counts.
constexpr int SHIFT = 2;                 // A unit of place has 4 recorded levels.

struct Crossing {
  int32_t nodes, edges;
  const float* frames;     // (FRAMES, node, 2) recorded levels
  const int32_t* start;    // (node, 2) units of place
  const int32_t* ends;     // (edge, 2) nodes
  const int32_t* present;  // (node)

  float* share;  // (1) of the poses
};

using Edge = const int32_t*;

// The side of an edge on which a node lies: 1, -1, or 0 on its line. Products of whole numbers are
// exact, so a sign never depends on rounding.
inline int side(const int32_t* at, Edge edge, int32_t node) {
  const int32_t *base = at + 2 * edge[0], *tip = at + 2 * edge[1], *point = at + 2 * node;
  const int64_t x = tip[0] - base[0], y = tip[1] - base[1];
  const int64_t turn = x * (point[1] - base[1]) - y * (point[0] - base[0]);
  return (turn > 0) - (turn < 0);
}

inline bool divides(const int32_t* at, Edge one, Edge other) {
  return side(at, one, other[0]) * side(at, one, other[1]) < 0;
}

inline bool cross(const int32_t* at, Edge one, Edge other) {
  return divides(at, one, other) && divides(at, other, one);
}

// Pairs of edges that are present, share no node, and do not cross at the start.
inline std::vector<std::pair<Edge, Edge>> apart(const Crossing& c) {
  std::vector<std::pair<Edge, Edge>> pairs;
  const auto here = [&](Edge edge) { return c.present[edge[0]] && c.present[edge[1]]; };
  for (int e = 0; e < c.edges; e++)
    for (int f = 0; f < e; f++) {
      const Edge one = c.ends + 2 * e, other = c.ends + 2 * f;
      const bool shared = one[0] == other[0] || one[0] == other[1] || one[1] == other[0] ||
                          one[1] == other[1];
      if (here(one) && here(other) && !shared && !cross(c.start, one, other))
        pairs.emplace_back(one, other);
    }
  return pairs;
}

inline void write(const Crossing& c) {
  const int64_t all = int64_t(FRAMES) * c.edges * c.edges;
  const int64_t fitting = (all + MOST_PAIRS - 1) / MOST_PAIRS;
  const int step = int(std::max<int64_t>(1, std::min<int64_t>(FRAMES, fitting)));
  const auto pairs = apart(c);
  std::vector<int32_t> at(2 * c.nodes);
  int crossed = 0, counted = 0;
  for (int frame = step - 1; frame < FRAMES; frame += step, counted++) {
    const float* levels = c.frames + size_t(frame) * at.size();
    // A shift rounds down, as a division of integers in Python does.
    for (size_t i = 0; i < at.size(); i++) at[i] = int32_t(levels[i]) >> SHIFT;
    crossed += std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
      return cross(at.data(), pair.first, pair.second);
    });
  }
  // As XLA takes a mean: times the reciprocal of a constant.
  *c.share = float(crossed) * (1.0f / float(counted));
}

// The numbers of the call, its arrays, and whether the body refers to nothing that is not there.
template <class Numbers>
std::string read_crossing(Crossing& c, Numbers number) {
  c.nodes = number("nodes"), c.edges = number("edges");
  if (!number.error.empty()) return number.error;
  return c.nodes < 1 || c.edges < 0 ? "a body has at least one node" : "";
}

template <class Arrays>
void name_crossing(Arrays& a, Crossing& c) {
  a.in("frames", &c.frames, {FRAMES, c.nodes, 2}), a.in("whole", &c.start, {c.nodes, 2});
  a.in("edges", &c.ends, {c.edges, 2}), a.in("present", &c.present, {c.nodes});
  a.out("crossing", &c.share, {1});
  a.end();
}

inline bool sound(const Crossing& c) {
  return within(c.ends, 2 * c.edges, 0, c.nodes) && within(c.present, c.nodes, 0, 2);
}

}  // namespace microcosmos
