// Creatures in slots: a window of steps in which each has a body, a network, a clock and actuators
// of its own.
//
// All of it is state that goes in and comes out, so windows of any length continue exactly. What
// lives is gathered first, in the order of the creatures' numbers: neither empty slots nor the
// order of slots change a bit.
#pragma once
#include <algorithm>
#include <memory>
#include <optional>

#include "actuators.h"
#include "barrier.h"
#include "controller.h"
#include "energy.h"
#include "food.h"
#include "forcing.h"
#include "measuring.h"
#include "repulsion.h"

namespace microcosmos {

// Shapes that the actuators of a slot remember.
enum Remembered { COMMAND, PACED, REST, SHAPE_COUNT };
// Measures of a slot in a window, in the order of `world.slots.Tally`.
enum Tallied {
  TALLY_DISPLACED_X,
  TALLY_DISPLACED_Y,
  TALLY_PATH,
  TALLY_TURNED,
  TALLY_WORK,
  TALLY_CONTACT,
  TALLY_TOUCHED,
  TALLY_CAPPED,
  TALLY_LIMITED,
  TALLY_NEAR,
  TALLY_COUNT
};

// The operands and results of a window. Sizes and arrays of `r` are those of one slot and of all
// slots.
struct Slots {
  Rollout r;
  int32_t slots, every;        // Steps from a command to the next.
  const int32_t* filled;       // (slot) 1, or 0 for an empty slot
  const int32_t* number;       // (slot) of each creature
  const int32_t* age;          // (slot) steps
  const float* actuation;          // (slot, ACTUATION_COUNT), see `rollout.h`
  const float* shape_angles;   // (slot, SHAPE_COUNT, joint)
  const float* shape_lengths;  // (slot, SHAPE_COUNT, edge)
  const float* values;         // (slot, row, node) of recurrent networks
  const int32_t* account;      // (slot) quanta
  int32_t* end_account;
  int32_t* end_age;
  float *end_shape_angles, *end_shape_lengths, *end_values;
  float* tally;  // (slot, TALLY_COUNT)
};

// Numbers of the items that are kept among all of a slot, and the place of each.
struct Kept {
  std::vector<int32_t> items, place;  // Place: -1 for those that are left out.

  template <class Keep>
  void choose(int count, Keep keep) {
    items.clear(), place.assign(count, -1);
    for (int i = 0; i < count; i++)
      if (keep(i)) place[i] = int32_t(items.size()), items.push_back(i);
  }
};

namespace ISA {

// The creature of one slot, without what has not grown.
class Creature {
 public:
  // `at` are its first node, edge and joint among those of all creatures.
  struct Start {
    int nodes, edges, joints;
  };
  const int slot, body;
  const Start at;
  Kept nodes, edges, joints;
  List<int32_t> ends, pairs;  // Within the creature.
  int32_t age;

  Creature(const Slots& w, int slot, int body, Start at)
      : slot(slot), body(body), at(at), age(w.age[slot]), w_(w) {
    const Rollout& r = w.r;
    const int64_t N = r.nodes, E = r.edges, J = r.joints;
    const int32_t *present = r.present + slot * N, *given = r.ends + 2 * slot * E,
                  *met = r.pairs + 2 * slot * J;
    nodes.choose(r.nodes, [&](int n) { return present[n]; });
    edges.choose(r.edges, [&](int e) {
      const int32_t one = given[2 * e], other = given[2 * e + 1];
      return one != other && present[one] && present[other];
    });
    joints.choose(r.joints, [&](int j) {
      return r.bends[slot * J + j] && edges.place[met[2 * j]] >= 0 &&
             edges.place[met[2 * j + 1]] >= 0;
    });
    for (int32_t e : edges.items)
      for (int side : {0, 1}) ends.push_back(nodes.place[given[2 * e + side]]);
    for (int32_t j : joints.items)
      for (int side : {0, 1}) pairs.push_back(edges.place[met[2 * j + side]]);
  }

  int node_count() const { return int(nodes.items.size()); }
  int edge_count() const { return int(edges.items.size()); }
  int joint_count() const { return int(joints.items.size()); }

  // Make the network and the actuators, of a body whose arrays in `all` begin at `at`.
  void wake(const Rollout& all) {
    const Rollout& r = w_.r;
    const int64_t N = r.nodes, E = r.edges, J = r.joints, R = r.rows, L = r.links;
    alone_ = r;
    alone_.nodes = node_count(), alone_.edges = edge_count(), alone_.joints = joint_count();
    alone_.bodies = 1, alone_.steps = 1, alone_.commands = NETWORK;
    alone_.matched = alone_.laid_out = alone_.actuated = true;  // Nothing is swept here.
    alone_.positions = all.positions + 2 * at.nodes, alone_.angles = all.angles + at.edges;
    alone_.boxes = all.boxes, alone_.ends = ends.data(), alone_.pairs = pairs.data();
    member_.assign(node_count(), 0), alone_.member = member_.data();
    alone_.piece = all.piece + at.nodes, alone_.present = all.present + at.nodes;
    alone_.layout_angle = all.layout_angle + at.edges;
    alone_.layout_rest_angle = all.layout_rest_angle + at.joints;
    alone_.bends = all.bends + at.joints;
    alone_.control = w_.actuation + slot * ACTUATION_COUNT;
    alone_.activation = r.activation + slot * R, alone_.bias = r.bias + slot * R;
    alone_.source = r.source + slot * L, alone_.target = r.target + slot * L;
    alone_.weight = r.weight + slot * L;
    alone_.timer = timer_, alone_.ramp = &ramp_;
    for (int k = 0; k < r.sites; k++)
      take(r.site + (int64_t(slot) * r.sites + k) * N, nodes.items, site_);
    if (r.waves) take(r.lag + slot * N, nodes.items, lag_);
    for (int32_t j : joints.items) joint_node_.push_back(nodes.place[r.joint_node[slot * J + j]]);
    take(r.gain + slot * J, joints.items, gain_);
    take(r.body_length + slot * E, edges.items, length_);
    alone_.site = site_.data(), alone_.lag = lag_.data(), alone_.gain = gain_.data();
    alone_.joint_node = joint_node_.data();
    alone_.body_angle = alone_.layout_rest_angle, alone_.body_length = length_.data();
    b_.emplace(alone_), n_.emplace(*b_, alone_);
    controller_.emplace(alone_), actuators_.emplace(*b_, alone_, *n_);
    sensed_ = Floats(size_t(count_of(r.senses)) * node_count() + BLOCK);
    for (List<float>* one : {&across_x_, &across_y_}) one->resize(node_count() + BLOCK);
    remember();
    actuators_->aim(command_.angle.data(), command_.length.data());
  }

  // Set the rest shape of a step; `look` fills in what the nodes sense.
  template <class Look>
  void act(float* rest_angle, float* rest_length, Look look) {
    if (age % w_.every == 0) {
      tell_time();
      look(*this, sensed_, across_x_.data(), across_y_.data());
      controller_->command(0, 1, sensed_, command_.angle.data(), command_.length.data());
      actuators_->bound(command_.angle.data());
      actuators_->aim(command_.angle.data(), command_.length.data());
    }
    actuators_->follow(command_.angle.data(), command_.length.data(), rest_angle + at.joints,
                       rest_length + at.edges);
    age += age < INT32_MAX;
  }

  // Write what goes on in the next window.
  void record() {
    const int64_t J = w_.r.joints, E = w_.r.edges;
    w_.end_age[slot] = age;
    const Rest* shapes[SHAPE_COUNT] = {&command_, &actuators_->paced, &actuators_->rest};
    for (int s = 0; s < SHAPE_COUNT; s++) {
      put(shapes[s]->angle, joints.items, w_.end_shape_angles + (slot * SHAPE_COUNT + s) * J);
      put(shapes[s]->length, edges.items, w_.end_shape_lengths + (slot * SHAPE_COUNT + s) * E);
    }
    each_value([&](float& here, int64_t there) { w_.end_values[there] = here; });
  }

  template <class From>
  static void take(const float* from, const From& items, List<float>& to) {
    for (int32_t one : items) to.push_back(from[one]);
  }
  template <class From, class Items>
  static void put(const From& from, const Items& items, float* to) {
    for (size_t i = 0; i < items.size(); i++) to[items[i]] = from[i];
  }

 private:
  void remember() {
    const int64_t J = w_.r.joints, E = w_.r.edges;
    Rest* shapes[SHAPE_COUNT] = {&command_, &actuators_->paced, &actuators_->rest};
    for (int s = 0; s < SHAPE_COUNT; s++) {
      shapes[s]->angle.clear(), shapes[s]->length.clear();
      take(w_.shape_angles + (slot * SHAPE_COUNT + s) * J, joints.items, shapes[s]->angle);
      take(w_.shape_lengths + (slot * SHAPE_COUNT + s) * E, edges.items, shapes[s]->length);
    }
    each_value([&](float& here, int64_t there) { here = w_.values[there]; });
  }

  template <class Work>
  void each_value(Work work) {
    if (!w_.r.recurrent) return;
    for (int row = 0; row < w_.r.rows; row++)
      for (int n = 0; n < node_count(); n++)
        work(controller_->value(row, n),
             (int64_t(slot) * w_.r.rows + row) * w_.r.nodes + nodes.items[n]);
  }

  // The timer and the growth of the stroke at its age.
  void tell_time() {
    const float *actuation = w_.actuation + slot * ACTUATION_COUNT, rise = actuation[RAMP];
    Vec s, c;
    sine_cosine(all(6.2831855f * passed(actuation[PERIOD])), s, c);
    timer_[0] = s[0], timer_[1] = c[0];
    const float grown = (float(age) + (rise > 0 ? 0.0f : 1.0f)) / (rise > 1 ? rise : 1.0f);
    ramp_ = grown < 1 ? grown : 1;
  }

  // The share of a period that has passed, without the rounding of a great age.
  float passed(float period) const {
    const double periods = age / double(period);
    if (!(periods >= 0 && periods < 4e15)) return 0;
    // The product of the whole number and a period of at least 4 steps has no more digits than a
    // double.
    double rest = age - double(period) * double(int64_t(periods));
    rest = rest < 0 ? rest + period : rest >= period ? rest - period : rest;
    return float(rest / period);
  }

  const Slots& w_;
  Rollout alone_ = {};
  List<int32_t> member_, joint_node_;
  List<float> site_, lag_, gain_, length_, across_x_, across_y_;
  float timer_[2] = {}, ramp_ = 0;
  std::optional<Bodies> b_;
  std::optional<Nodes> n_;
  std::optional<Controller> controller_;
  std::optional<Actuators> actuators_;
  Rest command_;
  Floats sensed_;
};

// All creatures of a window as the bodies of one world.
class Creatures {
 public:
  Rollout r;               // Of the world that has them as bodies.
  List<int32_t> accounts;  // Of each body.

  explicit Creatures(const Slots& w) : r(w.r), w_(w) {
    const int64_t N = w.r.nodes, E = w.r.edges, J = w.r.joints;
    begin_ends();
    List<int32_t> order;
    for (int slot = 0; slot < w.slots; slot++)
      if (w.filled[slot]) order.push_back(slot);
    std::sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
      return std::make_pair(w.number[a], a) < std::make_pair(w.number[b], b);
    });
    Creature::Start at = {};
    for (int32_t slot : order) {
      const int body = int(one_.size());
      one_.push_back(std::make_unique<Creature>(w, slot, body, at));
      Creature& c = *one_.back();
      accounts.push_back(w.r.fed ? w.account[slot] : 0);
      for (int32_t n : c.nodes.items) {
        const int64_t k = slot * N + n;
        member_.push_back(body), piece_.push_back(at.nodes + w.r.piece[k]);
        positions_.push_back(w.r.positions[2 * k]), positions_.push_back(w.r.positions[2 * k + 1]);
        if (w.r.energetic) collected_.push_back(w.r.collected[k]);
      }
      for (int side : {0, 1}) boxes_.push_back(w.r.boxes[2 * slot + side]);
      Creature::take(w.r.angles + slot * E, c.edges.items, angles_);
      Creature::take(w.r.layout_angle + slot * E, c.edges.items, layout_angle_);
      Creature::take(w.r.layout_rest_angle + slot * J, c.joints.items, layout_rest_angle_);
      Creature::take(w.r.stretch + slot * E, c.edges.items, stretch_);
      Creature::take(w.r.shear + slot * E, c.edges.items, shear_);
      Creature::take(w.r.bend + slot * J, c.joints.items, bend_);
      if (!w.r.matched) {
        for (int32_t e : c.edges.items) edge_colour_.push_back(w.r.edge_colour[slot * E + e]);
        for (int32_t j : c.joints.items) joint_colour_.push_back(w.r.joint_colour[slot * J + j]);
        Creature::take(w.r.whole + slot * J, c.joints.items, whole_);
      }
      for (int32_t end : c.ends) ends_.push_back(at.nodes + end);
      for (int32_t pair : c.pairs) pairs_.push_back(at.edges + pair);
      at.nodes += c.node_count(), at.edges += c.edge_count(), at.joints += c.joint_count();
    }
    present_.assign(at.nodes, 1), bends_.assign(at.joints, 1);
    rest_angle_.resize(at.joints), rest_length_.resize(at.edges);
    end_positions_.resize(2 * size_t(at.nodes)), end_angles_.resize(at.edges);
    end_boxes_.resize(boxes_.size()), end_collected_.resize(collected_.size());
    join(at);
    for (auto& c : one_) c->wake(r);
    tallies_.resize(one_.size());
  }

  // Command the rest shapes of a step for the creatures of a share.
  void act(const Bodies& b, const Nodes& n, const Forcing& f, const Points& p, const Lattice& l,
           const Energy& e, const Food& food, const Repulsion& repulsion, const Member& me) {
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++)
      one_[body]->act(rest_angle_.data(), rest_length_.data(),
                      [&](const Creature& c, float* sensed, float* ax, float* ay) {
                        if (w_.r.senses) look(c, b, n, f, p, l, e, food, repulsion, sensed, ax, ay);
                      });
  }

  // Note where the creatures of a share begin.
  void begin(const Bodies& b, const Nodes& n, const Member& me) {
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++) {
      Noted& t = tallies_[body];
      t.boxes[0] = t.first_boxes[0] = n.boxes[2 * body];
      t.boxes[1] = t.first_boxes[1] = n.boxes[2 * body + 1];
      centre(b, n, body, t.centre), t.heading = heading(b, n, body);
      t.first[0] = t.centre[0], t.first[1] = t.centre[1];
    }
  }

  // Add up the measures of a step, before bodies are put into other boxes.
  void tally(const Bodies& b, const Nodes& n, const Forcing& f, const Motion& m,
             const Repulsion& repulsion, const Barrier& barrier, const Member& me) {
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++) {
      Noted& t = tallies_[body];
      Sum limited, work, touched;
      Vec near[PARTS] = {};
      const Vec pressed = all(f.held[body]);
      each(b.bodies[body], [&](int i, int part) __attribute__((always_inline)) {
        const Ints here = load(n.here + i) > 0.0f;
        const Vec at_limit = load(m.shortened + i) < 1.0f ? all(1) : Vec{};
        limited.add(part, here ? most(pressed, at_limit) : Vec{});
        if (!r.repelled && !r.barred) return;
        Vec x = {}, y = {};
        if (r.repelled) x = load(repulsion.drift_x + i), y = load(repulsion.drift_y + i);
        if (r.barred) x = x + load(barrier.drift_x + i), y = y + load(barrier.drift_y + i);
        touched.add(part, here ? root(x * x + y * y) : Vec{});
      });
      if (r.fluid)
        Forcing::each_point(
            b, b.bodies[body], r, [&](int i, int part) __attribute__((always_inline)) {
              const Vec x = load(f.velocity_x + i), y = load(f.velocity_y + i);
              near[part] = most_or_nan(x * x + y * y, near[part]);
              work.add(part,
                       load(f.x + i) * load(f.target_x + i) + load(f.y + i) * load(f.target_y + i));
            });
      const float count = divisor(float(one_[body]->node_count()));
      t.limited += limited.total() / count, t.contact += touched.total() / count;
      t.work += work.total();
      t.touched += repulsion.touched(body), t.capped += repulsion.limited(body);
      for (Vec one : near)
        for (int lane = 0; lane < LANES; lane++) t.near = most_or_nan(one[lane], t.near);
      float now[2];
      centre(b, n, body, now);
      double way[2];
      for (int axis : {0, 1}) {
        const float moved = n.boxes[2 * body + axis] - t.boxes[axis];
        way[axis] = double(now[axis] - t.centre[axis]) + double(moved) * size(axis);
        t.boxes[axis] = n.boxes[2 * body + axis], t.centre[axis] = now[axis];
      }
      t.path += __builtin_sqrt(way[0] * way[0] + way[1] * way[1]);
    }
  }

  // Write the end of a window, of what has been gathered; the rest stays as it was.
  void scatter(const Bodies& b, const Nodes& n) const {
    const int64_t N = w_.r.nodes, E = w_.r.edges;
    for (size_t body = 0; body < one_.size(); body++) {
      Creature& c = *one_[body];
      for (int k = 0; k < c.node_count(); k++) {
        const int64_t node = c.slot * N + c.nodes.items[k], here = c.at.nodes + k;
        w_.r.end_positions[2 * node] = end_positions_[2 * here];
        w_.r.end_positions[2 * node + 1] = end_positions_[2 * here + 1];
        if (r.energetic) w_.r.end_collected[node] = end_collected_[here];
      }
      for (int k = 0; k < c.edge_count(); k++)
        w_.r.end_angles[c.slot * E + c.edges.items[k]] = end_angles_[c.at.edges + k];
      for (int axis : {0, 1}) w_.r.end_boxes[2 * c.slot + axis] = end_boxes_[2 * body + axis];
      c.record();
      if (r.fed) w_.end_account[c.slot] = accounts[body];
      write(b, n, int(body), w_.tally + c.slot * TALLY_COUNT);
    }
  }

 private:
  // What is noted of a creature during a window.
  struct Noted {
    float first[2], centre[2];  // From the corners of its box then.
    float first_boxes[2], boxes[2];
    float heading, near;
    double path, work, contact, limited;
    int touched, capped;
  };

  float size(int axis) const { return float(axis ? r.width : r.height); }

  // Let the ends be the starts: what belongs to an empty slot, or has not grown, stays.
  void begin_ends() const {
    const auto& from = w_.r;
    const size_t S = w_.slots, N = from.nodes, E = from.edges, J = from.joints, R = from.rows;
    std::copy_n(from.positions, 2 * S * N, from.end_positions);
    std::copy_n(from.angles, S * E, from.end_angles);
    std::copy_n(from.boxes, 2 * S, from.end_boxes);
    std::copy_n(w_.age, S, w_.end_age);
    std::copy_n(w_.shape_angles, S * SHAPE_COUNT * J, w_.end_shape_angles);
    std::copy_n(w_.shape_lengths, S * SHAPE_COUNT * E, w_.end_shape_lengths);
    if (from.recurrent) std::copy_n(w_.values, S * R * N, w_.end_values);
    if (from.energetic) std::copy_n(from.collected, S * N, from.end_collected);
    if (from.fed) std::copy_n(w_.account, S, w_.end_account);
    std::fill_n(w_.tally, S * TALLY_COUNT, 0.0f);
    std::fill_n(from.seconds, PART_COUNT, 0.0f), *from.memory = 0;
  }

  void join(Creature::Start count) {
    r.nodes = count.nodes, r.edges = count.edges, r.joints = count.joints;
    r.bodies = int(one_.size()), r.commands = GIVEN, r.observed = false;
    r.recurrent = r.waves = r.actuated = false, r.senses = 0;  // Creatures command themselves.
    r.rows = r.links = r.inputs = r.sites = r.timers = 0;
    r.control = w_.actuation;
    r.positions = positions_.data(), r.angles = angles_.data(), r.boxes = boxes_.data();
    r.collected = collected_.data(), r.ends = ends_.data(), r.pairs = pairs_.data();
    r.member = member_.data(), r.piece = piece_.data(), r.present = present_.data();
    r.layout_angle = layout_angle_.data(), r.layout_rest_angle = layout_rest_angle_.data();
    r.bends = bends_.data(), r.edge_colour = edge_colour_.data();
    r.joint_colour = joint_colour_.data(), r.whole = whole_.data();
    r.stretch = stretch_.data(), r.shear = shear_.data(), r.bend = bend_.data();
    r.given_angle = rest_angle_.data(), r.given_length = rest_length_.data();
    r.end_positions = end_positions_.data(), r.end_angles = end_angles_.data();
    r.end_boxes = end_boxes_.data(), r.end_collected = end_collected_.data();
  }

  void centre(const Bodies& b, const Nodes& n, int body, float* to) const {
    Sum sx, sy;
    each(b.bodies[body], [&](int i, int part) __attribute__((always_inline)) {
      const Vec here = load(n.here + i);
      sx.add(part, here * load(n.x + i)), sy.add(part, here * load(n.y + i));
    });
    const float count = divisor(float(one_[body]->node_count()));
    to[0] = sx.total() / count, to[1] = sy.total() / count;
  }

  float heading(const Bodies& b, const Nodes& n, int body) const {
    const Creature& c = *one_[body];
    double sum = 0;
    for (int k = 0; k < c.edge_count(); k++) sum += n.angle[b.edge_slot[c.at.edges + k]];
    return c.edge_count() ? float(sum / c.edge_count()) : 0;
  }

  void write(const Bodies& b, const Nodes& n, int body, float* to) const {
    const Noted& t = tallies_[body];
    float now[2];
    centre(b, n, body, now);
    for (int axis : {0, 1})
      to[TALLY_DISPLACED_X + axis] = (now[axis] - t.first[axis]) +
                                     (n.boxes[2 * body + axis] - t.first_boxes[axis]) * size(axis);
    to[TALLY_PATH] = float(t.path), to[TALLY_TURNED] = heading(b, n, body) - t.heading;
    to[TALLY_WORK] = float(t.work), to[TALLY_CONTACT] = float(t.contact),
    to[TALLY_LIMITED] = float(t.limited);
    to[TALLY_TOUCHED] = float(t.touched), to[TALLY_CAPPED] = float(t.capped);
    to[TALLY_NEAR] = 1.7320508f * root(t.near);
  }

  // What the nodes of a creature sense, (sense, node).
  void look(const Creature& c, const Bodies& b, const Nodes& n, const Forcing& f, const Points& p,
            const Lattice& l, const Energy& e, const Food& food, const Repulsion& repulsion,
            float* sensed, float* ax, float* ay) const {
    const int count = c.node_count();
    auto slot = [&](int k) { return b.node_slot[c.at.nodes + k]; };
    auto senses = [&](int sense) { return w_.r.senses & sense; };
    auto energy = [&](float x, float y) { return r.fed ? food.at(x, y, l) : e.at(x, y, l); };
    if (senses(SENSED_ENERGY_ACROSS | SENSED_FLOW_ALONG | SENSED_FLOW_ACROSS))
      normals(c, b, n, ax, ay);
    if (senses(SENSED_ENERGY)) {
      for (int k = 0; k < count; k++)
        sensed[k] = r.fed ? near(food, p, l, slot(k)) : e.near(p, l, slot(k));
      sensed += count;
    }
    if (senses(SENSED_ENERGY_ACROSS)) {
      for (int k = 0; k < count; k++) {
        const float x = n.x[slot(k)], y = n.y[slot(k)], dx = ASIDE * ax[k], dy = ASIDE * ay[k];
        sensed[k] = energy(x + dx, y + dy) - energy(x - dx, y - dy);
      }
      sensed += count;
    }
    if (senses(SENSED_ENERGY_ALONG)) {
      const int last = slot(count - 1), first = slot(0);
      const float rise = energy(n.x[first], n.y[first]) - energy(n.x[last], n.y[last]);
      for (int k = 0; k < count; k++) sensed[k] = rise;
      sensed += count;
    }
    if (senses(SENSED_FLOW_ALONG | SENSED_FLOW_ACROSS)) sensed = stream(c, b, f, sensed, ax, ay);
    if (senses(SENSED_TOUCH)) {
      for (int k = 0; k < count; k++) sensed[k] = repulsion.others(slot(k));
      sensed += count;
    }
    if (senses(SENSED_ACCOUNT))
      for (int k = 0; k < count; k++) sensed[k] = float(accounts[c.body]) / r.rations[FULL];
  }

  float near(const Food& food, const Points& p, const Lattice& l, int slot) const {
    float sum = 0;
    for (int layer = 0; layer < r.layers; layer++)
      sum += food.near(p.window(layer * (p.slots / p.layers) + slot), l);
    return sum / float(r.layers);
  }

  // Speed of the water at the nodes of a creature, less that of its nodes together.
  float* stream(const Creature& c, const Bodies& b, const Forcing& f, float* sensed,
                const float* ax, const float* ay) const {
    const int count = c.node_count();
    auto slot = [&](int k) { return b.node_slot[c.at.nodes + k]; };
    float mean_x = 0, mean_y = 0;
    auto velocity = [&](const Floats& of, int k) {
      return r.layers == 1 ? of[slot(k)] : 0.5f * (of[slot(k)] + of[b.node_slots + slot(k)]);
    };
    for (int k = 0; k < count; k++)
      mean_x += velocity(f.velocity_x, k), mean_y += velocity(f.velocity_y, k);
    mean_x /= divisor(float(count)), mean_y /= divisor(float(count));
    for (int across : {0, 1}) {
      if (!(w_.r.senses & (across ? SENSED_FLOW_ACROSS : SENSED_FLOW_ALONG))) continue;
      for (int k = 0; k < count; k++) {
        const float x = velocity(f.velocity_x, k) - mean_x, y = velocity(f.velocity_y, k) - mean_y;
        sensed[k] = STREAM * (across ? x * ax[k] + y * ay[k] : x * ay[k] - y * ax[k]);
      }
      sensed += count;
    }
    return sensed;
  }

  // Unit vectors across a creature at its nodes, as `filaments.normals`.
  void normals(const Creature& c, const Bodies& b, const Nodes& n, float* ax, float* ay) const {
    std::fill(ax, ax + c.node_count(), 0.0f), std::fill(ay, ay + c.node_count(), 0.0f);
    float angle[LANES];
    for (int first = 0; first < c.edge_count(); first += LANES) {
      const int some = std::min(LANES, c.edge_count() - first);
      for (int k = 0; k < LANES; k++)
        angle[k] = k < some ? n.angle[b.edge_slot[c.at.edges + first + k]] : 0;
      Vec s, cosine;
      sine_cosine(load(angle), s, cosine);
      for (int k = 0; k < some; k++)
        for (int side : {0, 1}) {
          const int node = c.ends[2 * (first + k) + side];
          ax[node] -= s[k], ay[node] += cosine[k];
        }
    }
    for (int k = 0; k < c.node_count(); k++) {
      const float size = root(ax[k] * ax[k] + ay[k] * ay[k] + LEAST);
      ax[k] /= size, ay[k] /= size;
    }
  }

  static constexpr float ASIDE = 2, STREAM = 20, LEAST = 1e-4f;  // As in `world.senses`.
  const Slots& w_;
  List<std::unique_ptr<Creature>> one_;
  List<Noted> tallies_;
  List<int32_t> ends_, pairs_, member_, piece_, present_, bends_, edge_colour_, joint_colour_;
  List<float> positions_, angles_, boxes_, collected_, layout_angle_, layout_rest_angle_, whole_;
  List<float> stretch_, shear_, bend_, rest_angle_, rest_length_;
  List<float> end_positions_, end_angles_, end_boxes_, end_collected_;
};

}  // namespace ISA
}  // namespace microcosmos
