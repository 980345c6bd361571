// Development: the rest shapes that a controller commands, from a network or from a series of
// functions of time, as in `genomes.development` and `genomes.waves`.
#pragma once
#include "network.h"

namespace microcosmos::ISA {

class Controller {
 public:
  explicit Controller(const Rollout& r) : r_(r), network_(r) {
    nodes_ = r.nodes;
    // In open loop several times are evaluated at once; points fill whole blocks.
    const bool stepwise = r.recurrent || r.senses;
    times_ = stepwise ? 1 : std::max(1, std::min(r.steps, 512 / std::max(nodes_, 1)));
    const int points = (times_ * nodes_ + BLOCK - 1) / BLOCK * BLOCK;
    if (r.commands == NETWORK) network_.place(points);
    turned_ = Floats(points), stretched_ = Floats(points);
    wave_ = Floats(2 * size_t(nodes_) + BLOCK);
    if (r.waves)
      for (int n = 0; n < nodes_; n++) {
        Vec s, c;
        sine_cosine_any(all(r.lag[n]), s, c);
        wave_[n] = s[0], wave_[nodes_ + n] = c[0];
      }
    Vec s, c;
    sine_cosine_any(all(r.control[PHASE]), s, c);
    sine_ = s[0], cosine_ = c[0];
  }

  // Command the rest shapes of the steps from `first` on, (step, joint) and (step, edge);
  // `sensed` is what each node senses in one step, (sense, node), for a controller that senses.
  void command(int first, int count, const float* sensed, float* angle, float* length) {
    for (int step = 0; step < count; step += times_) {
      const int part = std::min(times_, count - step);
      float* to_angle = angle + size_t(step) * r_.joints;
      float* to_length = length + size_t(step) * r_.edges;
      if (r_.commands == NETWORK) {
        give(first + step, part, sensed);
        network_.advance();
        read(first + step, part, to_angle, to_length);
      } else
        add_up(first + step, part, to_angle, to_length);
    }
  }

  // The value of a row of a recurrent network at a node.
  float& value(int row, int node) { return network_.row(row)[node]; }

 private:
  // Put the inputs of `count` times into the network, the node varying fastest.
  void give(int first, int count, const float* sensed) {
    const int clocks = r_.timers;
    for (int t = 0; t < count; t++) {
      float timer[2] = {};
      for (int k = 0; k < clocks; k++) timer[k] = r_.timer[size_t(first + t) * clocks + k];
      if (clocks == 2 && r_.control[PHASE] != 0) {
        const float sine = timer[0], cosine = timer[1];
        timer[0] = sine * cosine_ + cosine * sine_, timer[1] = cosine * cosine_ - sine * sine_;
      }
      const int at = t * nodes_;
      int input = 0;
      for (int k = 0; k < r_.sites; k++)
        std::memcpy(network_.row(input++) + at, r_.site + size_t(k) * nodes_, 4 * size_t(nodes_));
      for (int k = 0; k < clocks; k++) {
        float* to = network_.row(input++) + at;
        for (int n = 0; n < nodes_; n++) to[n] = timer[k];
      }
      if (r_.waves) {
        float *s = network_.row(input++) + at, *c = network_.row(input++) + at;
        for (int n = 0; n < nodes_; n++) {
          s[n] = timer[0] * wave_[nodes_ + n] - timer[1] * wave_[n];
          c[n] = timer[1] * wave_[nodes_ + n] + timer[0] * wave_[n];
        }
      }
      for (int k = 0; k < count_of(r_.senses); k++)
        std::memcpy(network_.row(input++) + at, sensed + size_t(k) * nodes_, 4 * size_t(nodes_));
    }
  }

  // Turn outputs into rest shapes: a joint takes the output at its node times its gain, an edge the
  // mean of those at its ends.
  void read(int first, int count, float* angle, float* length) {
    const float *turned = network_.row(r_.inputs), *stretched = network_.row(r_.inputs + 1);
    for (int i = 0; i < count * nodes_; i += LANES) {
      store(turned_ + i, hyperbolic_tangent(load(turned + i)));
      store(stretched_ + i, hyperbolic_tangent(load(stretched + i)));
    }
    for (int t = 0; t < count; t++) {
      const float *bent = turned_ + t * nodes_, *longer = stretched_ + t * nodes_;
      actuate(
          first + t, [&](int joint) { return bent[r_.joint_node[joint]] * r_.gain[joint]; },
          [&](int edge) {
            return 0.5f * (longer[r_.ends[2 * edge]] + longer[r_.ends[2 * edge + 1]]);
          },
          angle + size_t(t) * r_.joints, length + size_t(t) * r_.edges);
    }
  }

  // Turn sums of functions of time, cut to [-1, 1], into rest shapes; genes are (term, item).
  void add_up(int first, int count, float* angle, float* length) {
    const int items = r_.joints + r_.edges;
    List<float> sum(items);
    for (int t = 0; t < count; t++) {
      std::fill(sum.begin(), sum.end(), 0.0f);
      for (int k = 0; k < r_.terms; k++) {
        const float factor = r_.basis[size_t(first + t) * r_.terms + k];
        const float* genes = r_.genes + size_t(k) * items;
        for (int i = 0; i < items; i++) sum[i] = sum[i] + factor * genes[i];
      }
      for (float& one : sum) one = one < -1 ? -1 : one > 1 ? 1 : one;
      actuate(
          first + t, [&](int joint) { return sum[joint]; },
          [&](int edge) { return sum[r_.joints + edge]; }, angle + size_t(t) * r_.joints,
          length + size_t(t) * r_.edges);
    }
  }

  template <class Bend, class Stretch>
  INLINE void actuate(int step, Bend bend, Stretch stretch, float* angle, float* length) const {
    const float by_angle = r_.control[ANGLE_SCALE] * r_.ramp[step];
    const float by_length = r_.control[LENGTH_SCALE] * r_.ramp[step];
    for (int j = 0; j < r_.joints; j++) angle[j] = r_.body_angle[j] + by_angle * bend(j);
    for (int e = 0; e < r_.edges; e++) length[e] = r_.body_length[e] * (1 + by_length * stretch(e));
  }

  const Rollout& r_;
  Network network_;
  int nodes_, times_;
  Floats turned_, stretched_, wave_;
  float sine_, cosine_;  // Of the phase by which a periodic timer leads.
};

}  // namespace microcosmos::ISA
