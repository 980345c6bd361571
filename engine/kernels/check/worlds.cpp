// Random tiny worlds and bodies for sanitisers: whatever the boundary lets pass, at the edges of
// all sizes, with numbers that are not finite. Every array has its exact size. `worlds N [FIRST]`
// simulates N of them from number FIRST on, and prints how many ended finite. A world that is not
// finite at its end, and whose status does not say so, or that several threads simulate with other
// results than one, ends the program with status 1.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "../src/step.h"
#include "made.h"
#include "observed.h"

using namespace microcosmos;

namespace {

constexpr int LENGTHS[] = {1, 2, 3, 4, 15, 16, 17, 31, 32, 33, 64, 65, 128, 129};
constexpr int SIDES[] = {4, 5, 6, 7, 15, 16, 17, 19, 31, 32, 33, 48};

class Fuzzed : Made {
 public:
  explicit Fuzzed(uint32_t number) : Made(number) {
    r.height = any(random_, SIDES), r.width = any(random_, SIDES), r.steps = random_.below(5);
    r.iterations = 1 + random_.below(4), r.sweeps = random_.below(4);
    r.layers = 1 + random_.below(2), r.projection = Projection(random_.below(3));
    r.delta = Delta(random_.below(3)), r.fixed_magic = coin(), r.fluid = !few();
    r.repelled = coin(), r.energetic = coin();
    r.paired = r.repelled && r.height >= 16 && r.width >= 16 && coin();
    r.observed = true, r.threads = 1, r.timed = few();
    if (coin())
      filaments();
    else
      graph();
    layout();
    controller();
    place();
    surround();
    r.observed = r.commands != GIVEN || !few();
  }

  void run() {
    if (r.commands != GIVEN && !r.senses && coin()) {
      Rollout developed = r;
      developed.matched = true;  // Nothing is swept.
      ISA::develop(developed);
      r.given_angle = r.rest_angle, r.given_length = r.rest_length, r.commands = GIVEN;
      developed_ = true;
    }
    ISA::World(r).run();
  }

  // Whether several threads give the same results.
  bool repeated() {
    const auto before = all_numbers();
    r.threads = 2 + random_.below(4);
    ISA::World(r).run();
    return before == all_numbers();
  }

  // Whether populations and present nodes are finite at the end. Without a fluid, populations stay
  // what they were given as.
  bool finite() const {
    for (int i = 0; i < 9 && r.fluid; i++)
      if (!all_finite(r.end_populations[i], r.height * r.width)) return false;
    for (int n = 0; n < r.nodes; n++)
      if (r.present[n] && !all_finite(r.end_positions + 2 * n, 2)) return false;
    return true;
  }

  // Whether the status is that of a world that is not finite, where it is not.
  bool reported() { return !r.steps || !r.observed || finite() || status() == NON_FINITE; }

 private:
  Rollout r = {};
  bool developed_ = false;

  // The bytes of all arrays but the times and the memory.
  std::string all_numbers() {
    std::string found;
    std::fill(r.seconds, r.seconds + PART_COUNT, 0.0f), *r.memory = 0;
    for (size_t i = 0; i < counts_.size(); i++)
      found.append(reinterpret_cast<const char*>(floats_[i].get()), 4 * counts_[i]);
    return found;
  }

  static bool all_finite(const float* values, int count) {
    return std::all_of(values, values + count, [](float x) { return std::isfinite(x); });
  }

  // The status by the summary of the motion.
  int status() {
    Observed o = observed(r);
    for (int t = 0; t < r.steps; t++)
      if (!developed_) r.clock[t] = tamed(float(t + 1));
    o.clock = r.clock, o.scales = numbers(3, 0.01f, 10);
    float* shown = room(SHOWN);
    o.places = room(2 * PLACES), o.frames = room(2 * FRAMES * size_t(r.nodes));
    o.middles = room(2 * FRAMES), o.shown = shown, o.measures = room(MEASURE_COUNT);
    ISA::Summary(o).write();
    return int(shown[STATUS]);
  }

  // Weights along an axis of so many cells, for worlds with repulsion: a few, or one for each.
  float* weights(int cells) {
    const bool smoothed = r.repelled && !r.paired;
    float* found = numbers(smoothed * 2 * cells, -0.2f, 0.2f);
    if (smoothed && coin())
      for (int i = 0; i < 2 * cells; i++)
        if (i % cells > 2 && i % cells < cells - 3) found[i] = 0;
    return found;
  }

  // Open and closed filaments, each a body and a piece.
  void filaments() {
    std::vector<int32_t> ends, pairs, member, edge_colour, joint_colour;
    r.bodies = 1 + random_.below(4);
    for (int body = 0; body < r.bodies; body++) {
      const int count = few() ? 1 + random_.below(200) : any(random_, LENGTHS);
      const int first = int(member.size()), edge = int(ends.size() / 2);
      const bool closed = count > 2 && coin();
      const int edges = closed ? count : count - 1, joints = closed ? count : count - 2;
      for (int n = 0; n < count; n++) member.push_back(body);
      for (int e = 0; e < edges; e++) {
        ends.insert(ends.end(), {first + e, first + (e + 1) % count});
        edge_colour.push_back(closed && count % 2 && e == count - 1 ? 2 : e % 2);
      }
      for (int j = 0; j < joints; j++) {
        pairs.insert(pairs.end(), {edge + j, edge + (j + 1) % edges});
        joint_colour.push_back(closed && count % 2 && j == count - 1 ? 2 : j % 2);
      }
    }
    r.nodes = int(member.size()), r.edges = int(ends.size() / 2), r.joints = int(pairs.size() / 2);
    r.ends = indices(ends), r.pairs = indices(pairs), r.member = indices(member);
    r.piece = indices(member);
    r.edge_colour = indices(edge_colour), r.joint_colour = indices(joint_colour);
  }

  // Any graph that refers to what is there, even with loops, with bodies without nodes and with
  // colours that do not separate constraints.
  void graph() {
    r.nodes = 1 + random_.below(40), r.edges = few() ? 0 : random_.below(60);
    r.joints = r.edges && !few() ? random_.below(60) : 0, r.bodies = 1 + random_.below(5);
    r.ends = indices(2 * r.edges, 0, r.nodes), r.pairs = indices(2 * r.joints, 0, r.edges);
    r.member = indices(r.nodes, 0, r.bodies), r.piece = indices(r.nodes, 0, r.nodes);
    r.edge_colour = indices(r.edges, 0, r.edges), r.joint_colour = indices(r.joints, 0, r.joints);
  }

  void layout() {
    r.present = few() ? indices(r.nodes, 0, 2) : indices(r.nodes, 1 - few(), 2);
    r.laid_out = coin(), r.matched = r.laid_out && coin(), r.actuated = r.laid_out && coin();
    r.soft = r.matched && coin();
    const size_t E = r.edges, J = r.joints, laid = r.laid_out;
    r.layout_angle = numbers(laid * E, -3, 3), r.layout_rest_angle = numbers(laid * J, -1, 1);
    r.bends = few() ? indices(laid * J, 0, 2) : indices(laid * J, 1 - few(), 2);
    r.whole = numbers(!r.matched * J, -7, 7);
    r.stretch = numbers(E, 0, 1), r.shear = numbers(E, 0, 1), r.bend = numbers(J, 0, 1);
  }

  void controller() {
    r.commands = Commands(random_.below(3));
    const bool network = r.commands == NETWORK, series = r.commands == SERIES;
    const size_t N = r.nodes, E = r.edges, J = r.joints, T = r.commands == GIVEN ? 0 : r.steps;
    r.recurrent = network && coin(), r.senses = network && coin();
    r.timers = network ? random_.below(3) : 0, r.waves = r.timers == 2 && coin();
    r.sites = network ? random_.below(8) : 0;
    r.inputs = network ? r.sites + r.timers * (r.waves ? 2 : 1) + r.senses : 0;
    r.rows = network ? r.inputs + 2 + random_.below(8) : 0;
    r.links = network ? random_.below(20) : 0, r.terms = series ? random_.below(5) : 0;
    std::vector<int32_t> activation(r.rows, -1);
    for (int row = r.inputs; row < r.rows; row++) activation[row] = random_.below(10) - 1;
    r.activation = indices(activation), r.bias = numbers(r.rows, -1, 1);
    r.source = indices(r.links, -1, r.rows), r.target = indices(r.links, 0, r.rows);
    r.weight = numbers(r.links, -3, 3), r.timer = numbers(network * T * r.timers, -1, 1);
    r.ramp = numbers(T, 0, 1), r.site = numbers(r.sites * N, -1, 1);
    r.lag = numbers(network * r.waves * N, 0, 7), r.joint_node = indices(network * J, 0, r.nodes);
    r.gain = numbers(network * J, -1, 1);
    r.body_angle = numbers((network || series) * J, -1, 1);
    r.body_length = numbers((network || series) * E, 0, 2);
    r.basis = numbers(series * T * r.terms, -1, 1);
    r.genes = numbers(series * r.terms * (J + E), -1, 1);
    float* control = numbers(BOUND_COUNT, 0, 1);
    for (int bound : {PHASE, MAX_SPEED, MAX_BEND})
      if (few()) control[bound] = 0;
    r.control = control;
    r.rest_angle = room(r.steps * J), r.rest_length = room(r.steps * E), r.clock = room(r.steps);
    const size_t given = r.commands == GIVEN ? r.steps : 0;
    r.given_angle = numbers(given * J, -1, 1), r.given_length = numbers(given * E, 0, 2);
  }

  void surround() {
    const size_t cells = size_t(r.height) * r.width;
    r.driven = few(), r.varied = few(), r.walled = few(), r.barred = few(), r.damped = few();
    r.smoothing_x = weights(r.height), r.smoothing_y = weights(r.width);
    r.uniform_force = numbers(r.driven * 2, -1e-3f, 1e-3f);
    r.force_x = numbers(r.varied * cells, -1e-3f, 1e-3f);
    r.force_y = numbers(r.varied * cells, -1e-3f, 1e-3f);
    r.walls = indices(r.walled * cells, 0, 2);
    r.away_x = numbers(r.barred * cells, -2, 2), r.away_y = numbers(r.barred * cells, -2, 2);
    r.sponge = numbers(r.damped * cells, 0, 1);
    r.sponge_velocity = numbers(r.damped * 2, -0.1f, 0.1f);
  }

  void place() {
    const size_t N = r.nodes, T = r.steps, cells = size_t(r.height) * r.width;
    float* parameters = numbers(STEP_LENGTHS + r.iterations, 0.01f, 1);
    for (int one : {NU_C, ENERGY_RATE, DIFFUSION})
      if (few()) parameters[one] = 0;
    if (coin()) parameters[ENERGY_RATE] = -1;
    for (int one : {NU_C, DISPLACEMENT_LIMIT, FORCE_LIMIT})
      if (coin()) parameters[one] = INFINITY;
    r.parameters = parameters;
    for (int i = 0; i < 9; i++) {
      r.populations[i] = numbers(cells, -0.01f, 0.01f), r.end_populations[i] = room(cells);
    }
    const float far = few() ? 1e6f : 60;
    r.positions = numbers(2 * N, -far, far), r.angles = numbers(r.edges, -4, 4);
    r.boxes = numbers(2 * r.bodies, -9, 9);
    r.energy = numbers(r.energetic * cells, 0, 1), r.collected = numbers(r.energetic * N, 0, 1);
    r.end_positions = room(2 * N), r.end_angles = room(r.edges);
    r.end_boxes = room(2 * r.bodies), r.box = room(2 * T * r.bodies);
    r.end_energy = room(r.energetic * cells), r.end_collected = room(r.energetic * N);
    r.centre = room(2 * T), r.path = room(2 * T * N), r.speed = room(T), r.node_speed = room(T);
    r.held = room(T), r.heading = room(T), r.curvature = room(T * r.joints), r.power = room(T);
    r.force = room(2 * T * r.bodies), r.seconds = room(PART_COUNT), r.memory = room(1);
  }
};

}  // namespace

int main(int count, char** arguments) {
  const int worlds = count > 1 ? std::atoi(arguments[1]) : 1000;
  const int first = count > 2 ? std::atoi(arguments[2]) : 0;
  int finite = 0;
  for (int number = first; number < first + worlds; number++) {
    Fuzzed one{uint32_t(number)};
    one.run();
    finite += one.finite();
    if (!one.repeated()) {
      std::printf("world %d depends on the number of threads\n", number);
      return 1;
    }
    if (!one.reported()) {
      std::printf("world %d does not say that it is not finite\n", number);
      return 1;
    }
  }
  std::printf("%d worlds, %d finite\n", worlds, finite);
}
