// The rigid motion of each body away from solid cells, which keeps bodies out of obstacles, as in
// `world.nodes`.
#pragma once
#include "density.h"
#include "nodes.h"

namespace microcosmos::ISA {

class Barrier {
 public:
  Floats drift_x, drift_y;  // Rigid motion of bodies.

  Barrier(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    for (Floats* one : {&drift_x, &drift_y, &away_x_, &away_y_, &weight_})
      *one = Floats(b.node_slots + BLOCK);
  }

  void find(const Nodes& n, const Member& me) {
    for (int p = me.share.pieces.from; p < me.share.pieces.to; p++)
      for (int node : b_.pieces[p].node_of)
        if (r_.present[node]) read(n, b_.node_slot[node]);
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++)
      move(b_.bodies[body], n);
  }

 private:
  // Interpolate the displacement at a node between the four cells around it.
  void read(const Nodes& n, int slot) {
    const int H = r_.height, W = r_.width;
    float dx, dy;
    const int x = cell(n.x[slot], H, dx), y = cell(n.y[slot], W, dy);
    const size_t one = size_t(x) * W, other = size_t(x + 1 < H ? x + 1 : 0) * W;
    const int next = y + 1 < W ? y + 1 : 0;
    auto between = [&](const float* a) {
      return (1 - dx) * ((1 - dy) * a[one + y] + dy * a[one + next]) +
             dx * ((1 - dy) * a[other + y] + dy * a[other + next]);
    };
    const float ax = between(r_.away_x), ay = between(r_.away_y);
    away_x_[slot] = ax, away_y_[slot] = ay, weight_[slot] = root(ax * ax + ay * ay + 1e-24f);
  }

  // Move a body by the mean of displacements, weighted by their lengths, and turn it by the rest.
  void move(Range body, const Nodes& n) {
    Sum count, sx, sy, touching, mx, my, torque;
    Most largest;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i), w = h * load(weight_ + i);
      count.add(part, h), sx.add(part, h * load(n.x + i)), sy.add(part, h * load(n.y + i));
      touching.add(part, w), mx.add(part, w * load(away_x_ + i));
      my.add(part, w * load(away_y_ + i));
    });
    // Above the weights of 1e-12 that untouched nodes have by the guard of their root.
    const float nodes = divisor(count.total()), weight = touching.total() + 1e-9f;
    const float x0 = sx.total() / nodes, y0 = sy.total() / nodes;
    const float x = mx.total() / weight, y = my.total() / weight;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i), w = h * load(weight_ + i);
      const Vec ax = load(n.x + i) - x0, ay = load(n.y + i) - y0;
      torque.add(part, w * (ax * (load(away_y_ + i) - y) - ay * (load(away_x_ + i) - x)));
      largest.add(part, h * (ax * ax + ay * ay));
    });
    const float limit = r_.parameters[BARRIER_LIMIT], tip = root(largest.total() + 1e-24f);
    float turn = torque.total() / weight / tip;
    turn = (turn > limit ? limit : turn < -limit ? -limit : turn) / tip;
    const float factor = limit / root(x * x + y * y + 1e-24f);
    const float shortened = factor < 1 ? factor : 1;
    each(body.from, body.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec ax = load(n.x + i) - x0, ay = load(n.y + i) - y0;
      store(drift_x + i, shortened * x - turn * ay);
      store(drift_y + i, shortened * y + turn * ax);
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats away_x_, away_y_, weight_;
};

}  // namespace microcosmos::ISA
