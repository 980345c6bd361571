// Measures of each step, as in `world.measuring`.
#pragma once
#include "forcing.h"
#include "nodes.h"

namespace microcosmos::ISA {

// The factor that shortened each node's displacement in a step, and the length that is left.
struct Motion {
  Floats shortened, moved;
  explicit Motion(const Bodies& b) : shortened(b.node_slots + BLOCK), moved(b.node_slots + BLOCK) {}
};

class Measuring {
 public:
  Floats edge_here;  // 1 for edges both of whose ends have grown.

  Measuring(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    edge_here = Floats(b.edge_slots + BLOCK), length_ = Floats(b.edge_slots + BLOCK);
    for (Floats& one : sums_) one = Floats(r.bodies + BLOCK);
    edges_.resize(r.bodies);
    for (const Piece& piece : b.pieces) {
      Range& edges = edges_[r.member[piece.node_of[0]]];
      if (edges.to == 0) edges.from = piece.edges.from;
      edges.to = piece.edges.to;
    }
    nodes_of_.assign(r.bodies, 0);
    for (int n = 0; n < r.nodes; n++)
      nodes_here_ += r.present[n], nodes_of_[r.member[n]] += r.present[n];
    for (int e = 0; e < r.edges; e++) {
      const bool here = r.present[r.ends[2 * e]] && r.present[r.ends[2 * e + 1]];
      edge_here[b.edge_slot[e]] = float(here);
      edges_here_ += here;
    }
    nodes_here_ = divisor(nodes_here_), edges_here_ = divisor(edges_here_);
  }

  // Record the measures of a step.
  void record(int t, const Nodes& n, const Forcing& f, const Motion& m, const Member& me) {
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++)
      add_up(t, body, n, f, m);
    measure_edges(n, me.share.edges);
    me.wait();  // Joints read lengths of all edges, and `finish` the sums of all bodies.
    trace(t, n, me);
    if (me.first()) finish(t, n);
  }

 private:
  // Sums over a body.
  enum { X, Y, SPEED, HELD, HEADING, POWER, SUMS };

  void add_up(int t, int body, const Nodes& n, const Forcing& f, const Motion& m) {
    Sum cx, cy, speeds, power, heading, held, fx, fy;
    const Range nodes = b_.bodies[body], edges = edges_[body];
    const Vec pressed = all(f.held[body]);
    each(nodes.from, nodes.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec here = load(n.here + i);
      const Vec limited = load(m.shortened + i) < 1.0f ? all(1) : Vec{};
      cx.add(part, here * load(n.x + i)), cy.add(part, here * load(n.y + i));
      speeds.add(part, here * load(m.moved + i));
      held.add(part, here * most(pressed, limited));
    });
    Forcing::each_point(b_, nodes, r_, [&](int i, int part) __attribute__((always_inline)) {
      const Vec x = load(f.x + i), y = load(f.y + i);
      fx.add(part, x), fy.add(part, y);
      power.add(part, x * load(f.target_x + i) + y * load(f.target_y + i));
    });
    each(edges.from, edges.to, [&](int i, int part) __attribute__((always_inline)) {
      heading.add(part, load(edge_here + i) * load(n.angle + i));
    });
    float* force = r_.force + 2 * (size_t(t) * r_.bodies + body);
    force[0] = fx.total(), force[1] = fy.total();
    std::memcpy(r_.box + 2 * (size_t(t) * r_.bodies + body), n.boxes + 2 * body, 8);
    const Sum* sums[SUMS] = {&cx, &cy, &speeds, &held, &heading, &power};
    for (int one = 0; one < SUMS; one++) sums_[one][body] = sums[one]->total();
  }

  float total(int one) const {
    Sum sum;  // Over bodies, not over members: their number must not change a bit.
    each(0, r_.bodies, [&](int i, int part) __attribute__((always_inline)) {
      sum.add(part, load(sums_[one] + i));
    });
    return sum.total();
  }

  // The measures of all bodies.
  void finish(int t, const Nodes& n) const {
    const float* first = n.boxes + 2 * n.leader;
    for (int body = 0; body < r_.bodies && r_.bodies > 1; body++) {
      const float x = n.boxes[2 * body] - first[0], y = n.boxes[2 * body + 1] - first[1];
      sums_[X][body] += nodes_of_[body] * (x * float(r_.height));
      sums_[Y][body] += nodes_of_[body] * (y * float(r_.width));
    }
    r_.centre[2 * t] = total(X) / nodes_here_, r_.centre[2 * t + 1] = total(Y) / nodes_here_;
    r_.node_speed[t] = total(SPEED) / nodes_here_, r_.held[t] = total(HELD) / nodes_here_;
    r_.power[t] = total(POWER), r_.heading[t] = total(HEADING) / edges_here_;
  }

  void measure_edges(const Nodes& n, Range edges) {
    if (!r_.joints) return;
    each(edges.from, edges.to, [&](int i, int) __attribute__((always_inline)) {
      const bool adjacent = b_.edges.adjacent[i / BLOCK];
      const int32_t *one = &b_.edges.first[i], *other = &b_.edges.second[i];
      const Vec vx = gather(n.x, other, adjacent) - gather(n.x, one, adjacent);
      const Vec vy = gather(n.y, other, adjacent) - gather(n.y, one, adjacent);
      store(length_ + i, root(vx * vx + vy * vy + 1e-24f));
    });
  }

  // The positions of nodes, and the angle at each joint over the mean length of its edges.
  void trace(int t, const Nodes& n, const Member& me) {
    float* path = r_.path + 2 * size_t(t) * r_.nodes;
    const Range nodes = me.part(r_.nodes), blocks = me.part(b_.joints.places() / BLOCK);
    for (int i = nodes.from; i < nodes.to; i++)
      path[2 * i] = n.x[b_.node_slot[i]], path[2 * i + 1] = n.y[b_.node_slot[i]];
    float* out = r_.curvature + size_t(t) * r_.joints;
    const Pairs& joints = b_.joints;
    each(blocks.from * BLOCK, blocks.to * BLOCK, [&](int i, int) __attribute__((always_inline)) {
      const int32_t *one = &joints.first[i], *other = &joints.second[i], *item = &joints.item[i];
      const Vec angle = wrapped(gather(n.angle, other, false) - gather(n.angle, one, false));
      const Vec lengths = gather(length_, one, false) + gather(length_, other, false);
      const Vec here = gather(edge_here, one, false) * gather(edge_here, other, false);
      const Vec bend = here > 0.0f ? 2.0f * angle / lengths : Vec{};
      for (int l = 0; l < LANES; l++)
        if (item[l] >= 0) out[item[l]] = bend[l];
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  List<Range> edges_;  // Slots of each body.
  Floats sums_[SUMS];  // (body)
  Floats length_;
  List<float> nodes_of_;  // (body)
  float nodes_here_ = 0, edges_here_ = 0;
};

}  // namespace microcosmos::ISA
