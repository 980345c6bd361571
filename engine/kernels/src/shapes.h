// Rest shapes: the layout of a body's nodes by rest angles and rest lengths.
#pragma once
#include "functions.h"
#include "nodes.h"

namespace microcosmos::ISA {

// The forward kinematics of bodies, as `filaments.rest_positions`.
class Shapes {
 public:
  Floats x, y;  // Of nodes, by slots; each piece may be moved and turned.

  Shapes(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    direction_ = Floats(b.edge_slots + BLOCK), along_x_ = Floats(b.edge_slots + BLOCK);
    along_y_ = Floats(b.edge_slots + BLOCK);
    x = Floats(b.node_slots + BLOCK), y = Floats(b.node_slots + BLOCK);
    if (!r.laid_out) return;  // There is no layout to read.
    size_t room = 0;
    for (const Piece& p : b.pieces)
      if (!p.chain) {
        starts_.push_back(room);
        room += p.joint_of.size() * (p.edges.to - p.edges.from) +
                p.edge_of.size() * (p.nodes.to - p.nodes.from);
      } else
        starts_.push_back(0);
    factors_ = Floats(room);
    for (size_t p = 0; p < b.pieces.size(); p++)
      if (!b.pieces[p].chain) transpose(b.pieces[p], factors_ + starts_[p]);
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
  // The rows of both factors of a piece, one for each joint and edge, by slots.
  void transpose(const Piece& p, float* out) {
    const int edges = p.edges.to - p.edges.from, nodes = p.nodes.to - p.nodes.from;
    for (int j : p.joint_of) {
      for (int e : p.edge_of)
        out[b_.edge_slot[e] - p.edges.from] = r_.turned[size_t(e) * r_.joints + j];
      out += edges;
    }
    for (int e : p.edge_of) {
      for (int n : p.node_of)
        out[b_.node_slot[n] - p.nodes.from] = r_.placed[size_t(n) * r_.edges + e];
      out += nodes;
    }
  }

  // Find the directions of a piece's edges.
  void turn(size_t number, const float* rest_angle) {
    const Piece& p = b_.pieces[number];
    if (p.chain) {
      const int count = int(p.edge_of.size());
      float turned = 0;  // Layout angles are within half a turn; what is added to them may not be.
      for (int k = 0; k < count; k++) {
        direction_[b_.edge_slot[p.edge_of[k]]] = r_.layout_angle[p.edge_of[k]] + turned;
        if (k + 1 == count) break;
        const int joint = p.joint_of[k];
        turned = turned + (rest_angle[joint] - r_.layout_rest_angle[joint]);
      }
      return;
    }
    // By least squares where branches and loops contradict each other.
    const float* factors = factors_ + starts_[number];
    for (int e : p.edge_of) direction_[b_.edge_slot[e]] = r_.layout_angle[e];
    const int edges = p.edges.to - p.edges.from;
    for (int j : p.joint_of) {
      const float turn = rest_angle[j] - r_.layout_rest_angle[j];
      for (int i = 0; i < edges; i += LANES) {
        float* d = direction_ + p.edges.from + i;
        store(d, load(d) + turn * load(factors + i));
      }
      factors += edges;
    }
  }

  // Place the nodes of a piece by the directions of its edges.
  void place(size_t number, const float* rest_length) {
    const Piece& p = b_.pieces[number];
    measure(p, rest_length);
    if (p.chain) return follow(p);
    const float* factors =
        factors_ + starts_[number] + p.joint_of.size() * (p.edges.to - p.edges.from);
    const int nodes = p.nodes.to - p.nodes.from;
    each(p.nodes.from, p.nodes.to, [&](int i, int) __attribute__((always_inline)) {
      store(x + i, Vec{}), store(y + i, Vec{});
    });
    for (int e : p.edge_of) {
      const float vx = along_x_[b_.edge_slot[e]], vy = along_y_[b_.edge_slot[e]];
      for (int i = 0; i < nodes; i += LANES) {
        float *to_x = x + p.nodes.from + i, *to_y = y + p.nodes.from + i;
        const Vec factor = load(factors + i);
        store(to_x, load(to_x) + vx * factor), store(to_y, load(to_y) + vy * factor);
      }
      factors += nodes;
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
  Floats direction_, along_x_, along_y_, factors_;
  List<size_t> starts_;
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
  const float nodes = count.total();
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
