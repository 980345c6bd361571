// A rollout: steps of one world, in the order of `world.step`, and the measures of each.
#pragma once
#include <chrono>

#include "actuators.h"
#include "barrier.h"
#include "controller.h"
#include "energy.h"
#include "measuring.h"
#include "repulsion.h"
#include "rings.h"
#include "slots.h"
#include "surroundings.h"
#include "sweeps.h"

namespace microcosmos::ISA {

// Adds the time since the last call to a part, if times are taken.
class Stopwatch {
 public:
  explicit Stopwatch(float* seconds) : seconds_(seconds) {}
  // Start again, without counting the time until now.
  void start() {
    if (seconds_ != nullptr) last_ = Clock::now();
  }
  INLINE void stop(Part part) {
    if (__builtin_expect(seconds_ != nullptr, 0)) {
      const auto now = Clock::now();
      seconds_[part] += std::chrono::duration<float>(now - last_).count();
      last_ = now;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  float* seconds_;
  Clock::time_point last_;
};

class World {
 public:
  // With `creatures` these are the bodies of `r`, and command their own rest shapes.
  explicit World(const Rollout& r, Creatures* creatures = nullptr)
      : team_(std::min(r.threads, r.height)),  // Each member has rows.
        r_(r),
        b_(r),
        shares_(b_.shares(r, team_.size())),
        l_(r.height, r.width, team_.size()),
        rates_(r.parameters[VISCOSITY], r.fixed_magic),
        surroundings_(r, l_),
        p_(b_, r, shares_, r.layers),
        at_nodes_(b_, r, shares_, 1),
        n_(b_, r),
        forcing_(p_, r.bodies),
        shapes_(b_, r, r.matched),
        rings_(b_, r),
        sweeps_(b_, r),
        controller_(r),
        actuators_(b_, r, n_),
        repulsion_(b_, r, shares_),
        barrier_(b_, r),
        energy_(b_, r, l_),
        food_(b_, r, l_, team_.size()),
        motion_(b_),
        measuring_(b_, r),
        creatures_(creatures),
        watch_(r.timed ? r.seconds : nullptr) {
    if (r.soft) softened_ = Floats(r.joints);
    if (r.layers == 2)
      normals_x_ = Floats(b_.node_slots + BLOCK), normals_y_ = Floats(b_.node_slots + BLOCK);
  }

  void run() {
    team_.run([](void* world, int member) { static_cast<World*>(world)->run(member); }, this);
  }

  // Write the ends of creatures to their slots.
  void scatter() const { creatures_->scatter(b_, n_); }

 private:
  void run(int number) {
    const Member me = {number, shares_[number], team_};
    const auto flow = chosen_flow();
    const auto find_moments = chosen_moments();
    begin(me);
    if (me.first()) watch_.start();
    for (int t = 0; t < r_.steps; t++) {
      if (r_.commands != GIVEN) {
        command(t, me);
        stop(CONTROL, me);
      }
      if (r_.repelled) repulsion_.find(n_, me);
      if (r_.barred) barrier_.find(n_, me);
      if (r_.repelled || r_.barred) stop(REPELLING, me);
      place_points(me.share);
      if (r_.fluid || r_.energetic || r_.fed) find_windows(p_, l_, WEIGHTS[r_.delta], me);
      stop(WINDOWS, me);
      if (r_.fluid) {
        find_moments(l_, l_.bands[number]);
        me.wait();  // A point reads velocities of all bands.
        stop(MOMENTS, me);
        interpolate<false>(p_, l_, l_.velocity, forcing_.velocity_x, forcing_.velocity_y, me);
        stop(INTERPOLATION, me);
      }
      if (creatures_) {
        creatures_->act(b_, n_, forcing_, p_, l_, energy_, food_, repulsion_, me);
        stop(CONTROL, me);
      }
      move(t, me.share);
      stop(CONSTRAINTS, me);
      if (r_.fluid) {
        forcing_.find(b_, p_, l_, r_, me);
        me.wait();  // A cell adds the final forces of points of all members.
        stop(FORCING, me);
        spread<true>(p_, l_, forcing_.x, forcing_.y, me);
        stop(SPREADING, me);
      } else if (r_.energetic) {
        cover(p_, l_, me);
        me.wait();  // Members may still sense energy that others take.
      }
      if (r_.energetic) energy_.collect(p_, l_, me);
      if (r_.fed) {
        me.wait();  // Members may still sense food that others eat.
        food_.eat(b_, n_, l_, creatures_->accounts.data(), me);
        food_.change(l_, me);
      }
      carry(me.share);
      if (creatures_) creatures_->tally(b_, n_, forcing_, motion_, repulsion_, barrier_, me);
      put_within_box(b_, n_, r_, me.share.bodies);
      if (r_.observed) measuring_.record(t, n_, forcing_, motion_, me);
      me.wait();  // A member records nodes of other shares, which the next step moves.
      stop(MEASURES, me);
      if (r_.fluid) {
        flow(l_, l_.bands[number], rates_);
        me.wait();  // `join` takes what the neighbouring bands have sent.
        settle(t, me);
        stop(FLUID, me);
      } else if (r_.observed && me.first())
        r_.speed[t] = 0;
    }
    me.wait();
    end(me);
  }

  // Take what has streamed into a band, and let the surroundings act.
  void settle(int t, const Member& me) {
    const int count = int(l_.bands.size()), n = me.number;
    join(l_, l_.bands[(n + count - 1) % count], l_.bands[n], l_.bands[(n + 1) % count]);
    if (r_.observed && me.first()) {
      float fastest = 0;
      for (const Band& band : l_.bands) fastest = most_or_nan(band.fastest, fastest);
      // One NaN, whichever of several was met first: that depends on the bands.
      r_.speed[t] = fastest >= 0 ? root(fastest + 1e-24f) : __builtin_nanf("");
    }
    if (r_.walled) me.wait();  // A wall link may cross bands: both must have been joined.
    surroundings_.act(l_, me);
  }

  // The first member takes the time of a part.
  INLINE void stop(Part part, const Member& me) {
    if (me.first()) watch_.stop(part);
  }

  void begin(const Member& me) {
    const Band& band = l_.bands[me.number];
    for (int i = 0; i < 9; i++)
      for (int x = band.from; x < band.to; x++)
        std::memcpy(l_.populations + i * l_.plane + x * l_.row,
                    r_.populations[i] + size_t(x) * r_.width, 4 * size_t(r_.width));
    if (me.first()) std::copy_n(r_.boxes, 2 * size_t(r_.bodies), (float*)n_.boxes);
    const Range nodes = me.part(r_.nodes), edges = me.part(r_.edges);
    for (int n = nodes.from; n < nodes.to; n++) {
      n_.x[b_.node_slot[n]] = r_.positions[2 * n], n_.y[b_.node_slot[n]] = r_.positions[2 * n + 1];
    }
    for (int e = edges.from; e < edges.to; e++) n_.angle[b_.edge_slot[e]] = r_.angles[e];
    me.wait();
    if (creatures_) creatures_->begin(b_, n_, me);
  }

  // Return the collision and streaming for this world, compiled for its forces and its row length.
  void (*chosen_flow() const)(Lattice&, Band&, const Rates&) {
    const bool filled = r_.width % BLOCK == 0;
    if (l_.drive == VARIED) return filled ? advance<true, VARIED> : advance<false, VARIED>;
    if (l_.drive == UNIFORM) return filled ? advance<true, UNIFORM> : advance<false, UNIFORM>;
    return filled ? advance<true, UNDRIVEN> : advance<false, UNDRIVEN>;
  }

  void (*chosen_moments() const)(Lattice&, const Band&) {
    if (l_.drive == VARIED) return moments<VARIED>;
    return l_.drive == UNIFORM ? moments<UNIFORM> : moments<UNDRIVEN>;
  }

  // Command the rest shape of a step, in closed loop; the first member does it for all.
  void command(int t, const Member& me) {
    if (r_.energetic) sense(me);
    if (me.first()) {
      float* angle = r_.rest_angle + size_t(t) * r_.joints;
      float* length = r_.rest_length + size_t(t) * r_.edges;
      controller_.command(t, 1, energy_.sensed, angle, length);
      actuators_.closed_loop(angle, length);
    }
    me.wait();
  }

  // The energy at the nodes.
  void sense(const Member& me) {
    each(me.share.nodes, [&](int i, int) __attribute__((always_inline)) {
      store(at_nodes_.x + i, load(n_.x + i)), store(at_nodes_.y + i, load(n_.y + i));
    });
    find_windows(at_nodes_, l_, WEIGHTS[r_.delta], me);
    energy_.sense(at_nodes_, l_, me);
    me.wait();
  }

  void end(const Member& me) {
    const Band& band = l_.bands[me.number];
    for (int i = 0; i < 9; i++)
      for (int x = band.from; x < band.to; x++)
        std::memcpy(r_.end_populations[i] + size_t(x) * r_.width,
                    l_.populations + i * l_.plane + x * l_.row, 4 * size_t(r_.width));
    const Range nodes = me.part(r_.nodes), edges = me.part(r_.edges);
    for (int n = nodes.from; n < nodes.to; n++) {
      r_.end_positions[2 * n] = n_.x[b_.node_slot[n]];
      r_.end_positions[2 * n + 1] = n_.y[b_.node_slot[n]];
    }
    for (int e = edges.from; e < edges.to; e++) r_.end_angles[e] = n_.angle[b_.edge_slot[e]];
    if (me.first()) {
      std::copy_n((float*)n_.boxes, 2 * size_t(r_.bodies), r_.end_boxes);
      energy_.end(l_), food_.end(l_);
      if (r_.timed) *r_.memory = float(held);
    }
  }

  // Place the points of bodies at their nodes, or half a cell to either side of them.
  void place_points(const Share& share) {
    constexpr float OFFSET = 0.5f;
    if (r_.layers == 1) {
      each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
        store(p_.x + i, load(n_.x + i)), store(p_.y + i, load(n_.y + i));
      });
      return;
    }
    find_normals(share);
    each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(n_.x + i), y = load(n_.y + i);
      const Vec ox = OFFSET * load(normals_x_ + i), oy = OFFSET * load(normals_y_ + i);
      store(p_.x + i, x + ox), store(p_.y + i, y + oy);
      store(p_.x + b_.node_slots + i, x - ox), store(p_.y + b_.node_slots + i, y - oy);
    });
  }

  void find_normals(const Share& share) {
    each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
      store(normals_x_ + i, Vec{}), store(normals_y_ + i, Vec{});
    });
    each(share.edges, [&](int i, int) __attribute__((always_inline)) {
      Vec s, c;
      sine_cosine(load(n_.angle + i), s, c);
      const Vec here = load(measuring_.edge_here + i);
      s = s * here, c = c * here;
      for (int l = 0; l < LANES; l++)
        if (b_.edges.item[i + l] >= 0)
          for (int node : {b_.edges.first[i + l], b_.edges.second[i + l]}) {
            normals_x_[node] = normals_x_[node] - s[l], normals_y_[node] = normals_y_[node] + c[l];
          }
    });
    each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(normals_x_ + i), y = load(normals_y_ + i),
                size = root(x * x + y * y + 1e-12f);
      store(normals_x_ + i, x / size), store(normals_y_ + i, y / size);
    });
  }

  // Carry the bodies with the fluid, meet their constraints, limit their speed.
  void move(int t, const Share& share) {
    const size_t step = r_.observed ? t : 0;
    const bool closed = r_.commands != GIVEN;
    const float* rest_angle = (closed ? r_.rest_angle : r_.given_angle) + step * r_.joints;
    const float* rest_length = (closed ? r_.rest_length : r_.given_length) + step * r_.edges;
    const float limit = r_.parameters[DISPLACEMENT_LIMIT];
    const int second = b_.node_slots;
    each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
      Vec ux = load(forcing_.velocity_x + i), uy = load(forcing_.velocity_y + i);
      if (r_.layers == 2) {
        ux = (ux + load(forcing_.velocity_x + second + i)) * 0.5f;
        uy = (uy + load(forcing_.velocity_y + second + i)) * 0.5f;
      }
      if (r_.repelled) ux = ux + load(repulsion_.push_x + i), uy = uy + load(repulsion_.push_y + i);
      store(n_.new_x + i, load(n_.x + i) + ux), store(n_.new_y + i, load(n_.y + i) + uy);
    });
    if (r_.matched) {
      if (r_.soft) {
        follow_geometry(b_, n_, 1, share.edges);
        rest_angle = softened(rest_angle, share.pieces);
      }
      match(rest_angle, rest_length, share.pieces);
      follow_geometry(b_, n_, 1, share.edges);
    } else {
      follow_geometry(b_, n_, r_.parameters[THETA_FEEDBACK], share.edges);
      sweeps_.apply(n_, rings_.closed(rest_angle, share.pieces), rest_length, share);
    }
    each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
      Vec x = load(n_.new_x + i) - load(n_.x + i), y = load(n_.new_y + i) - load(n_.y + i);
      const Vec shortened = least(all(1), limit / root(x * x + y * y + 1e-24f));
      x = x * shortened, y = y * shortened;
      store(motion_.shortened + i, shortened),
          store(motion_.moved + i, root(x * x + y * y + 1e-24f));
      for (int layer = 0; layer < r_.layers; layer++) {
        store(forcing_.target_x + layer * second + i, x),
            store(forcing_.target_y + layer * second + i, y);
      }
    });
  }

  // Return the rest angles towards which soft joints turn; see `filaments.softened`.
  const float* softened(const float* rest_angle, Range pieces) {
    for (int p = pieces.from; p < pieces.to; p++)
      for (int j : b_.pieces[p].joint_of) {
        const float first = n_.angle[b_.edge_slot[r_.pairs[2 * j]]];
        const float second = n_.angle[b_.edge_slot[r_.pairs[2 * j + 1]]];
        const float error = wrapped(all(second - first - rest_angle[j]))[0];
        softened_[j] = rest_angle[j] + (1 - r_.bend[j]) * error;
      }
    return softened_;
  }

  // Replace new positions by the rest shapes, moved and turned to be nearest to them: Mueller et
  // al., ACM Trans. Graph. 24, 471 (2005).
  void match(const float* rest_angle, const float* rest_length, Range pieces) {
    shapes_.lay_out(rest_angle, rest_length, pieces);
    for (int p = pieces.from; p < pieces.to; p++)
      fit(b_.pieces[p], shapes_, n_.here, n_.new_x, n_.new_y,
          [&](int i, Vec x, Vec y)
              __attribute__((always_inline)) { store(n_.new_x + i, x), store(n_.new_y + i, y); });
  }

  // Move the nodes that have grown by the target without its rigid part.
  void carry(const Share& share) {
    const int second = b_.node_slots;
    each(share.nodes, [&](int i, int) __attribute__((always_inline)) {
      Vec x = load(forcing_.target_x + i), y = load(forcing_.target_y + i);
      if (r_.layers == 2) {
        x = (x + load(forcing_.target_x + second + i)) * 0.5f,
        y = (y + load(forcing_.target_y + second + i)) * 0.5f;
      }
      if (r_.repelled) x = x + load(repulsion_.drift_x + i), y = y + load(repulsion_.drift_y + i);
      if (r_.barred) x = x + load(barrier_.drift_x + i), y = y + load(barrier_.drift_y + i);
      const Ints here = load(n_.here + i) > 0.0f;
      store(n_.x + i, load(n_.x + i) + (here ? x : Vec{})),
          store(n_.y + i, load(n_.y + i) + (here ? y : Vec{}));
    });
  }

  Team team_;
  const Rollout& r_;
  Bodies b_;
  List<Share> shares_;
  Lattice l_;
  Rates rates_;
  Surroundings surroundings_;
  Points p_, at_nodes_;
  Nodes n_;
  Forcing forcing_;
  Shapes shapes_;
  Rings rings_;
  Sweeps sweeps_;
  Controller controller_;
  Actuators actuators_;
  Repulsion repulsion_;
  Barrier barrier_;
  Energy energy_;
  Food food_;
  Motion motion_;
  Measuring measuring_;
  Creatures* creatures_;
  Stopwatch watch_;
  Floats normals_x_, normals_y_, softened_;
};

// A window of steps of the creatures in all slots.
inline void live(const Slots& w) {
  Creatures creatures(w);
  World world(creatures.r, &creatures);
  world.run();
  world.scatter();
}

// The rest shapes that a controller commands in open loop and actuators carry out.
inline void develop(const Rollout& r) {
  const Bodies bodies(r);
  const Nodes nodes(bodies, r);
  Controller(r).command(0, r.steps, nullptr, r.rest_angle, r.rest_length);
  Actuators(bodies, r, nodes).open_loop(r.rest_angle, r.rest_length, r.clock);
}

}  // namespace microcosmos::ISA
