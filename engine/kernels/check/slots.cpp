// Random crowds for sanitisers: slots with any creatures that the boundary lets pass, with numbers
// that are not finite. Every array has its exact size. `slots N [FIRST]` simulates N of them from
// number FIRST on, and prints how many creatures lived. A crowd that several threads simulate with
// other results than one, or in which the order of slots, empty slots or the cut of a window
// matter, ends the program with status 1; so does a quantum of food that is lost.
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>

#include "../src/calls.h"
#include "../src/step.h"
#include "made.h"

using namespace microcosmos;

namespace {

constexpr int LENGTHS[] = {1, 2, 3, 4, 15, 16, 17, 31, 32, 33, 64, 65};
constexpr int SIDES[] = {4, 5, 7, 16, 17, 19, 32, 33, 48};

class Crowd : Made {
 public:
  int lived = 0;

  explicit Crowd(uint32_t number) : Made(number) {
    Rollout& r = w_.r;
    r.height = any(random_, SIDES), r.width = any(random_, SIDES), r.steps = random_.below(6);
    r.iterations = 1 + random_.below(3), r.sweeps = random_.below(3);
    r.layers = 1 + random_.below(2), r.projection = Projection(random_.below(3));
    r.delta = Delta(random_.below(3)), r.fixed_magic = coin(), r.fluid = !few();
    r.repelled = coin(), r.paired = r.repelled && r.height >= 16 && r.width >= 16 && !few();
    r.energetic = few(), r.fed = !r.energetic && coin();
    r.observed = false, r.threads = 1, r.timed = few(), r.laid_out = r.actuated = true;
    r.matched = !few(), r.soft = r.matched && coin(), r.bodies = 1, r.commands = NETWORK;
    w_.slots = 1 + random_.below(6), w_.every = 1 + random_.below(4);
    creatures(), networks(), state(), surround();
  }

  bool sound() const { return refused(w_).empty(); }

  // Return what is wrong with the results; nullptr: nothing.
  const char* wrong() {
    const std::string found = run(w_), measured = measures();
    if (w_.r.fed && !balanced()) return "loses food";
    w_.r.threads = 2 + random_.below(3);
    if (run(w_) != found || measures() != measured) return "depends on the number of threads";
    w_.r.threads = 1;
    if (cut() != found) return "depends on the cut of the window";
    if (order() != found || measures() != measured)
      return "depends on the order of slots, or on empty ones";
    return nullptr;
  }

 private:
  Slots w_ = {};

  struct Part {
    const void* start;
    void* end;
    size_t items;  // Of one slot.
  };
  std::vector<Part> parts_;  // What goes on in the next window, by slot.
  std::vector<std::pair<const int32_t**, size_t>> held_;  // What slots hold.
  std::vector<std::pair<const float**, size_t>> held_numbers_;

  void whole(const int32_t*& to, size_t items, int least, int limit) {
    to = indices(w_.slots * items, least, limit);
    held_.push_back({&to, items});
  }
  void real(const float*& to, size_t items, float low, float high) {
    to = numbers(w_.slots * items, low, high);
    held_numbers_.push_back({&to, items});
  }
  void part(const float*& to, float*& end, size_t items, float low, float high) {
    to = numbers(w_.slots * items, low, high), end = room(w_.slots * items);
    parts_.push_back({to, end, items});
  }

  void creatures() {
    Rollout& r = w_.r;
    r.nodes = any(random_, LENGTHS), r.edges = r.nodes, r.joints = few() ? 0 : r.nodes;
    const int S = w_.slots, N = r.nodes, E = r.edges, J = r.joints;
    w_.filled = few() ? indices(S, 0, 2) : indices(S, 1 - few(), 2);
    held_.push_back({&w_.filled, 1});
    std::vector<int32_t> numbers(S), ends, pairs;
    std::iota(numbers.begin(), numbers.end(), random_.below(9));
    for (int s = S; s-- > 1;) std::swap(numbers[s], numbers[random_.below(s + 1)]);
    w_.number = indices(numbers), held_.push_back({&w_.number, 1});
    for (int s = 0; s < S; s++) {
      // Open and closed filaments, or any graph.
      const int kind = random_.below(3);
      for (int e = 0; e < E; e++) {
        const int next = kind == 0 && e + 1 == N ? e : (e + 1) % N;
        ends.push_back(kind == 2 ? random_.below(N) : e);
        ends.push_back(kind == 2 ? random_.below(N) : next);
      }
      for (int j = 0; j < J; j++) {
        pairs.push_back(kind == 2 ? random_.below(E) : j);
        pairs.push_back(kind == 2 ? random_.below(E) : (j + 1) % E);
      }
    }
    r.ends = indices(ends), held_.push_back({&r.ends, size_t(2 * E)});
    r.pairs = indices(pairs), held_.push_back({&r.pairs, size_t(2 * J)});
    whole(r.piece, N, 0, few() ? N : 1), whole(r.present, N, few() ? 0 : 1, 2);
    whole(r.bends, J, few() ? 0 : 1, 2);
    real(r.layout_angle, E, -3, 3), real(r.layout_rest_angle, J, -1, 1);
    whole(r.edge_colour, r.matched ? 0 : E, 0, E);
    whole(r.joint_colour, r.matched ? 0 : J, 0, std::max(J, 1));
    real(r.whole, r.matched ? 0 : J, -7, 7);
    real(r.stretch, E, 0, 1), real(r.shear, E, 0, 1), real(r.bend, J, 0, 1);
  }

  void networks() {
    Rollout& r = w_.r;
    r.recurrent = coin(), r.waves = coin(), r.timers = 2, r.sites = random_.below(4);
    r.senses = coin() ? 0 : random_.below(ALL_SENSES + 1);
    if (!r.energetic && !r.fed) r.senses &= ~7;
    if (!r.fluid) r.senses &= ~24;
    if (!r.fed) r.senses &= ~SENSED_ACCOUNT;
    r.inputs = r.sites + (r.waves ? 4 : 2) + count_of(r.senses);
    r.rows = r.inputs + 2 + random_.below(5), r.links = random_.below(20);
    const int S = w_.slots;
    std::vector<int32_t> activation;
    for (int s = 0; s < S; s++)
      for (int row = 0; row < r.rows; row++)
        activation.push_back(row < r.inputs ? -1 : random_.below(10) - 1);
    r.activation = indices(activation), held_.push_back({&r.activation, size_t(r.rows)});
    real(r.bias, r.rows, -1, 1);
    links();
    real(r.weight, r.links, -3, 3), real(r.site, r.sites * size_t(r.nodes), -1, 1);
    real(r.lag, r.waves * size_t(r.nodes), 0, 7);
    std::vector<int32_t> nodes;
    for (int s = 0; s < S; s++)
      for (int j = 0; j < r.joints; j++) {
        int node = random_.below(r.nodes);
        // A joint turns by the output at a node that has grown, if there is one.
        for (int n = 0; n < r.nodes && !r.present[s * r.nodes + node]; n++)
          node = (node + 1) % r.nodes;
        nodes.push_back(node);
      }
    r.joint_node = indices(nodes), held_.push_back({&r.joint_node, size_t(r.joints)});
    real(r.gain, r.joints, -1, 1), real(r.body_length, r.edges, 0, 2);
    float* actuation = room(size_t(S) * ACTUATION_COUNT);  // The boundary refuses wild ones.
    for (int s = 0; s < S; s++) {
      float* mine = actuation + s * ACTUATION_COUNT;
      for (int one = 0; one < ACTUATION_COUNT; one++) mine[one] = random_.between(1e-4f, 1);
      for (int bound : {MAX_SPEED, MAX_BEND})
        if (few()) mine[bound] = INFINITY;
      if (few()) mine[PHASE] = 0;
      mine[PERIOD] = random_.between(1, 300), mine[RAMP] = few() ? 0 : random_.between(0, 99);
    }
    w_.actuation = actuation, held_numbers_.push_back({&w_.actuation, ACTUATION_COUNT});
  }

  // Without cycles, unless they are allowed: a network that is not recurrent has no memory.
  void links() {
    Rollout& r = w_.r;
    std::vector<int32_t> sources, targets;
    for (int n = 0; n < w_.slots * r.links; n++) {
      const int target = r.inputs + random_.below(r.rows - r.inputs);
      const int hidden = target < r.inputs + 2 ? r.rows : target, first = r.inputs + 2;
      int source = random_.below(r.inputs + std::max(hidden - first, 0));
      source += source < r.inputs ? 0 : 2;
      sources.push_back(few() ? -1 : r.recurrent ? random_.below(r.rows) : source);
      targets.push_back(target);
    }
    r.source = indices(sources), held_.push_back({&r.source, size_t(r.links)});
    r.target = indices(targets), held_.push_back({&r.target, size_t(r.links)});
  }

  void state() {
    Rollout& r = w_.r;
    const size_t S = w_.slots, N = r.nodes, E = r.edges, J = r.joints, H = r.height;
    const size_t cells = H * r.width;
    for (int i = 0; i < 9; i++)
      r.populations[i] = numbers(cells, -0.01f, 0.01f), r.end_populations[i] = room(cells);
    const float far = few() ? 1e6f : 60;
    part(r.positions, r.end_positions, 2 * N, -far, far);
    part(r.angles, r.end_angles, E, -4, 4), part(r.boxes, r.end_boxes, 2, -9, 9);
    part(w_.shape_angles, w_.end_shape_angles, SHAPE_COUNT * J, -1, 1);
    part(w_.shape_lengths, w_.end_shape_lengths, SHAPE_COUNT * E, 0, 2);
    part(w_.values, w_.end_values, r.recurrent * r.rows * N, -1, 1);
    part(r.collected, r.end_collected, r.energetic * N, 0, 1);
    w_.age = indices(S, 0, few() ? INT32_MAX : 500), w_.end_age = indices(S, 0, 1);
    parts_.push_back({w_.age, w_.end_age, 1});
    w_.account = indices(r.fed * S, 0, few() ? INT32_MAX : 1 << 20);
    w_.end_account = indices(r.fed * S, 0, 1);
    parts_.push_back({w_.account, w_.end_account, size_t(r.fed)});
    r.energy = numbers(r.energetic * cells, 0, 1), r.end_energy = room(r.energetic * cells);
    r.food = indices(r.fed * cells, 0, 1 << 20), r.end_food = indices(r.fed * cells, 0, 1);
    r.capacity = indices(r.fed * cells, 0, 1 << 20);
    r.time = indices(r.fed, 0, 100), r.end_time = indices(r.fed, 0, 1);
    r.grown = indices(r.fed * 2 * H, 0, 1), r.lost = indices(r.fed * 2 * H, 0, 1);
    r.carried = r.fed && r.fluid && coin(), r.food_every = 1 + random_.below(6);
    // Shares are not wild: the boundary has them from a spec.
    float* rations = room(r.fed * RATION_COUNT);
    if (r.fed) {
      const float bite = coin() ? 9000 : std::min(16777216.0f, 1073741824.0f / float(r.nodes));
      const float most[] = {bite, 1, 1, 0.25f, 1e6f, 1e6f};
      for (int i = 0; i < RATION_COUNT; i++) rations[i] = random_.between(i > 3, most[i]);
    }
    r.rations = rations, w_.tally = room(S * TALLY_COUNT);
    r.seconds = room(PART_COUNT), r.memory = room(1);
  }

  void surround() {
    Rollout& r = w_.r;
    const size_t cells = size_t(r.height) * r.width, smoothed = r.repelled && !r.paired ? 2 : 0;
    r.driven = few(), r.varied = few(), r.walled = few(), r.barred = few(), r.damped = few();
    r.smoothing_x = numbers(smoothed * r.height, -0.2f, 0.2f);
    r.smoothing_y = numbers(smoothed * r.width, -0.2f, 0.2f);
    r.uniform_force = numbers(r.driven * 2, -1e-3f, 1e-3f);
    r.force_x = numbers(r.varied * cells, -1e-3f, 1e-3f);
    r.force_y = numbers(r.varied * cells, -1e-3f, 1e-3f);
    r.walls = indices(r.walled * cells, 0, 2);
    r.away_x = numbers(r.barred * cells, -2, 2), r.away_y = numbers(r.barred * cells, -2, 2);
    r.sponge = numbers(r.damped * cells, 0, 1);
    r.sponge_velocity = numbers(r.damped * 2, -0.1f, 0.1f);
    float* parameters = numbers(STEP_LENGTHS + r.iterations, 0.01f, 1);
    if (coin()) parameters[ENERGY_RATE] = -1;
    for (int one : {NU_C, DISPLACEMENT_LIMIT, FORCE_LIMIT})
      if (coin()) parameters[one] = INFINITY;
    r.parameters = parameters;
  }

  // Add four bytes an item. All NaN are one: their sign depends on the compiler.
  static void add(std::string& to, const void* from, size_t items) {
    for (size_t i = 0; i < items; i++) {
      uint32_t word;
      std::memcpy(&word, static_cast<const char*>(from) + 4 * i, 4);
      if ((word & 0x7fffffff) > 0x7f800000) word = 0x7fc00000;
      to.append(reinterpret_cast<const char*>(&word), 4);
    }
  }

  // Simulate, and return the bytes of the end; of slots in the order of their creatures.
  std::string run(const Slots& w) {
    ISA::live(w);
    lived = 0;
    std::string found;
    const Rollout& r = w.r;
    const size_t cells = size_t(r.height) * r.width;
    for (int i = 0; i < 9; i++) add(found, r.end_populations[i], cells);
    add(found, r.end_energy, r.energetic * cells), add(found, r.end_food, r.fed * cells);
    add(found, r.end_time, r.fed);
    for (int s : living(w)) {
      lived++;
      for (const Part& one : parts_)
        add(found, static_cast<const char*>(one.end) + 4 * s * one.items, one.items);
    }
    return found;
  }

  // The bytes of the measures, of slots in the order of their creatures.
  std::string measures() const {
    std::string found;
    add(found, w_.r.grown, w_.r.fed * 2 * w_.r.height),
        add(found, w_.r.lost, w_.r.fed * 2 * w_.r.height);
    for (int s : living(w_)) add(found, w_.tally + s * TALLY_COUNT, TALLY_COUNT);
    return found;
  }

  static std::vector<int> living(const Slots& w) {
    std::vector<int> order;
    for (int s = 0; s < w.slots; s++)
      if (w.filled[s]) order.push_back(s);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return w.number[a] < w.number[b]; });
    return order;
  }

  bool balanced() const {
    const Rollout& r = w_.r;
    const size_t cells = size_t(r.height) * r.width;
    int64_t sum = 0;
    for (size_t i = 0; i < cells; i++) sum += r.end_food[i] - r.food[i];
    for (int s = 0; s < w_.slots; s++) sum += w_.end_account[s] - w_.account[s];
    for (int x = 0; x < 2 * r.height; x++)
      sum += (x & 1 ? 1 : 4096) * int64_t(r.lost[x] - r.grown[x]);
    return sum == 0;
  }

  // The same in two windows.
  std::string cut() {
    Slots one = w_, other = w_;
    one.r.steps = random_.below(w_.r.steps + 1), other.r.steps = w_.r.steps - one.r.steps;
    run(one);
    // The ends of the first are the start of the second.
    std::vector<std::vector<char>> kept;
    auto keep = [&](const void* end, size_t items) {
      const char* from = static_cast<const char*>(end);
      kept.emplace_back(from, from + 4 * items);
      return kept.back().data();
    };
    Rollout& r = other.r;
    const size_t S = w_.slots, cells = size_t(r.height) * r.width;
    auto of = [&](auto*& start, const void* end, size_t items) {
      start = reinterpret_cast<std::remove_reference_t<decltype(start)>>(keep(end, items));
    };
    for (int i = 0; i < 9; i++) of(r.populations[i], r.end_populations[i], cells);
    of(r.positions, r.end_positions, 2 * S * r.nodes), of(r.angles, r.end_angles, S * r.edges);
    of(r.boxes, r.end_boxes, 2 * S), of(other.age, w_.end_age, S);
    of(other.shape_angles, w_.end_shape_angles, S * SHAPE_COUNT * r.joints);
    of(other.shape_lengths, w_.end_shape_lengths, S * SHAPE_COUNT * r.edges);
    of(other.values, w_.end_values, S * r.recurrent * r.rows * r.nodes);
    of(r.collected, r.end_collected, S * r.energetic * r.nodes);
    of(r.energy, r.end_energy, r.energetic * cells), of(r.food, r.end_food, r.fed * cells);
    of(r.time, r.end_time, r.fed), of(other.account, w_.end_account, r.fed * S);
    return run(other);
  }

  // The same with the slots the other way round, and with anything in empty ones.
  std::string order() {
    for (auto& [to, items] : held_) turn(*to, items);
    for (auto& [to, items] : held_numbers_) turn(*to, items);
    for (const Part& one : parts_) turn(static_cast<const int32_t*>(one.start), one.items);
    for (auto& [to, items] : held_)
      if (to != &w_.filled) litter(*to, items);
    for (auto& [to, items] : held_numbers_) litter(*to, items);
    for (const Part& one : parts_)
      // The boundary looks at ages and accounts of all slots.
      if (one.start != w_.age && one.start != w_.account)
        litter(static_cast<const int32_t*>(one.start), one.items);
    return run(w_);
  }

  // Write bytes into what an empty slot has: no number at all, or one that refers to nothing.
  template <class T>
  void litter(const T* given, size_t items) {
    for (int s = 0; s < w_.slots; s++)
      if (!w_.filled[s]) std::memset(const_cast<T*>(given) + s * items, 0xff, 4 * items);
  }

  // The arrays are ours, so they may be changed.
  template <class T>
  void turn(const T* given, size_t items) {
    T* values = const_cast<T*>(given);
    for (int s = 0; s < w_.slots / 2; s++)
      std::swap_ranges(values + s * items, values + (s + 1) * items,
                       values + (w_.slots - 1 - s) * items);
  }
};

}  // namespace

int main(int count, char** arguments) {
  const int crowds = count > 1 ? std::atoi(arguments[1]) : 1000;
  const int first = count > 2 ? std::atoi(arguments[2]) : 0;
  int lived = 0;
  for (int number = first; number < first + crowds; number++) {
    Crowd one{uint32_t(number)};
    if (!one.sound()) continue;
    if (const char* wrong = one.wrong()) {
      std::printf("crowd %d %s\n", number, wrong);
      return 1;
    }
    lived += one.lived;
  }
  std::printf("%d crowds, %d creatures lived\n", crowds, lived);
}
