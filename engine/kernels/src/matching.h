// Shape matching of stiff bodies: Mueller et al., ACM Trans. Graph. 24, 471 (2005).
#pragma once
#include "nodes.h"

namespace microcosmos::ISA {

// Rest shapes of stiff bodies, fitted to where the fluid carried their nodes.
class Matching {
 public:
  Matching(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    direction_ = Floats(b.edge_slots + BLOCK), along_x_ = Floats(b.edge_slots + BLOCK);
    along_y_ = Floats(b.edge_slots + BLOCK);
    goal_x_ = Floats(b.node_slots + BLOCK), goal_y_ = Floats(b.node_slots + BLOCK);
    if (!r.matched) return;  // There is no layout to read.
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

  // Replace new positions by the rest shapes, moved and turned to be nearest to them.
  void apply(Nodes& n, const float* rest_angle, const float* rest_length) {
    for (size_t p = 0; p < b_.pieces.size(); p++) {
      const Piece& piece = b_.pieces[p];
      if (piece.chain)
        chain(piece, rest_angle, rest_length);
      else
        graph(piece, factors_ + starts_[p], rest_angle, rest_length);
      fit(piece, n);
    }
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

  // A filament, from its first edge on.
  void chain(const Piece& p, const float* rest_angle, const float* rest_length) {
    const int count = int(p.edge_of.size());
    float angle = count ? r_.layout_angle[p.edge_of[0]] : 0;
    for (int k = 0; k < count; k++) {
      direction_[b_.edge_slot[p.edge_of[k]]] = angle;
      if (k + 1 < count) angle = angle + rest_angle[p.joint_of[k]];
    }
    measure(p, rest_length);
    float x = 0, y = 0;
    for (int k = 0; k <= count; k++) {
      const int slot = b_.node_slot[p.node_of[k]];
      goal_x_[slot] = x, goal_y_[slot] = y;
      if (k == count) break;
      const int edge = b_.edge_slot[p.edge_of[k]];
      x = x + along_x_[edge], y = y + along_y_[edge];
    }
  }

  // Any graph: by least squares where its branches and loops contradict each other.
  void graph(const Piece& p, const float* factors, const float* rest_angle,
             const float* rest_length) {
    for (int e : p.edge_of) direction_[b_.edge_slot[e]] = r_.layout_angle[e];
    const int edges = p.edges.to - p.edges.from, nodes = p.nodes.to - p.nodes.from;
    for (int j : p.joint_of) {
      const float turn = rest_angle[j] - r_.layout_rest_angle[j];
      for (int i = 0; i < edges; i += LANES) {
        float* d = direction_ + p.edges.from + i;
        store(d, load(d) + turn * load(factors + i));
      }
      factors += edges;
    }
    measure(p, rest_length);
    each(p.nodes.from, p.nodes.to, [&](int i, int) __attribute__((always_inline)) {
      store(goal_x_ + i, Vec{}), store(goal_y_ + i, Vec{});
    });
    for (int e : p.edge_of) {
      const float vx = along_x_[b_.edge_slot[e]], vy = along_y_[b_.edge_slot[e]];
      for (int i = 0; i < nodes; i += LANES) {
        float *x = goal_x_ + p.nodes.from + i, *y = goal_y_ + p.nodes.from + i;
        const Vec factor = load(factors + i);
        store(x, load(x) + vx * factor), store(y, load(y) + vy * factor);
      }
      factors += nodes;
    }
  }

  // The vectors along edges, from their directions.
  void measure(const Piece& p, const float* rest_length) {
    for (int e : p.edge_of) along_x_[b_.edge_slot[e]] = rest_length[e];
    each(p.edges.from, p.edges.to, [&](int i, int) __attribute__((always_inline)) {
      Vec s, c;
      sine_cosine(load(direction_ + i), s, c);
      const Vec length = load(along_x_ + i);
      store(along_x_ + i, c * length), store(along_y_ + i, s * length);
    });
  }

  void fit(const Piece& p, Nodes& n) {
    Sum here, sx, sy, gx, gy;
    each(p.nodes.from, p.nodes.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i);
      here.add(part, h);
      sx.add(part, h * load(n.new_x + i)), sy.add(part, h * load(n.new_y + i));
      gx.add(part, h * load(goal_x_ + i)), gy.add(part, h * load(goal_y_ + i));
    });
    const float count = here.total();
    const float cx = sx.total() / count, cy = sy.total() / count, mx = gx.total() / count,
                my = gy.total() / count;
    Sum cosines, sines;
    each(p.nodes.from, p.nodes.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i), x = load(goal_x_ + i) - mx, y = load(goal_y_ + i) - my;
      const Vec ax = load(n.new_x + i) - cx, ay = load(n.new_y + i) - cy;
      cosines.add(part, h * (x * ax + y * ay)), sines.add(part, h * (x * ay - y * ax));
    });
    float c = cosines.total(), s = sines.total();
    const float size = root(c * c + s * s + 1e-24f);
    c = c / size, s = s / size;
    each(p.nodes.from, p.nodes.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(goal_x_ + i) - mx, y = load(goal_y_ + i) - my;
      store(n.new_x + i, cx + (c * x - s * y)), store(n.new_y + i, cy + (s * x + c * y));
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats direction_, along_x_, along_y_, goal_x_, goal_y_, factors_;
  std::vector<size_t> starts_;
};

}  // namespace microcosmos::ISA
