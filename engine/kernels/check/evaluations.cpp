// A hundred random evaluations and a checksum of all that they return: the same for every compiler
// and instruction set. Prints the checksum and how many evaluations stayed finite; `evaluations N`
// carries out N of them.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "../src/step.h"
#include "observed.h"
#include "random.h"

using namespace microcosmos;

namespace {

uint32_t checksum(uint32_t found, const void* data, size_t bytes) {
  for (size_t i = 0; i < bytes; i++) {
    found ^= static_cast<const uint8_t*>(data)[i];
    for (int bit = 0; bit < 8; bit++) found = (found >> 1) ^ (found & 1 ? 0xedb88320u : 0);
  }
  return found;
}

using Numbers = std::vector<float>;
using Indices = std::vector<int32_t>;

struct Evaluation {
  Rollout r = {};
  Numbers parameters, planes[9], positions, angles, energy, collected, layout, stiffness,
      control, bias, weight, timer, ramp, site, gain, lag, body_angle, body_length, uniform_force,
      force_x, force_y, away_x, away_y, sponge, sponge_velocity, smoothing, boxes;
  Indices ends, pairs, member, piece, present, bends, edge_colour, joint_colour, activation, source,
      target, joint_node, walls;
  Numbers rest_angle, rest_length, clock, out[20];
  Numbers places, frames, middles, shown, measures;

  explicit Evaluation(Random& random) {
    r.height = 24 + random.below(20), r.width = 24 + random.below(20), r.steps = 40;
    r.iterations = 1 + random.below(4), r.sweeps = 5, r.bodies = 1;
    r.layers = 1 + (random.below(4) == 0);
    r.threads = 1, r.observed = true;
    r.projection = FORCE_AND_TORQUE, r.delta = Delta(random.below(3));
    r.fluid = random.below(8) != 0, r.energetic = random.below(2), r.repelled = random.below(2);
    const bool chain = random.below(3) != 0;
    r.matched = chain && random.below(2), r.laid_out = r.actuated = chain;
    r.soft = r.matched && random.below(2);
    body(random, chain);
    controller(random);
    place(random);
    surround(random);
    smooth(random);
  }

  void run() {
    if (!r.senses) {
      ISA::develop(r);
      r.given_angle = rest_angle.data(), r.given_length = rest_length.data();
      r.commands = GIVEN;
    }
    ISA::World(r).run();
    summarise();
  }

  bool finite() const { return shown[STATUS] == OK; }

  uint32_t sum(uint32_t found) const {
    for (const Numbers& plane : planes) found = checksum(found, plane.data(), 4 * plane.size());
    for (const Numbers* one : {&rest_angle, &rest_length})
      found = checksum(found, one->data(), 4 * one->size());
    for (const Numbers& one : out) found = checksum(found, one.data(), 4 * one.size());
    for (const Numbers* one : {&places, &frames, &middles, &shown, &measures})
      found = checksum(found, one->data(), 4 * one->size());
    return found;
  }

 private:
  // Measure the motion, over strokes of a quarter of it.
  void summarise() {
    Observed o = observed(r);
    const float scales[3] = {parameters[VISCOSITY], float(r.nodes), float(r.steps) / 4};
    for (int t = 0; t < r.steps && r.senses; t++) clock[t] = float(t + 1);
    o.clock = clock.data(), o.scales = scales;
    places.assign(2 * PLACES, 0), frames.assign(2 * FRAMES * size_t(r.nodes), 0);
    middles.assign(2 * FRAMES, 0), shown.assign(SHOWN, 0), measures.assign(MEASURE_COUNT, 0);
    o.places = places.data(), o.frames = frames.data(), o.middles = middles.data();
    o.shown = shown.data(), o.measures = measures.data();
    ISA::Summary(o).write();
  }

  void body(Random& random, bool chain) {
    const int arms = chain ? 1 : 3, each = chain ? 4 + random.below(14) : 3 + random.below(3);
    const float spacing = random.between(0.75f, 1.0f);
    const int ways[3][2] = {{1, 0}, {0, 1}, {-1, 0}};
    positions = {r.height * random.unit(), r.width * random.unit()};
    Indices first(arms);
    for (int arm = 0; arm < arms; arm++)
      for (int k = 1; k <= each; k++) {
        const int node = int(positions.size() / 2);
        for (int axis : {0, 1})
          positions.push_back(positions[axis] + float(ways[arm][axis]) * float(k) * spacing);
        ends.insert(ends.end(), {k == 1 ? 0 : node - 1, node});
        angles.push_back(ways[arm][1] ? 1.5707964f : ways[arm][0] < 0 ? 3.1415927f : 0.0f);
        if (k == 1) first[arm] = int(ends.size() / 2) - 1;
        if (k > 1) pairs.insert(pairs.end(), {int(ends.size() / 2) - 2, int(ends.size() / 2) - 1});
      }
    for (int arm = 1; arm < arms; arm++) pairs.insert(pairs.end(), {first[arm - 1], first[arm]});
    r.nodes = int(positions.size() / 2), r.edges = int(ends.size() / 2);
    r.joints = int(pairs.size() / 2);
    colour(ends, r.nodes, edge_colour), colour(pairs, r.edges, joint_colour);
    member.assign(r.nodes, 0), piece.assign(r.nodes, 0), present.assign(r.nodes, 1);
    layout.assign(r.nodes, 0), bends.assign(r.joints, 1);
    stiffness.assign(r.edges, r.matched && !r.soft ? 1.0f : random.between(0.5f, 1.0f));
    body_length.assign(r.edges, spacing);
    for (int j = 0; j < r.joints; j++)
      body_angle.push_back(angles[pairs[2 * j + 1]] - angles[pairs[2 * j]]);
  }

  // The least colour that no pair before with a common item has.
  static void colour(const Indices& of, int items, Indices& found) {
    std::vector<uint32_t> used(items);
    for (size_t i = 0; i < of.size(); i += 2) {
      int number = 0;
      while ((used[of[i]] | used[of[i + 1]]) >> number & 1) number++;
      used[of[i]] |= 1u << number, used[of[i + 1]] |= 1u << number;
      found.push_back(number);
    }
  }

  // A network with a hidden node of every kind.
  void controller(Random& random) {
    r.commands = NETWORK, r.timers = 2, r.waves = random.below(2), r.senses = random.below(2);
    r.recurrent = random.below(4) == 0;
    r.sites = 1 + random.below(6);
    r.inputs = r.sites + 2 + 2 * r.waves + r.senses, r.rows = r.inputs + 2 + 9;
    for (int row = 0; row < r.rows; row++) {
      const int hidden = row - r.inputs - 2;
      activation.push_back(hidden >= 0 ? hidden : hidden >= -2 ? random.below(9) : -1);
      bias.push_back(random.between(-1, 1));
    }
    auto link = [&](int from, int to) {
      source.push_back(from), target.push_back(to), weight.push_back(random.between(-2, 2));
    };
    for (int input = 0; input < r.inputs; input++)
      for (int to = r.inputs; to < r.inputs + 2; to++) link(input, to);
    for (int hidden = r.inputs + 2; hidden < r.rows; hidden++) {
      link(random.below(r.inputs), hidden);
      if (hidden > r.inputs + 2) link(hidden - 1, hidden);
      link(hidden, r.inputs + random.below(2));
    }
    r.links = int(source.size());
    control = {0.6f, 0.1f, random.between(0, 6), 0.05f, 0.1f, 4.0f};
    for (int t = 0; t < r.steps; t++) {
      timer.insert(timer.end(), {random.between(-1, 1), random.between(-1, 1)});
      ramp.push_back(float(t) / float(r.steps));
    }
    for (int n = 0; n < r.sites * r.nodes; n++) site.push_back(random.between(-1, 1));
    for (int n = 0; n < r.nodes; n++) lag.push_back(random.between(0, 7));
    for (int j = 0; j < r.joints; j++) {
      joint_node.push_back(ends[2 * pairs[2 * j] + 1]);
      gain.push_back(random.between(-1, 1));
    }
  }

  void place(Random& random) {
    parameters.assign(STEP_LENGTHS, 0);
    parameters[VISCOSITY] = random.between(0.02f, 0.5f);
    parameters[NU_C] = INFINITY;
    parameters[ENERGY_RATE] = random.below(2) ? 0.1f : -1;
    parameters[DIFFUSION] = random.below(2) * 0.05f;
    parameters[DISPLACEMENT_LIMIT] = parameters[FORCE_LIMIT] = 0.1f;
    parameters[FORCE_FACTOR] = 2, parameters[THETA_FEEDBACK] = 1, parameters[REPULSION] = 4;
    parameters[REPULSION_LIMIT] = 0.1f, parameters[BARRIER_LIMIT] = 0.5f;
    for (int n = 0; n < r.iterations; n++) parameters.push_back(1);
    const size_t cells = size_t(r.height) * r.width, T = r.steps;
    for (int i = 0; i < 9; i++) {
      planes[i].assign(cells, 0);
      r.populations[i] = r.end_populations[i] = planes[i].data();
    }
    for (size_t i = 0; i < cells; i++) energy.push_back(random.unit());
    collected.assign(r.nodes, 0);
    rest_angle.assign(T * r.joints, 0), rest_length.assign(T * r.edges, 0), clock.assign(T, 0);
    r.parameters = parameters.data(), r.positions = positions.data(), r.angles = angles.data();
    r.energy = energy.data(), r.collected = collected.data(), r.ends = ends.data();
    r.pairs = pairs.data(), r.member = member.data(), r.piece = piece.data();
    boxes = {float(random.below(9)), -float(random.below(9))}, r.boxes = boxes.data();
    r.present = present.data(), r.layout_angle = r.layout_rest_angle = layout.data();
    r.bends = bends.data(), r.whole = layout.data(), r.edge_colour = edge_colour.data();
    r.joint_colour = joint_colour.data(), r.stretch = r.shear = r.bend = stiffness.data();
    r.control = control.data(), r.activation = activation.data(), r.bias = bias.data();
    r.source = source.data(), r.target = target.data(), r.weight = weight.data();
    r.timer = timer.data(), r.ramp = ramp.data(), r.site = site.data(), r.lag = lag.data();
    r.joint_node = joint_node.data(), r.gain = gain.data(), r.body_angle = body_angle.data();
    r.body_length = body_length.data();
    r.rest_angle = rest_angle.data(), r.rest_length = rest_length.data(), r.clock = clock.data();
    const size_t N = r.nodes, J = r.joints;
    float** results[] = {&r.end_positions, &r.end_angles, &r.end_energy, &r.end_collected,
                         &r.centre,        &r.path,       &r.speed,      &r.node_speed,
                         &r.held,          &r.heading,    &r.curvature,  &r.power,
                         &r.force,         &r.end_boxes,  &r.box};
    const size_t sizes[] = {2 * N, size_t(r.edges), cells, N,     2 * T, 2 * T * N, T,    T, T,
                            T,     T * J,           T,     2 * T, 2,     2 * T};
    for (int i = 0; i < 15; i++) out[i].assign(sizes[i], 0), *results[i] = out[i].data();
  }

  // Weights over the whole world, which fall with the distance.
  void smooth(Random& random) {
    for (int i = 0; i < 2 * 64; i++) smoothing.push_back(random.between(-1, 1) / float(4 + i % 64));
    r.smoothing_x = r.smoothing_y = smoothing.data();
  }

  // A tenth of the cells are walls, another tenth a sponge. What keeps bodies out and the forces
  // differ from cell to cell.
  void surround(Random& random) {
    r.driven = random.below(3) == 0, r.walled = random.below(3) == 0;
    r.damped = random.below(3) == 0, r.barred = random.below(3) == 0;
    r.varied = random.below(3) == 0;
    uniform_force = {random.between(-5e-5f, 5e-5f), random.between(-5e-5f, 5e-5f)};
    sponge_velocity = {random.between(-0.05f, 0.05f), random.between(-0.05f, 0.05f)};
    for (int i = 0; i < r.height * r.width; i++) {
      walls.push_back(random.below(10) == 0);
      sponge.push_back(random.below(10) == 0 ? random.unit() : 0);
      for (Numbers* away : {&away_x, &away_y}) away->push_back(random.between(-0.2f, 0.2f));
      for (Numbers* force : {&force_x, &force_y}) force->push_back(random.between(-5e-5f, 5e-5f));
    }
    r.uniform_force = uniform_force.data(), r.walls = walls.data();
    r.sponge = sponge.data(), r.sponge_velocity = sponge_velocity.data();
    r.away_x = away_x.data(), r.away_y = away_y.data();
    r.force_x = force_x.data(), r.force_y = force_y.data();
  }
};

}  // namespace

int main(int count, char** arguments) {
  const int evaluations = count > 1 ? std::atoi(arguments[1]) : 100;
  Random random = {2463534242u};
  uint32_t found = ~0u;
  int finite = 0;
  for (int i = 0; i < evaluations; i++) {
    Evaluation one(random);
    one.run();
    found = one.sum(found), finite += one.finite();
  }
  std::printf("%08x %d\n", ~found, finite);
}
