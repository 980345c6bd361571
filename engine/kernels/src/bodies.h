// Bodies as slots: nodes and edges in an order in which neighbours fill vectors.
//
// Each connected piece of a body has a range of slots, a multiple of BLOCK: its even nodes, then
// its odd ones, each half filled up. So along a filament the nodes that the even edges join, or
// the odd ones, stand in two vectors. Other graphs work too: where slots do not follow each
// other they are gathered.
#pragma once
#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "memory.h"
#include "rollout.h"
#include "threads.h"
#include "vectors.h"

namespace microcosmos::ISA {

// Pairs of slots (the ends of edges, or the edges of joints) in blocks of 16.
struct Pairs {
  List<int32_t> first, second;  // Slots; what fills up a block follows the last pair.
  List<int32_t> item;           // Edge or joint of each place; -1: none.
  List<int32_t> own;            // Slot of an edge, or of a joint's first edge.
  List<uint8_t> adjacent;       // Of each block: all lists of slots are consecutive.

  int places() const { return int(first.size()); }

  void add(int one, int other, int number, int slot) {
    first.push_back(one), second.push_back(other), item.push_back(number), own.push_back(slot);
  }

  // Fill up the last block, with slots before these ends: those beyond may belong to others.
  void fill(int end, int own_end) {
    while (first.size() % BLOCK)
      add(std::min(first.back() + 1, end - 1), std::min(second.back() + 1, end - 1), -1,
          std::min(own.back() + 1, own_end - 1));
    adjacent.resize(first.size() / BLOCK);
    for (int block = 0; block < int(adjacent.size()); block++) adjacent[block] = consecutive(block);
  }

 private:
  // A vector that is stored also covers the places that fill up its block. `second` is stored
  // before `first`, which therefore must not cover a slot of `second`.
  bool consecutive(int block) const {
    const int32_t *a = &first[block * BLOCK], *b = &second[block * BLOCK], *c = &own[block * BLOCK];
    for (int i = 0; i < BLOCK; i++) {
      if (a[i] != a[0] + i || b[i] != b[0] + i || c[i] != c[0] + i) return false;
      if (item[block * BLOCK + i] >= 0 && b[i] >= a[0] && b[i] < a[0] + BLOCK) return false;
    }
    return true;
  }
};

// Read the values at the slots of one vector of pairs.
INLINE Vec gather(const float* values, const int32_t* slots, bool adjacent) {
  if (adjacent) return load(values + slots[0]);
  float gathered[LANES];
  for (int i = 0; i < LANES; i++) gathered[i] = values[slots[i]];
  return load(gathered);
}

INLINE void scatter(float* values, const int32_t* slots, const int32_t* item, bool adjacent,
                    Vec v) {
  if (adjacent) return store(values + slots[0], v);
  for (int i = 0; i < LANES; i++)
    if (item[i] >= 0) values[slots[i]] = v[i];
}

// A connected piece; `chain`: a single filament whose edges and joints stand in order.
struct Piece {
  Range nodes, edges;  // Slots.
  List<int32_t> node_of, edge_of, joint_of;
  bool chain = false;
};

// What one member of a team works on, from bodies to the tiles and filaments of their sweeps.
struct Share {
  Range bodies, pieces, nodes, edges, tiles, filaments;  // Nodes and edges: slots.
};

// One member of a team, whose threads take each part of a step together.
struct Member {
  int number;
  Share share;
  Team& team;

  void wait() const { team.wait(); }
  bool first() const { return number == 0; }
  // Its part of `count` things that need not be those of its share.
  Range part(int64_t count) const {
    return {int(count * number / team.size()), int(count * (number + 1) / team.size())};
  }
};

struct Bodies {
  List<Piece> pieces;
  List<Range> bodies;  // Slots of nodes.
  List<int32_t> node_slot, edge_slot;
  int node_slots = 0, edge_slots = 0;
  Pairs edges;   // In the order of their slots.
  Pairs joints;  // In their order.
  // Of sweeps: constraints by tile (bodies that fit a near cache), then colour.
  struct Tile {
    Range pieces;
    List<Pairs> edge_colours, joint_colours;
  };
  List<Tile> tiles;
  List<int32_t> filaments;  // Pieces that are swept in registers instead.

  explicit Bodies(const Rollout& r);

  // Whole bodies for each of `count` members of a team, with about as many nodes.
  List<Share> shares(const Rollout& r, int count) const;

 private:
  void place_nodes(const Rollout& r);
  void place_edges(const Rollout& r);
  void colour(const Rollout& r);
  bool is_filament(const Rollout& r, const Piece& piece) const;
};

inline int halves(int count) { return (((count + 1) / 2 + BLOCK - 1) / BLOCK) * BLOCK; }

inline Bodies::Bodies(const Rollout& r) {
  place_nodes(r);
  place_edges(r);
  colour(r);
}

inline void Bodies::place_nodes(const Rollout& r) {
  List<int> order(r.nodes);
  std::iota(order.begin(), order.end(), 0);
  auto key = [&](int n) { return std::make_tuple(r.member[n], r.piece[n], n); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  node_slot.resize(r.nodes);
  bodies.assign(r.bodies, {0, 0});
  for (int i = 0; i < r.nodes;) {
    const int body = r.member[order[i]], piece = r.piece[order[i]];
    Piece next;
    for (; i < r.nodes && r.member[order[i]] == body && r.piece[order[i]] == piece; i++)
      next.node_of.push_back(order[i]);
    const int count = int(next.node_of.size()), half = halves(count);
    for (int k = 0; k < count; k++)
      node_slot[next.node_of[k]] = node_slots + (k & 1) * half + k / 2;
    next.nodes = {node_slots, node_slots + 2 * half};
    if (bodies[body].to == 0) bodies[body].from = node_slots;
    node_slots = bodies[body].to = next.nodes.to;
    pieces.push_back(next);
  }
}

inline void Bodies::place_edges(const Rollout& r) {
  List<int> piece_of_slot(node_slots);
  for (int p = 0; p < int(pieces.size()); p++)
    std::fill(piece_of_slot.begin() + pieces[p].nodes.from,
              piece_of_slot.begin() + pieces[p].nodes.to, p);
  for (int e = 0; e < r.edges; e++)
    pieces[piece_of_slot[node_slot[r.ends[2 * e]]]].edge_of.push_back(e);
  edge_slot.resize(r.edges);
  for (Piece& piece : pieces) {
    const int count = int(piece.edge_of.size()), half = halves(count);
    for (int k = 0; k < count; k++)
      edge_slot[piece.edge_of[k]] = edge_slots + (k & 1) * half + k / 2;
    piece.edges = {edge_slots, edge_slots + 2 * half};
    edge_slots += 2 * half;
  }
  for (int j = 0; j < r.joints; j++)
    pieces[piece_of_slot[node_slot[r.ends[2 * r.pairs[2 * j]]]]].joint_of.push_back(j);
  for (Piece& piece : pieces) {
    const auto &nodes = piece.node_of, &edges_of = piece.edge_of, &joints_of = piece.joint_of;
    piece.chain = edges_of.size() + 1 == nodes.size() && joints_of.size() + 1 == edges_of.size();
    for (size_t k = 0; piece.chain && k < edges_of.size(); k++)
      piece.chain =
          r.ends[2 * edges_of[k]] == nodes[k] && r.ends[2 * edges_of[k] + 1] == nodes[k + 1];
    for (size_t k = 0; piece.chain && k < joints_of.size(); k++)
      piece.chain = r.pairs[2 * joints_of[k]] == edges_of[k] &&
                    r.pairs[2 * joints_of[k] + 1] == edges_of[k + 1];
  }
  List<int> edge_at(edge_slots, -1);
  for (int e = 0; e < r.edges; e++) edge_at[edge_slot[e]] = e;
  int one = 0, other = 0;
  for (const Piece& piece : pieces)
    for (int slot = piece.edges.from; slot < piece.edges.to; slot++) {
      // A slot without an edge continues the run of its neighbours, so that a block with a gap at
      // its end still counts as consecutive.
      const int e = edge_at[slot], last = piece.nodes.to - 1;
      one = e < 0 ? std::min(one + 1, last) : node_slot[r.ends[2 * e]];
      other = e < 0 ? std::min(other + 1, last) : node_slot[r.ends[2 * e + 1]];
      edges.add(one, other, e, slot);
    }
  for (int j = 0; j < r.joints; j++)
    joints.add(edge_slot[r.pairs[2 * j]], edge_slot[r.pairs[2 * j + 1]], j,
               edge_slot[r.pairs[2 * j]]);
  edges.fill(node_slots, edge_slots), joints.fill(edge_slots, edge_slots);
}

// Return whether a piece is a filament short enough for registers, whose colours take turns.
inline bool Bodies::is_filament(const Rollout& r, const Piece& piece) const {
  // `Sweeps::apply` has programs for at most four blocks of each half.
  bool fits = piece.chain && piece.nodes.to - piece.nodes.from <= 8 * BLOCK;
  for (size_t k = 0; k < piece.edge_of.size(); k++)
    fits = fits && r.edge_colour[piece.edge_of[k]] == int(k & 1);
  for (size_t k = 0; k < piece.joint_of.size(); k++)
    fits = fits && r.joint_colour[piece.joint_of[k]] == int(k & 1);
  return fits;
}

inline void Bodies::colour(const Rollout& r) {
  if (r.matched) return;
  constexpr int TILE = 512;               // Slots.
  using Constraint = std::array<int, 5>;  // Colour, slots of the pair, number, own slot.
  auto coloured = [](List<Pairs>& colours, List<Constraint>& constraints, int end, int own) {
    // By colour, which orders the sweep, then by slot, so that neighbours fill vectors.
    std::sort(constraints.begin(), constraints.end());
    for (auto [colour, one, other, item, slot] : constraints) {
      if (colour >= int(colours.size())) colours.resize(colour + 1);
      colours[colour].add(one, other, item, slot);
    }
    for (Pairs& pairs : colours) pairs.fill(end, own);
  };
  for (size_t p = 0; p < pieces.size();) {
    Tile tile;
    tile.pieces.from = int(p);
    List<Constraint> tile_edges, tile_joints;
    const int start = pieces[p].nodes.from;
    do {
      if (is_filament(r, pieces[p])) {
        filaments.push_back(int(p));
        continue;
      }
      for (int e : pieces[p].edge_of)
        tile_edges.push_back({r.edge_colour[e], node_slot[r.ends[2 * e]],
                              node_slot[r.ends[2 * e + 1]], e, edge_slot[e]});
      for (int j : pieces[p].joint_of) {
        const int one = edge_slot[r.pairs[2 * j]], other = edge_slot[r.pairs[2 * j + 1]];
        tile_joints.push_back({r.joint_colour[j], one, other, j, one});
      }
    } while (++p < pieces.size() && pieces[p].nodes.to - start <= TILE);
    const Piece& last = pieces[p - 1];
    coloured(tile.edge_colours, tile_edges, last.nodes.to, last.edges.to);
    coloured(tile.joint_colours, tile_joints, last.edges.to, last.edges.to);
    tile.pieces.to = int(p);
    if (!tile.edge_colours.empty()) tiles.push_back(std::move(tile));
  }
}

// Return whether no edge and no joint joins two bodies. The engine makes no other graph, but the
// boundary lets it pass: then one member takes all bodies.
inline bool apart(const Rollout& r) {
  auto body_of = [&](int edge, int end) { return r.member[r.ends[2 * edge + end]]; };
  bool separate = true;
  for (int e = 0; e < r.edges; e++) separate = separate && body_of(e, 0) == body_of(e, 1);
  for (int j = 0; j < r.joints; j++)
    separate = separate && body_of(r.pairs[2 * j], 0) == body_of(r.pairs[2 * j + 1], 0);
  return separate;
}

inline List<Share> Bodies::shares(const Rollout& r, int count) const {
  // A share begins with a body and does not cut a tile.
  auto body = [&](int piece) { return r.member[pieces[piece].node_of[0]]; };
  List<uint8_t> begins(pieces.size(), apart(r));
  for (size_t p = 1; p < pieces.size(); p++) begins[p] = begins[p] && body(p) != body(p - 1);
  for (const Tile& tile : tiles)
    for (int p = tile.pieces.from + 1; p < tile.pieces.to; p++) begins[p] = 0;
  List<Share> shares(count);
  const int end = int(pieces.size());
  for (int n = 0, piece = 0, tile = 0, filament = 0; n < count; n++) {
    Share& s = shares[n];
    s.pieces.from = piece, s.tiles.from = tile, s.filaments.from = filament;
    const int64_t goal = int64_t(node_slots) * (n + 1) / count;
    while (piece < end && (piece == s.pieces.from || n + 1 == count || !begins[piece] ||
                           pieces[piece].nodes.from < goal))
      piece++;
    while (tile < int(tiles.size()) && tiles[tile].pieces.from < piece) tile++;
    while (filament < int(filaments.size()) && filaments[filament] < piece) filament++;
    s.pieces.to = piece, s.tiles.to = tile, s.filaments.to = filament;
    const bool some = piece > s.pieces.from;
    s.nodes.from = some ? pieces[s.pieces.from].nodes.from : node_slots;
    s.edges.from = some ? pieces[s.pieces.from].edges.from : edge_slots;
    s.bodies.from = !some ? r.bodies : n == 0 ? 0 : body(s.pieces.from);
  }
  for (int n = 0; n < count; n++) {
    const bool last = n + 1 == count;
    shares[n].nodes.to = last ? node_slots : shares[n + 1].nodes.from;
    shares[n].edges.to = last ? edge_slots : shares[n + 1].edges.from;
    shares[n].bodies.to = last ? r.bodies : shares[n + 1].bodies.from;
  }
  return shares;
}

}  // namespace microcosmos::ISA
