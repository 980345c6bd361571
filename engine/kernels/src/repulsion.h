// Repulsion between nodes, down the gradient of their density, as in `world.nodes` and
// `fields.steric`: smoothed by binomial weights, or by a Fourier transform.
#pragma once
#include "nodes.h"
#include "transformed.h"

namespace microcosmos::ISA {

class Repulsion {
 public:
  Floats push_x, push_y;    // Displacements within bodies, without their rigid motion.
  Floats drift_x, drift_y;  // Rigid motion of bodies that touch each other.

  Repulsion(const Bodies& b, const Rollout& r) : b_(b), r_(r), transformed_(r) {
    for (Floats* one : {&push_x, &push_y, &drift_x, &drift_y}) *one = Floats(b.node_slots + BLOCK);
    if (!r.repelled) return;
    wide_ = size_t(r.width) + 2 * MARGIN;
    density_ = Floats(r.height * wide_ + BLOCK);
    for (int n = 0; n < r.nodes; n++)
      if (r.present[n]) order_.push_back(b.node_slot[n]);
    places_.resize(order_.size());
  }

  void find(const Nodes& n) {
    place(n);
    if (r_.transformed) {
      transformed_.deposit(places_);
      for (size_t i = 0; i < order_.size(); i++) read_transformed(order_[i], places_[i]);
    } else {
      for (const Place& p : places_)
        each_cell(p, [](float* at, float weight) { *at = *at + weight; });
      for (size_t i = 0; i < order_.size(); i++) read(order_[i], places_[i]);
      for (const Place& p : places_) each_cell(p, [](float* at, float) { *at = 0; });
    }
    for (const Range& body : b_.bodies) divide(body, n);
  }

 private:
  static constexpr int MARGIN = 4;
  // Binomial weights, and half the difference of those a cell behind and a cell ahead.
  static constexpr float SMOOTH[9] = {0,         0,         1.0f / 16, 4.0f / 16, 6.0f / 16,
                                      4.0f / 16, 1.0f / 16, 0,         0};
  static constexpr float SLOPE[9] = {0,         -1.0f / 32, -4.0f / 32, -5.0f / 32, 0,
                                     5.0f / 32, 4.0f / 32,  1.0f / 32,  0};
  struct Rigid {
    float x, y, spin;
  };
  struct Frame {
    float nodes, x, y, inertia;
  };

  static int cell(float position, int size, float& share) {
    constexpr float FAR = 4194304;  // Positions that are not finite stay within the box.
    const float x = position > -FAR ? (position < FAR ? position : FAR) : -FAR;
    int first = int(x);
    first -= float(first) > x;
    share = x - float(first);
    first %= size;
    return first < 0 ? first + size : first;
  }

  void place(const Nodes& n) {
    for (size_t i = 0; i < order_.size(); i++) {
      Place& p = places_[i];
      p.x = cell(n.x[order_[i]], r_.height, p.dx), p.y = cell(n.y[order_[i]], r_.width, p.dy);
    }
  }

  // The four cells around a node; columns near an edge also stand beyond the other.
  template <class Work>
  INLINE void each_cell(const Place& p, Work work) {
    for (int i = 0; i < 2; i++) {
      const int x = p.x + i < r_.height ? p.x + i : 0;
      for (int j = 0; j < 2; j++) {
        const int y = p.y + j < r_.width ? p.y + j : 0;
        const float weight = (i ? p.dx : 1 - p.dx) * (j ? p.dy : 1 - p.dy);
        float* at = density_ + x * wide_ + MARGIN + y;
        work(at, weight);
        if (y < MARGIN) work(at + r_.width, weight);
        if (y >= r_.width - MARGIN) work(at - r_.width, weight);
      }
    }
  }

  // The displacement of a node. Interpolating the weighted sums at the four cells around it takes
  // weights over 8 x 8 cells, products of those along both axes.
  void read(int slot, const Place& p) {
    auto between = [](const float* weights, float share) {
      return (1.0f - share) * load<Vec8>(weights + 1) + share * load<Vec8>(weights);
    };
    const Vec8 smooth_x = between(SMOOTH, p.dx), slope_x = between(SLOPE, p.dx);
    const Vec8 smooth_y = between(SMOOTH, p.dy), slope_y = between(SLOPE, p.dy);
    Vec8 gx = {}, gy = {};
    for (int i = 0; i < 8; i++) {
      int x = p.x - 3 + i;
      x = x < 0 ? x + r_.height : x >= r_.height ? x - r_.height : x;
      const Vec8 row = load<Vec8>(density_ + x * wide_ + MARGIN + p.y - 3);
      gx = gx + slope_x[i] * (row * smooth_y), gy = gy + smooth_x[i] * (row * slope_y);
    }
    const float strength = -r_.parameters[REPULSION];
    push_x[slot] = strength * total(gx), push_y[slot] = strength * total(gy);
  }

  void read_transformed(int slot, const Place& p) {
    float gx, gy;
    transformed_.read(p, gx, gy);
    const float strength = -r_.parameters[REPULSION];
    push_x[slot] = strength * gx, push_y[slot] = strength * gy;
  }

  static float total(Vec8 v) {
    const Vec4 t =
        __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
    return (t[0] + t[2]) + (t[1] + t[3]);
  }

  // Divide the displacements of a body into those within it and its rigid motion.
  void divide(Range body, const Nodes& n) {
    const float limit = r_.parameters[REPULSION_LIMIT];
    const Frame f = frame(body, n);
    const Rigid rigid = rigid_part(body, n, f);
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
    const Rigid rest = rigid_part(body, n, f);
    remove(body, n, f, rest);
    if (r_.bodies > 1) drift(body, n, f, rigid, most_turned, sum);
  }

  Frame frame(Range body, const Nodes& n) const {
    Sum count, sx, sy, inertia;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i);
      count.add(part, h), sx.add(part, h * load(n.x + i)), sy.add(part, h * load(n.y + i));
    });
    Frame f = {};
    f.nodes = count.total(), f.x = sx.total() / f.nodes, f.y = sy.total() / f.nodes;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      inertia.add(part, load(n.here + i) * (x * x + y * y));
    });
    f.inertia = inertia.total();
    return f;
  }

  Rigid rigid_part(Range body, const Nodes& n, const Frame& f) const {
    Sum sx, sy, turning;
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i);
      sx.add(part, h * load(push_x + i)), sy.add(part, h * load(push_y + i));
    });
    Rigid found = {sx.total() / f.nodes, sy.total() / f.nodes, 0};
    each(body.from, body.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      const Vec ex = load(push_x + i) - found.x, ey = load(push_y + i) - found.y;
      turning.add(part, load(n.here + i) * (x * ey - y * ex));
    });
    found.spin = turning.total() / f.inertia;
    return found;
  }

  void remove(Range body, const Nodes& n, const Frame& f, const Rigid& rigid) {
    each(body.from, body.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(n.x + i) - f.x, y = load(n.y + i) - f.y;
      store(push_x + i, load(push_x + i) - (rigid.x - rigid.spin * y));
      store(push_y + i, load(push_y + i) - (rigid.y + rigid.spin * x));
    });
  }

  // Displacements without the rigid motion, at most `limit` long.
  void capped(Range body, const Nodes& n, const Frame& f, const Rigid& rigid, float limit) {
    remove(body, n, f, rigid);
    each(body.from, body.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(push_x + i), y = load(push_y + i);
      const Vec factor = least(all(1), limit / root(x * x + y * y + 1e-24f));
      store(push_x + i, x * factor), store(push_y + i, y * factor);
    });
  }

  // The translation of a body by contact, and its rotation, both limited; see `nodes._turned`.
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
  Transformed transformed_;
  size_t wide_ = 0;
  Floats density_;
  std::vector<int> order_;
  std::vector<Place> places_;
};

}  // namespace microcosmos::ISA
