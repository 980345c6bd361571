// Multi-direct forcing: the force at the points that makes the fluid follow the bodies.
//
// Wang, Fan and Luo, Int. J. Multiphase Flow 34, 283 (2008), with step lengths and projections as
// in `coupling.forcing`.
#pragma once
#include "points.h"

namespace microcosmos::ISA {

struct Forcing {
  Floats velocity_x, velocity_y;  // Of the fluid at the points.
  Floats target_x, target_y;      // Of the points; loses its rigid part.
  Floats x, y;                    // The forcing.
  Floats beta;
  Floats held;  // Of each body: 1 where the limit acted.

  Forcing(const Points& p, int bodies) : frames_(bodies) {
    for (Floats* one :
         {&velocity_x, &velocity_y, &target_x, &target_y, &x, &y, &beta, &reached_x_, &reached_y_})
      *one = Floats(p.slots + BLOCK);
    held = Floats(bodies);
  }

  void find(const Bodies& b, Points& p, Lattice& l, const Rollout& r, const Member& me) {
    const float limit = r.parameters[FORCE_LIMIT], *lengths = r.parameters + STEP_LENGTHS;
    cover(p, l, me);
    me.wait();  // A point's window lies in the bands of several members.
    relaxation(p, l, beta, me);
    const Range bodies = me.share.bodies;
    for (int body = bodies.from; body < bodies.to; body++)
      frames_[body] = frame(b, b.bodies[body], p, r);
    each_point(b, me.share.nodes, r, [&](int i, int) __attribute__((always_inline)) {
      for (float* one : {x + i, y + i, reached_x_ + i, reached_y_ + i}) store(one, Vec{});
    });
    for (int n = 0; n < r.iterations; n++) {
      if (n) {  // Nothing is forced yet in the first iteration: there is nothing to spread.
        me.wait();  // A cell adds the forcing of points of all members,
        spread<false>(p, l, x, y, me);
        me.wait();  // and a point reads cells of all bands.
        interpolate<true>(p, l, l.force, reached_x_, reached_y_, me);
      }
      for (int body = bodies.from; body < bodies.to; body++)
        improve(b, b.bodies[body], frames_[body], p, r, lengths[n]);
    }
    for (int body = bodies.from; body < bodies.to; body++) {
      // One factor for all points of a body, so that sums of force and torque stay zero.
      Most largest;
      each_point(b, b.bodies[body], r, [&](int i, int part) __attribute__((always_inline)) {
        const Vec fx = load(x + i), fy = load(y + i);
        largest.add(part, fx * fx + fy * fy);
      });
      float scale = limit / root(largest.total() + 1e-24f);
      held[body] = scale < 1;
      scale = r.parameters[FORCE_FACTOR] * (scale < 1 ? scale : 1);
      each_point(b, b.bodies[body], r, [&](int i, int) __attribute__((always_inline)) {
        store(x + i, scale * load(x + i)), store(y + i, scale * load(y + i));
      });
    }
  }

  template <class Work>
  INLINE static void each_point(const Bodies& b, Range nodes, const Rollout& r, Work work) {
    for (int layer = 0; layer < r.layers; layer++)
      each(layer * b.node_slots + nodes.from, layer * b.node_slots + nodes.to, work);
  }

 private:
  struct Frame {
    float weight, x, y, inertia;  // Sum of beta, its centre, and its moment about that.
  };

  Frame frame(const Bodies& b, Range nodes, const Points& p, const Rollout& r) {
    Sum weight, sx, sy, inertia;
    each_point(b, nodes, r, [&](int i, int part) __attribute__((always_inline)) {
      const Vec w = load(beta + i);
      weight.add(part, w), sx.add(part, w * load(p.x + i)), sy.add(part, w * load(p.y + i));
    });
    Frame f;
    f.weight = divisor(weight.total());
    f.x = sx.total() / f.weight, f.y = sy.total() / f.weight;
    each_point(b, nodes, r, [&](int i, int part) __attribute__((always_inline)) {
      const Vec ax = load(p.x + i) - f.x, ay = load(p.y + i) - f.y;
      inertia.add(part, load(beta + i) * (ax * ax + ay * ay));
    });
    f.inertia = divisor(inertia.total());
    return f;
  }

  // Add to the forcing of a body what removes its slip, without its rigid part.
  void improve(const Bodies& b, Range nodes, const Frame& f, const Points& p, const Rollout& r,
               float length) {
    auto slip = [&](int i, Vec& ex, Vec& ey) __attribute__((always_inline)) {
      ex = load(target_x + i) - load(velocity_x + i) - load(reached_x_ + i);
      ey = load(target_y + i) - load(velocity_y + i) - load(reached_y_ + i);
    };
    float mx = 0, my = 0, spin = 0;
    if (r.projection != NOTHING) {
      Sum sx, sy;
      each_point(b, nodes, r, [&](int i, int part) __attribute__((always_inline)) {
        Vec ex, ey;
        slip(i, ex, ey);
        sx.add(part, load(beta + i) * ex), sy.add(part, load(beta + i) * ey);
      });
      mx = sx.total() / f.weight, my = sy.total() / f.weight;
    }
    if (r.projection == FORCE_AND_TORQUE) {
      Sum turning;
      each_point(b, nodes, r, [&](int i, int part) __attribute__((always_inline)) {
        Vec ex, ey;
        slip(i, ex, ey);
        const Vec ax = load(p.x + i) - f.x, ay = load(p.y + i) - f.y;
        turning.add(part, load(beta + i) * (ax * (ey - my) - ay * (ex - mx)));
      });
      spin = turning.total() / f.inertia;
    }
    each_point(b, nodes, r, [&](int i, int) __attribute__((always_inline)) {
      Vec ex, ey;
      slip(i, ex, ey);
      const Vec rx = mx - spin * (load(p.y + i) - f.y), ry = my + spin * (load(p.x + i) - f.x);
      const Vec step = length * load(beta + i);
      store(x + i, load(x + i) + step * (ex - rx)), store(y + i, load(y + i) + step * (ey - ry));
      store(target_x + i, load(target_x + i) - rx), store(target_y + i, load(target_y + i) - ry);
    });
  }

  Floats reached_x_, reached_y_;
  List<Frame> frames_;
};

}  // namespace microcosmos::ISA
