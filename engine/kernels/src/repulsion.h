// Repulsion between nodes, down the gradient of their smoothed density, as in `world.nodes` and
// `fields.steric`.
#pragma once
#include <optional>

#include "density.h"
#include "meetings.h"
#include "nodes.h"

namespace microcosmos::ISA {

class Repulsion {
 public:
  Floats push_x, push_y;    // Displacements within bodies, without their rigid motion.
  Floats drift_x, drift_y;  // Rigid motion of bodies that touch each other.

  Repulsion(const Bodies& b, const Rollout& r, const List<Share>& shares)
      : b_(b), r_(r), density_(r, int(shares.size())), clusters_(r.bodies) {
    for (Floats* one : {&push_x, &push_y, &drift_x, &drift_y}) *one = Floats(b.node_slots + BLOCK);
    factor_.assign(r.bodies, 1), touched_.assign(r.bodies, 0), rigid_.assign(r.bodies, {});
    if (!r.repelled) return;
    // Bodies of which nothing has grown stand nowhere.
    anchor_x_.assign(r.bodies, __builtin_nanf("")), anchor_y_.assign(r.bodies, __builtin_nanf(""));
    if (r.paired) {
      capped_.assign(shares.size(), 0);
      meetings_.emplace(b, r, !r.matched || r.soft, int(shares.size()));
      return;
    }
    for (const Share& share : shares) {
      const int from = int(order_.size());
      for (int p = share.pieces.from; p < share.pieces.to; p++)
        for (int node : b.pieces[p].node_of)
          if (r.present[node]) order_.push_back(b.node_slot[node]);
      parts_.push_back({from, int(order_.size())});
    }
    places_.resize(order_.size());
  }

  // The density of other bodies at a slot.
  float others(int slot) const { return meetings_ ? meetings_->others[slot] : 0; }
  // Whether a body touches others, and whether this moved it less than it would.
  bool touched(int body) const { return touched_[body]; }
  bool limited(int body) const { return touched_[body] && factor_[body] < 1; }

  void find(const Nodes& n, const Member& me) {
    if (r_.paired) return meet(n, me);
    const Range mine = parts_[me.number];
    for (int i = mine.from; i < mine.to; i++)
      places_[i] = density_.place(n.x[order_[i]], n.y[order_[i]]);
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++)
      if (n.anchor[body] >= 0)
        anchor_x_[body] = n.x[n.anchor[body]], anchor_y_[body] = n.y[n.anchor[body]];
    me.wait();  // A row adds up nodes of all members,
    density_.deposit(places_, me);
    me.wait();  // columns pass through rows of all members,
    density_.differentiate(me);
    me.wait();  // and a node reads gradients of all rows.
    const float strength = -r_.parameters[REPULSION];
    for (int i = mine.from; i < mine.to; i++) {
      float gx, gy;
      density_.read(places_[i], gx, gy);
      push_x[order_[i]] = strength * gx, push_y[order_[i]] = strength * gy;
    }
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++)
      divide(body, b_.bodies[body], n);
  }

 private:
  struct Rigid {
    float x, y, spin;
  };
  struct Frame {
    float nodes, x, y, inertia;
  };

  // Find displacements where bodies meet.
  void meet(const Nodes& n, const Member& me) {
    const Range bodies = me.share.bodies;
    for (int body = bodies.from; body < bodies.to; body++) {
      touched_[body] = 0;
      if (n.anchor[body] >= 0)
        anchor_x_[body] = n.x[n.anchor[body]], anchor_y_[body] = n.y[n.anchor[body]];
    }
    meetings_->find(n, me);
    for (const auto& [body, other] : meetings_->touching[me.number]) touched_[body] = 1;
    capped_[me.number] = 0;
    for (int body = bodies.from; body < bodies.to; body++) {
      move(body, b_.bodies[body], n);
      capped_[me.number] |= factor_[body] < 1;
    }
    me.wait();  // Factors of all bodies are known.
    if (std::any_of(capped_.begin(), capped_.end(), [](uint8_t one) { return one; })) {
      if (me.first()) clusters_.share(meetings_->touching, factor_.data());
      me.wait();
    }
    for (int body = bodies.from; body < bodies.to; body++) {
      const Frame f = frame(b_.bodies[body], n);
      const float turn = factor_[body] * rigid_[body].spin;
      const float x = factor_[body] * rigid_[body].x, y = factor_[body] * rigid_[body].y;
      each(b_.bodies[body], [&](int i, int) __attribute__((always_inline)) {
        const Vec ax = load(n.x + i) - f.x, ay = load(n.y + i) - f.y;
        store(drift_x + i, x - turn * ay), store(drift_y + i, y + turn * ax);
      });
    }
  }

  // Find the rigid motion of a body by others, the share of it that is within the limit, and in a
  // soft body what is left of the displacements of its nodes.
  void move(int number, Range body, const Nodes& n) {
    const float strength = -r_.parameters[REPULSION], limit = r_.parameters[REPULSION_LIMIT];
    const Meetings& m = *meetings_;
    rigid_[number] = {}, factor_[number] = 1;
    part(number, rigid_[number]);
    const bool soft = !r_.matched || r_.soft;
    if (!touched_[number] && !soft) return;
    const Frame f = frame(body, n);
    auto push = [&](bool own) {
      each(body, [&](int i, int) __attribute__((always_inline)) {
        Vec x = load(m.others_x + i), y = load(m.others_y + i);
        if (own) x = x + load(m.own_x + i), y = y + load(m.own_y + i);
        store(push_x + i, strength * x), store(push_y + i, strength * y);
      });
      return rigid_part(body, n, f);
    };
    if (touched_[number]) {
      Rigid& rigid = rigid_[number];
      const Rigid found = push(false);
      rigid.x += found.x, rigid.y += found.y, rigid.spin = found.spin;
      Most farthest;
      each(body, [&](int i, int part) __attribute__((always_inline)) {
        const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
        farthest.add(part, load(n.here + i) * (x * x + y * y));
      });
      const float moved = root(rigid.x * rigid.x + rigid.y * rigid.y + 1e-24f);
      const float tip = root(rigid.spin * rigid.spin * farthest.total() + 1e-24f);
      const float most = limit / (moved > tip ? moved : tip);
      factor_[number] = most < 1 ? most : 1;
    }
    if (soft) {
      capped(body, n, f, push(true), limit);
      // The cap has changed the sums, so the rigid part goes a second time.
      remove(body, n, f, rigid_part(body, n, f));
    } else
      each(body, [&](int i, int) __attribute__((always_inline)) {
        store(push_x + i, Vec{}), store(push_y + i, Vec{});
      });
  }

  // Divide the displacements of a body into those within it and its rigid motion.
  void divide(int number, Range body, const Nodes& n) {
    const float limit = r_.parameters[REPULSION_LIMIT];
    const Frame f = frame(body, n);
    Rigid rigid = rigid_part(body, n, f);
    float most_turned = 0, sum = 0;
    if (r_.bodies > 1) {
      Most largest;
      Sum squares;
      each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
        const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
        const Vec square = load(n.here + i) * ((rigid.spin * rigid.spin) * (x * x + y * y));
        largest.add(part, square), squares.add(part, square);
      });
      most_turned = largest.total(), sum = squares.total();
    }
    capped(body, n, f, rigid, limit);
    // The cap has changed the sums, so the rigid part goes a second time.
    const Rigid rest = rigid_part(body, n, f);
    remove(body, n, f, rest);
    if (r_.bodies < 2) return;
    part(number, rigid);
    drift(body, n, f, rigid, most_turned, sum);
  }

  // Add a displacement that parts bodies which stand in exactly one place: there they push each
  // other nowhere. Of n such bodies each takes another of n directions, so that the displacements
  // of equal bodies add up to nothing.
  void part(int body, Rigid& rigid) const {
    constexpr float TIE = 1e-4f;  // The next steps make it grow.
    const float x = anchor_x_[body], y = anchor_y_[body];
    int count = 0, before = 0;
    for (int other = 0; other < r_.bodies; other++) {
      const int same = (anchor_x_[other] == x) & (anchor_y_[other] == y);
      count += same, before += same & (other < body);
    }
    if (count < 2) return;
    Vec s, c;
    // Along a filament they would slide over each other: few have just this direction.
    sine_cosine_any(all(1 + 6.2831855f * float(before) / float(count)), s, c);
    rigid.x += TIE * c[0], rigid.y += TIE * s[0];
  }

  Frame frame(Range body, const Nodes& n) const {
    Sum count, sx, sy, inertia;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i);
      count.add(part, h), sx.add(part, h * load(n.x + i)), sy.add(part, h * load(n.y + i));
    });
    Frame f = {};
    f.nodes = divisor(count.total()), f.x = sx.total() / f.nodes, f.y = sy.total() / f.nodes;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      inertia.add(part, load(n.here + i) * (x * x + y * y));
    });
    f.inertia = divisor(inertia.total());
    return f;
  }

  Rigid rigid_part(Range body, const Nodes& n, const Frame& f) const {
    Sum sx, sy, turning;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i);
      sx.add(part, h * load(push_x + i)), sy.add(part, h * load(push_y + i));
    });
    Rigid rigid = {sx.total() / f.nodes, sy.total() / f.nodes, 0};
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      const Vec ex = load(push_x + i) - rigid.x, ey = load(push_y + i) - rigid.y;
      turning.add(part, load(n.here + i) * (x * ey - y * ex));
    });
    rigid.spin = turning.total() / f.inertia;
    return rigid;
  }

  void remove(Range body, const Nodes& n, const Frame& f, const Rigid& rigid) {
    each(body.from, body.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      store(push_x + i, load(push_x + i) - (rigid.x - rigid.spin * y));
      store(push_y + i, load(push_y + i) - (rigid.y + rigid.spin * x));
    });
  }

  // Remove the rigid motion from displacements, then shorten each to `limit`.
  void capped(Range body, const Nodes& n, const Frame& f, const Rigid& rigid, float limit) {
    remove(body, n, f, rigid);
    each(body.from, body.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(push_x + i), y = load(push_y + i);
      const Vec factor = least(all(1), limit / root(x * x + y * y + 1e-24f));
      store(push_x + i, x * factor), store(push_y + i, y * factor);
    });
  }

  // Find the translation and the rotation of a body by contact, both limited; see `nodes._turned`.
  void drift(Range body, const Nodes& n, const Frame& f, const Rigid& rigid, float most_turned,
             float sum) {
    const float limit = r_.parameters[REPULSION_LIMIT];
    const float square = rigid.x * rigid.x + rigid.y * rigid.y, moved = root(square + 1e-24f);
    const float tip = root(most_turned + 1e-24f), mean = sum / f.nodes;
    const float bound = limit / tip, by_push = moved * tip / (mean + 1e-24f);
    float turn = bound < by_push ? bound : by_push;
    turn = rigid.spin * (turn < 1 ? turn : 1);
    const float shortened = limit / moved < 1 ? limit / moved : 1;
    each(body.from, body.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      store(drift_x + i, shortened * rigid.x - turn * y);
      store(drift_y + i, shortened * rigid.y + turn * x);
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Density density_;
  List<int32_t> order_;  // Slots of nodes that have grown, and the part of each share.
  List<Range> parts_;
  List<Place> places_;
  List<float> anchor_x_, anchor_y_;  // Of each body.
  std::optional<Meetings> meetings_;
  Clusters clusters_;
  List<float> factor_;     // On the motion of each body by contact.
  List<uint8_t> touched_;  // Each body that touches others.
  List<Rigid> rigid_;
  List<uint8_t> capped_;  // Of each member: whether a factor is below 1.
};

}  // namespace microcosmos::ISA
