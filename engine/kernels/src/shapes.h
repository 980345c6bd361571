// Rest shapes: the layout of a body's nodes by rest angles and rest lengths.
#pragma once
#include "functions.h"
#include "graph.h"
#include "nodes.h"

namespace microcosmos::ISA {

// The forward kinematics of bodies, as `filaments.rest_positions`.
class Shapes {
 public:
  Floats x, y;  // Of nodes, by slots; each piece may be moved and turned.

  // `used`: whether it will be asked for a layout.
  Shapes(const Bodies& b, const Rollout& r, bool used) : b_(b), r_(r) {
    direction_ = Floats(b.edge_slots + BLOCK), along_x_ = Floats(b.edge_slots + BLOCK);
    along_y_ = Floats(b.edge_slots + BLOCK);
    x = Floats(b.node_slots + BLOCK), y = Floats(b.node_slots + BLOCK);
    if (!used) return;
    turn_.resize(r.joints), turned_.resize(r.edges), way_.resize(r.edges), place_.resize(r.nodes);
    for (const Piece& p : b.pieces) {
      List<int32_t> joints, edges, nodes;
      for (int j : p.joint_of)
        if (r.bends[j]) joints.push_back(j);
      // Edges that have not grown lead from a node to itself.
      for (int e : p.edge_of)
        if (r.ends[2 * e] != r.ends[2 * e + 1]) {
          edges.push_back(e);
          for (int side : {0, 1}) {
            const int node = r.ends[2 * e + side];
            if (std::binary_search(p.node_of.begin(), p.node_of.end(), node)) nodes.push_back(node);
          }
        }
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      joints_.push_back(p.chain ? Graph{} : Graph(r.pairs, joints, edges));
      edges_.push_back(p.chain ? Graph{} : Graph(r.ends, edges, nodes));
    }
  }

  // Lay out the nodes of all pieces, or of some.
  void lay_out(const float* rest_angle, const float* rest_length) {
    lay_out(rest_angle, rest_length, {0, int(b_.pieces.size())});
  }
  void lay_out(const float* rest_angle, const float* rest_length, Range pieces) {
    for (int p = pieces.from; p < pieces.to; p++) {
      turn(p, rest_angle);
      place(p, rest_length);
    }
  }

  // The directions of edges, by slots, less those that all edges of a piece share.
  const float* turned(const float* rest_angle) {
    for (size_t p = 0; p < b_.pieces.size(); p++) turn(p, rest_angle);
    return direction_;
  }

 private:
  // Find the directions of a piece's edges.
  void turn(size_t number, const float* rest_angle) {
    const Piece& p = b_.pieces[number];
    for (int j : p.joint_of) turn_[j] = rest_angle[j] - r_.layout_rest_angle[j];
    if (!p.chain) {
      joints_[number].solve(turn_.data(), turned_.data());
      for (int e : p.edge_of) direction_[b_.edge_slot[e]] = r_.layout_angle[e] + turned_[e];
      return;
    }
    const int count = int(p.edge_of.size());
    float turned = 0;  // Layout angles are within half a turn; what is added to them may not be.
    for (int k = 0; k < count; k++) {
      direction_[b_.edge_slot[p.edge_of[k]]] = r_.layout_angle[p.edge_of[k]] + turned;
      if (k + 1 < count) turned = turned + turn_[p.joint_of[k]];
    }
  }

  // Place the nodes of a piece by the directions of its edges.
  void place(size_t number, const float* rest_length) {
    const Piece& p = b_.pieces[number];
    measure(p, rest_length);
    if (p.chain) return follow(p);
    const float* along[2] = {along_x_, along_y_};
    Floats* to[2] = {&x, &y};
    for (int axis : {0, 1}) {
      for (int e : p.edge_of) way_[e] = along[axis][b_.edge_slot[e]];
      edges_[number].solve(way_.data(), place_.data());
      for (int n : p.node_of) (*to[axis])[b_.node_slot[n]] = place_[n];
    }
  }

  // Place the nodes of a filament one after another, which needs no matrix.
  void follow(const Piece& p) {
    const int count = int(p.edge_of.size());
    float at_x = 0, at_y = 0;
    for (int k = 0; k <= count; k++) {
      const int slot = b_.node_slot[p.node_of[k]];
      x[slot] = at_x, y[slot] = at_y;
      if (k == count) break;
      const int edge = b_.edge_slot[p.edge_of[k]];
      at_x = at_x + along_x_[edge], at_y = at_y + along_y_[edge];
    }
  }

  // Find the vectors along edges from their directions.
  void measure(const Piece& p, const float* rest_length) {
    for (int e : p.edge_of) along_x_[b_.edge_slot[e]] = rest_length[e];
    each(p.edges.from, p.edges.to, [&](int i, int) __attribute__((always_inline)) {
      Vec s, c;
      sine_cosine(load(direction_ + i), s, c);
      const Vec length = load(along_x_ + i);
      store(along_x_ + i, c * length), store(along_y_ + i, s * length);
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats direction_, along_x_, along_y_;
  List<Graph> joints_, edges_;               // Of each piece: of its edges, and of its nodes.
  List<float> turn_, turned_, way_, place_;  // (joint), (edge), (edge), (node)
};

// Move and turn a piece of a shape so that its nodes that are `here` come nearest to (x, y), and
// call `take` with the slots and the positions of each vector of nodes.
template <class Take>
INLINE void fit(const Piece& p, const Shapes& shape, const float* here, const float* x,
                const float* y, Take take) {
  Sum count, sx, sy, gx, gy;
  each(p.nodes.from, p.nodes.to, [&](int i, int part) __attribute__((always_inline)) {
    const Vec h = load(here + i);
    count.add(part, h), sx.add(part, h * load(x + i)), sy.add(part, h * load(y + i));
    gx.add(part, h * load(shape.x + i)), gy.add(part, h * load(shape.y + i));
  });
  const float nodes = divisor(count.total());
  const float cx = sx.total() / nodes, cy = sy.total() / nodes;
  const float mx = gx.total() / nodes, my = gy.total() / nodes;
  Sum cosines, sines;
  each(p.nodes.from, p.nodes.to, [&](int i, int part) __attribute__((always_inline)) {
    const Vec h = load(here + i), gx = load(shape.x + i) - mx, gy = load(shape.y + i) - my;
    const Vec ax = load(x + i) - cx, ay = load(y + i) - cy;
    cosines.add(part, h * (gx * ax + gy * ay)), sines.add(part, h * (gx * ay - gy * ax));
  });
  float c = cosines.total(), s = sines.total();
  // A piece of one node has no direction: the constant keeps the division finite.
  const float size = root(c * c + s * s + 1e-24f);
  c = c / size, s = s / size;
  each(p.nodes.from, p.nodes.to, [&](int i, int) __attribute__((always_inline)) {
    const Vec gx = load(shape.x + i) - mx, gy = load(shape.y + i) - my;
    take(i, cx + (c * gx - s * gy), cy + (s * gx + c * gy));
  });
}

}  // namespace microcosmos::ISA
