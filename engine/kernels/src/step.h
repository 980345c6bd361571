// A rollout: steps of one world, in the order of `world.step`, and the measures of each.
#pragma once
#include <chrono>

#include "forcing.h"
#include "matching.h"
#include "sweeps.h"

namespace microcosmos::ISA {

// Adds the time since the last call to a part, if times are taken.
class Stopwatch {
 public:
  explicit Stopwatch(float* seconds) : seconds_(seconds) {
    if (seconds_) last_ = Clock::now();
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
  explicit World(const Rollout& r)
      : r_(r),
        b_(r),
        l_(r.height, r.width),
        p_(b_, r),
        n_(b_),
        forcing_(p_, r.bodies),
        matching_(b_, r),
        sweeps_(b_, r) {
    shortened_ = Floats(b_.node_slots + BLOCK);
    moved_ = Floats(b_.node_slots + BLOCK);
    edge_here_ = Floats(b_.edge_slots + BLOCK);
    length_ = Floats(b_.edge_slots + BLOCK);
    for (int n = 0; n < r.nodes; n++) {
      n_.here[b_.node_slot[n]] = float(r.present[n]);
      nodes_here_ += r.present[n];
    }
    for (int e = 0; e < r.edges; e++) {
      const bool here = r.present[r.ends[2 * e]] && r.present[r.ends[2 * e + 1]];
      edge_here_[b_.edge_slot[e]] = float(here);
      edges_here_ += here;
    }
    if (r.layers == 2)
      normals_x_ = Floats(b_.node_slots + BLOCK), normals_y_ = Floats(b_.node_slots + BLOCK);
  }

  void run() {
    begin();
    const Rates rates(r_.parameters[0], r_.parameters[1]);
    const bool filled = r_.width % BLOCK == 0;
    Stopwatch watch(r_.timed ? r_.seconds : nullptr);
    for (int t = 0; t < r_.steps; t++) {
      place_points();
      find_windows(p_, l_, WEIGHTS[r_.delta]);
      watch.stop(WINDOWS);
      moments(l_);
      watch.stop(MOMENTS);
      interpolate<false>(p_, l_, l_.velocity, forcing_.velocity_x, forcing_.velocity_y);
      watch.stop(INTERPOLATION);
      move(r_.rest_angle + size_t(t) * r_.joints, r_.rest_length + size_t(t) * r_.edges);
      watch.stop(CONSTRAINTS);
      forcing_.find(b_, p_, l_, r_);
      watch.stop(FORCING);
      spread(p_, l_, forcing_.x, forcing_.y);
      watch.stop(SPREADING);
      carry();
      measure(t);
      watch.stop(MEASURES);
      r_.speed[t] = filled ? advance<true>(l_, rates) : advance<false>(l_, rates);
      watch.stop(FLUID);
    }
    end();
  }

 private:
  void begin() {
    for (int i = 0; i < 9; i++)
      for (int x = 0; x < r_.height; x++)
        std::memcpy(l_.populations + i * l_.plane + x * l_.row,
                    r_.populations[i] + size_t(x) * r_.width, 4 * size_t(r_.width));
    for (int n = 0; n < r_.nodes; n++) {
      n_.x[b_.node_slot[n]] = r_.positions[2 * n], n_.y[b_.node_slot[n]] = r_.positions[2 * n + 1];
    }
    for (int e = 0; e < r_.edges; e++) n_.angle[b_.edge_slot[e]] = r_.angles[e];
  }

  void end() {
    for (int i = 0; i < 9; i++)
      for (int x = 0; x < r_.height; x++)
        std::memcpy(r_.end_populations[i] + size_t(x) * r_.width,
                    l_.populations + i * l_.plane + x * l_.row, 4 * size_t(r_.width));
    for (int n = 0; n < r_.nodes; n++) {
      r_.end_positions[2 * n] = n_.x[b_.node_slot[n]],
                           r_.end_positions[2 * n + 1] = n_.y[b_.node_slot[n]];
    }
    for (int e = 0; e < r_.edges; e++) r_.end_angles[e] = n_.angle[b_.edge_slot[e]];
  }

  // The points of bodies: their nodes, or two half a cell to either side.
  void place_points() {
    constexpr float OFFSET = 0.5f;
    if (r_.layers == 1) {
      each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
        store(p_.x + i, load(n_.x + i)), store(p_.y + i, load(n_.y + i));
      });
      return;
    }
    find_normals();
    each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(n_.x + i), y = load(n_.y + i);
      const Vec ox = OFFSET * load(normals_x_ + i), oy = OFFSET * load(normals_y_ + i);
      store(p_.x + i, x + ox), store(p_.y + i, y + oy);
      store(p_.x + b_.node_slots + i, x - ox), store(p_.y + b_.node_slots + i, y - oy);
    });
  }

  void find_normals() {
    each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
      store(normals_x_ + i, Vec{}), store(normals_y_ + i, Vec{});
    });
    each(0, b_.edge_slots, [&](int i, int) __attribute__((always_inline)) {
      Vec s, c;
      sine_cosine(load(n_.angle + i), s, c);
      const Vec here = load(edge_here_ + i);
      s = s * here, c = c * here;
      for (int l = 0; l < LANES; l++)
        if (b_.edges.item[i + l] >= 0)
          for (int node : {b_.edges.first[i + l], b_.edges.second[i + l]}) {
            normals_x_[node] = normals_x_[node] - s[l], normals_y_[node] = normals_y_[node] + c[l];
          }
    });
    each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(normals_x_ + i), y = load(normals_y_ + i),
                size = root(x * x + y * y + 1e-12f);
      store(normals_x_ + i, x / size), store(normals_y_ + i, y / size);
    });
  }

  // Carry the bodies with the fluid, meet their constraints, limit their speed.
  void move(const float* rest_angle, const float* rest_length) {
    const float limit = r_.parameters[2];
    const int second = b_.node_slots;
    each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
      Vec ux = load(forcing_.velocity_x + i), uy = load(forcing_.velocity_y + i);
      if (r_.layers == 2) {
        ux = (ux + load(forcing_.velocity_x + second + i)) * 0.5f;
        uy = (uy + load(forcing_.velocity_y + second + i)) * 0.5f;
      }
      store(n_.new_x + i, load(n_.x + i) + ux), store(n_.new_y + i, load(n_.y + i) + uy);
    });
    if (r_.matched) {
      matching_.apply(n_, rest_angle, rest_length);
      follow_geometry(b_, n_, 1);
    } else {
      follow_geometry(b_, n_, r_.theta_feedback);
      sweeps_.apply(n_, rest_angle, rest_length);
    }
    each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
      Vec x = load(n_.new_x + i) - load(n_.x + i), y = load(n_.new_y + i) - load(n_.y + i);
      const Vec shortened = least(all(1), limit / root(x * x + y * y + 1e-24f));
      x = x * shortened, y = y * shortened;
      store(shortened_ + i, shortened), store(moved_ + i, root(x * x + y * y + 1e-24f));
      for (int layer = 0; layer < r_.layers; layer++) {
        store(forcing_.target_x + layer * second + i, x),
            store(forcing_.target_y + layer * second + i, y);
      }
    });
  }

  // Move the nodes that have grown by the target without its rigid part.
  void carry() {
    const int second = b_.node_slots;
    each(0, b_.node_slots, [&](int i, int) __attribute__((always_inline)) {
      Vec x = load(forcing_.target_x + i), y = load(forcing_.target_y + i);
      if (r_.layers == 2) {
        x = (x + load(forcing_.target_x + second + i)) * 0.5f,
        y = (y + load(forcing_.target_y + second + i)) * 0.5f;
      }
      const Ints here = load(n_.here + i) > 0.0f;
      store(n_.x + i, load(n_.x + i) + (here ? x : Vec{})),
          store(n_.y + i, load(n_.y + i) + (here ? y : Vec{}));
    });
  }

  void measure(int t) {
    Sum cx, cy, speeds, power, heading, held;
    each(0, b_.node_slots, [&](int i, int part) __attribute__((always_inline)) {
      const Vec here = load(n_.here + i);
      cx.add(part, here * load(n_.x + i)), cy.add(part, here * load(n_.y + i));
      speeds.add(part, here * load(moved_ + i));
    });
    for (size_t body = 0; body < b_.bodies.size(); body++) {
      Sum fx, fy;
      const Vec pressed = all(forcing_.held[body]);
      Forcing::each_point(
          b_, b_.bodies[body], r_, [&](int i, int part) __attribute__((always_inline)) {
            const Vec x = load(forcing_.x + i), y = load(forcing_.y + i);
            fx.add(part, x), fy.add(part, y);
            power.add(part, x * load(forcing_.target_x + i) + y * load(forcing_.target_y + i));
          });
      each(b_.bodies[body].from, b_.bodies[body].to,
           [&](int i, int part) __attribute__((always_inline)) {
             const Vec limited = load(shortened_ + i) < 1.0f ? all(1) : Vec{};
             held.add(part, load(n_.here + i) * most(pressed, limited));
           });
      float* force = r_.force + 2 * (size_t(t) * r_.bodies + body);
      force[0] = fx.total(), force[1] = fy.total();
    }
    each(0, b_.edge_slots, [&](int i, int part) __attribute__((always_inline)) {
      heading.add(part, load(edge_here_ + i) * load(n_.angle + i));
    });
    r_.centre[2 * t] = cx.total() / nodes_here_, r_.centre[2 * t + 1] = cy.total() / nodes_here_;
    r_.node_speed[t] = speeds.total() / nodes_here_, r_.held[t] = held.total() / nodes_here_;
    r_.power[t] = power.total(), r_.heading[t] = heading.total() / edges_here_;
    float* path = r_.path + 2 * size_t(t) * r_.nodes;
    for (int n = 0; n < r_.nodes; n++)
      path[2 * n] = n_.x[b_.node_slot[n]], path[2 * n + 1] = n_.y[b_.node_slot[n]];
    if (r_.joints) curvature(r_.curvature + size_t(t) * r_.joints);
  }

  // The angle at each joint over the mean length of its edges.
  void curvature(float* out) {
    each(0, b_.edge_slots, [&](int i, int) __attribute__((always_inline)) {
      const bool adjacent = b_.edges.adjacent[i / BLOCK];
      const int32_t *one = &b_.edges.first[i], *other = &b_.edges.second[i];
      const Vec vx = gather(n_.x, other, adjacent) - gather(n_.x, one, adjacent);
      const Vec vy = gather(n_.y, other, adjacent) - gather(n_.y, one, adjacent);
      store(length_ + i, root(vx * vx + vy * vy + 1e-24f));
    });
    const Pairs& joints = b_.joints;
    each(0, joints.places(), [&](int i, int) __attribute__((always_inline)) {
      const int32_t *one = &joints.first[i], *other = &joints.second[i], *item = &joints.item[i];
      const Vec angle = wrapped(gather(n_.angle, other, false) - gather(n_.angle, one, false));
      const Vec lengths = gather(length_, one, false) + gather(length_, other, false);
      const Vec here = gather(edge_here_, one, false) * gather(edge_here_, other, false);
      const Vec found = here > 0.0f ? 2.0f * angle / lengths : Vec{};
      for (int l = 0; l < LANES; l++)
        if (item[l] >= 0) out[item[l]] = found[l];
    });
  }

  const Rollout& r_;
  Bodies b_;
  Lattice l_;
  Points p_;
  Nodes n_;
  Forcing forcing_;
  Matching matching_;
  Sweeps sweeps_;
  Floats shortened_, moved_, edge_here_, length_, normals_x_, normals_y_;
  float nodes_here_ = 0, edges_here_ = 0;
};

}  // namespace microcosmos::ISA
