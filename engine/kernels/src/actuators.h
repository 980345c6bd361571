// Actuators with finite means, as in `genomes.actuators`: they bound the bend and the pace of
// commands, and follow them with a lag.
#pragma once
#include "shapes.h"

namespace microcosmos::ISA {

struct Rest {
  List<float> angle, length;  // (joint), (edge)
};

class Actuators {
 public:
  Rest paced, rest;  // The command after the bound on speed, and the shape after the lag.

  Actuators(const Bodies& b, const Rollout& r, const Nodes& n)
      : b_(b), r_(r), here_(n.here), shapes_(b, r, r.actuated), paced_shapes_(b, r, r.actuated) {
    before_x_ = Floats(b.node_slots + BLOCK), before_y_ = Floats(b.node_slots + BLOCK);
    start_.angle.resize(r.joints), start_.length.resize(r.edges);
    edge_here_.resize(r.edges);
    for (int e = 0; e < r.edges; e++)
      edge_here_[e] = r.present[r.ends[2 * e]] && r.present[r.ends[2 * e + 1]];
    if (r.actuated) stand();
    paced = rest = start_;
  }

  // Carry out commands for all steps, in place: the clock slows where they are too fast. `clock`
  // becomes the time of the commands at the end of each step.
  void open_loop(float* angle, float* length, float* clock) {
    const int T = r_.steps, J = r_.joints, E = r_.edges;
    for (int t = 0; t < T; t++) clock[t] = float(t + 1);
    if (!r_.actuated) return;
    for (int t = 0; t < T; t++) bound(angle + size_t(t) * J);
    if (r_.control[MAX_SPEED] > 0) slow(angle, length, clock);
    // A slow clock reads commands of earlier steps, which the results below overwrite: copies.
    const List<float> angles(angle, angle + size_t(T) * J);
    const List<float> lengths(length, length + size_t(T) * E);
    Rest rest = start_;
    for (int t = 0; t < T; t++) {
      const float at = clock[t];
      // At the end of the last step the clock may stand at T, beyond the last command.
      const int index = std::min(std::max(int(at), 0), T - 1);
      const float share = at - float(index);
      auto follow = [&](const float* given, const float* start, int count, float* state,
                        float* out) {
        const float* one = index ? given + size_t(index - 1) * count : start;
        const float* other = given + size_t(index) * count;
        for (int i = 0; i < count; i++) {
          const float paced = one[i] * (1 - share) + other[i] * share;
          out[i] = state[i] = state[i] + r_.control[LAG_SHARE] * (paced - state[i]);
        }
      };
      follow(angles.data(), start_.angle.data(), J, rest.angle.data(), angle + size_t(t) * J);
      follow(lengths.data(), start_.length.data(), E, rest.length.data(), length + size_t(t) * E);
    }
  }

  // Carry out the command of one step, in place: the shape follows it at the bounded speed.
  void closed_loop(float* angle, float* length) {
    if (!r_.actuated) return;
    bound(angle);
    aim(angle, length);
    follow(angle, length, angle, length);
  }

  // Lay out a bounded command, which the next steps follow.
  void aim(const float* angle, const float* length) {
    if (r_.control[MAX_SPEED] > 0) shapes_.lay_out(angle, length);
  }

  // Take a step towards the command: write the rest shape.
  void follow(const float* angle, const float* length, float* to_angle, float* to_length) {
    float share = 1;
    if (r_.control[MAX_SPEED] > 0) {
      paced_shapes_.lay_out(paced.angle.data(), paced.length.data());
      share = r_.control[MAX_SPEED] / fastest(paced_shapes_.x, paced_shapes_.y);
      share = share < 1 ? share : 1;
    }
    auto step = [&](const float* command, List<float>& paced, List<float>& rest, float* to) {
      for (size_t i = 0; i < paced.size(); i++) {
        paced[i] = paced[i] + share * (command[i] - paced[i]);
        to[i] = rest[i] = rest[i] + r_.control[LAG_SHARE] * (paced[i] - rest[i]);
      }
    };
    step(angle, paced.angle, rest.angle, to_angle);
    step(length, paced.length, rest.length, to_length);
  }

  // Reduce the bend to the bound: the largest angle added between any two edges.
  void bound(float* angle) {
    const float most = r_.control[MAX_BEND];
    if (!(most > 0)) return;
    const float* direction = shapes_.turned(angle);
    float low = 0, high = 0;
    bool first = true;
    for (const Piece& piece : b_.pieces) {
      float mean = 0;
      if (b_.pieces.size() > 1) {
        for (int e : piece.edge_of) mean += direction[b_.edge_slot[e]] - r_.layout_angle[e];
        mean = piece.edge_of.empty() ? 0 : mean / float(piece.edge_of.size());
      }
      for (int e : piece.edge_of) {
        if (!edge_here_[e]) continue;
        const float turn = direction[b_.edge_slot[e]] - r_.layout_angle[e] - mean;
        low = first || turn < low ? turn : low, high = first || turn > high ? turn : high;
        first = false;
      }
    }
    // A shape without a bend has no span: the least one keeps the division finite.
    const float span = high - low, share = most / (span > 1e-6f ? span : 1e-6f);
    if (!(share < 1)) return;
    for (int j = 0; j < r_.joints; j++) {
      const float rest = r_.layout_rest_angle[j];
      angle[j] = rest + share * (angle[j] - rest);
    }
  }

 private:
  // Set the start shape to the rest shape in which the body stands.
  void stand() {
    auto at = [&](int node, int axis) { return r_.positions[2 * node + axis]; };
    for (int j = 0; j < r_.joints; j++) {
      const float rest = r_.layout_rest_angle[j];
      const float turn = r_.angles[r_.pairs[2 * j + 1]] - r_.angles[r_.pairs[2 * j]] - rest;
      start_.angle[j] = rest + wrapped(all(turn))[0];
    }
    for (int e = 0; e < r_.edges; e++) {
      const int one = r_.ends[2 * e], other = r_.ends[2 * e + 1];
      const float x = at(other, 0) - at(one, 0), y = at(other, 1) - at(one, 1);
      start_.length[e] = root(x * x + y * y + 1e-24f);
    }
  }

  void lay_out_before(const float* angle, const float* length) {
    shapes_.lay_out(angle, length);
    keep();
  }

  void keep() {
    std::memcpy(before_x_, shapes_.x, 4 * size_t(b_.node_slots));
    std::memcpy(before_y_, shapes_.y, 4 * size_t(b_.node_slots));
  }

  // The largest displacement of a node from a shape to the one that is laid out, less rigid motion.
  float fastest(const float* before_x, const float* before_y) {
    Most largest;
    for (const Piece& piece : b_.pieces)
      fit(piece, shapes_, here_, before_x, before_y,
          [&](int i, Vec x, Vec y) __attribute__((always_inline)) {
            x = x - load(before_x + i), y = y - load(before_y + i);
            const Ints here = load(here_ + i) > 0.0f;
            largest.add(0, here ? x * x + y * y : Vec{});
          });
    return root(largest.total() + 1e-20f);
  }

  // Find the clock, which advances by 1 a step, or less where commands are too fast.
  void slow(const float* angle, const float* length, float* clock) {
    const int T = r_.steps, J = r_.joints, E = r_.edges;
    // Steps until the end of each command, in double precision: long runs add thousands of them.
    List<double> took(T + 1);
    lay_out_before(start_.angle.data(), start_.length.data());
    for (int t = 0; t < T; t++) {
      shapes_.lay_out(angle + size_t(t) * J, length + size_t(t) * E);
      const float speed = fastest(before_x_, before_y_);
      const float share = speed / r_.control[MAX_SPEED];
      took[t + 1] = took[t] + (share > 1 ? share : 1);
      keep();
    }
    for (int t = 0, done = 0; t < T; t++) {
      const double now = t + 1;
      while (done + 1 < T && took[done + 1] < now) done++;
      const double share = (now - took[done]) / (took[done + 1] - took[done]);
      clock[t] = float(done + (share < 1 ? share : 1));
    }
  }

  const Bodies& b_;
  const Rollout& r_;
  const float* here_;
  Shapes shapes_, paced_shapes_;
  Rest start_;
  Floats before_x_, before_y_;
  List<uint8_t> edge_here_;
};

}  // namespace microcosmos::ISA
