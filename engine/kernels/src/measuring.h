// Measures of each step, as in `world.measuring`.
#pragma once
#include "forcing.h"
#include "nodes.h"

namespace microcosmos::ISA {

// Of each node in a step: the factor that shortened its displacement, and its length.
struct Motion {
  Floats shortened, moved;
  explicit Motion(const Bodies& b) : shortened(b.node_slots + BLOCK), moved(b.node_slots + BLOCK) {}
};

class Measuring {
 public:
  Floats edge_here;  // 1 for edges both of whose ends have grown.

  Measuring(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    edge_here = Floats(b.edge_slots + BLOCK), length_ = Floats(b.edge_slots + BLOCK);
    for (int n = 0; n < r.nodes; n++) nodes_here_ += r.present[n];
    for (int e = 0; e < r.edges; e++) {
      const bool here = r.present[r.ends[2 * e]] && r.present[r.ends[2 * e + 1]];
      edge_here[b.edge_slot[e]] = float(here);
      edges_here_ += here;
    }
  }

  // Record the measures of a step.
  void record(int t, const Nodes& n, const Forcing& f, const Motion& m) const {
    Sum cx, cy, speeds, power, heading, held;
    each(0, b_.node_slots, [&](int i, int part) __attribute__((always_inline)) {
      const Vec here = load(n.here + i);
      cx.add(part, here * load(n.x + i)), cy.add(part, here * load(n.y + i));
      speeds.add(part, here * load(m.moved + i));
    });
    for (size_t body = 0; body < b_.bodies.size(); body++) {
      Sum fx, fy;
      const Vec pressed = all(f.held[body]);
      Forcing::each_point(b_, b_.bodies[body], r_,
                          [&](int i, int part) __attribute__((always_inline)) {
                            const Vec x = load(f.x + i), y = load(f.y + i);
                            fx.add(part, x), fy.add(part, y);
                            power.add(part, x * load(f.target_x + i) + y * load(f.target_y + i));
                          });
      each(b_.bodies[body].from, b_.bodies[body].to,
           [&](int i, int part) __attribute__((always_inline)) {
             const Vec limited = load(m.shortened + i) < 1.0f ? all(1) : Vec{};
             held.add(part, load(n.here + i) * most(pressed, limited));
           });
      float* force = r_.force + 2 * (size_t(t) * r_.bodies + body);
      force[0] = fx.total(), force[1] = fy.total();
    }
    each(0, b_.edge_slots, [&](int i, int part) __attribute__((always_inline)) {
      heading.add(part, load(edge_here + i) * load(n.angle + i));
    });
    r_.centre[2 * t] = cx.total() / nodes_here_, r_.centre[2 * t + 1] = cy.total() / nodes_here_;
    r_.node_speed[t] = speeds.total() / nodes_here_, r_.held[t] = held.total() / nodes_here_;
    r_.power[t] = power.total(), r_.heading[t] = heading.total() / edges_here_;
    float* path = r_.path + 2 * size_t(t) * r_.nodes;
    for (int i = 0; i < r_.nodes; i++)
      path[2 * i] = n.x[b_.node_slot[i]], path[2 * i + 1] = n.y[b_.node_slot[i]];
    if (r_.joints) curvature(n, r_.curvature + size_t(t) * r_.joints);
  }

 private:
  // The angle at each joint over the mean length of its edges.
  void curvature(const Nodes& n, float* out) const {
    each(0, b_.edge_slots, [&](int i, int) __attribute__((always_inline)) {
      const bool adjacent = b_.edges.adjacent[i / BLOCK];
      const int32_t *one = &b_.edges.first[i], *other = &b_.edges.second[i];
      const Vec vx = gather(n.x, other, adjacent) - gather(n.x, one, adjacent);
      const Vec vy = gather(n.y, other, adjacent) - gather(n.y, one, adjacent);
      store(length_ + i, root(vx * vx + vy * vy + 1e-24f));
    });
    const Pairs& joints = b_.joints;
    each(0, joints.places(), [&](int i, int) __attribute__((always_inline)) {
      const int32_t *one = &joints.first[i], *other = &joints.second[i], *item = &joints.item[i];
      const Vec angle = wrapped(gather(n.angle, other, false) - gather(n.angle, one, false));
      const Vec lengths = gather(length_, one, false) + gather(length_, other, false);
      const Vec here = gather(edge_here, one, false) * gather(edge_here, other, false);
      const Vec found = here > 0.0f ? 2.0f * angle / lengths : Vec{};
      for (int l = 0; l < LANES; l++)
        if (item[l] >= 0) out[item[l]] = found[l];
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats length_;
  float nodes_here_ = 0, edges_here_ = 0;
};

}  // namespace microcosmos::ISA
