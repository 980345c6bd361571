// The numbers, operands and results of the kernel's calls, in the order of `world.native` and
// `search.window`: the same for XLA's interface and for WebAssembly.
#pragma once
#include <cstdint>
#include <string>

#include "rollout.h"
#include "slots.h"
#include "summary.h"

namespace microcosmos {

// Read the sizes of a body and its controller; return what is wrong with them, or "".
template <class Numbers>
std::string read_body(Rollout& r, Numbers number) {
  r.steps = number("steps"), r.bodies = number("bodies");
  r.nodes = number("nodes"), r.edges = number("edges"), r.joints = number("joints");
  r.matched = number("matched"), r.laid_out = number("laid_out");
  r.commands = Commands(number("commands"));
  r.recurrent = number("recurrent"), r.senses = number("senses"), r.waves = number("waves");
  r.actuated = number("actuated"), r.rows = number("rows"), r.links = number("links");
  r.inputs = number("inputs"), r.sites = number("sites"), r.timers = number("timers");
  r.terms = number("terms");
  if (!number.error.empty()) return number.error;
  if (r.commands < GIVEN || r.commands > SERIES) return "there is no such controller";
  for (int32_t one : {r.steps, r.edges, r.joints, r.rows, r.links, r.sites, r.timers, r.terms})
    if (one < 0) return "a count is negative";
  if (r.nodes < 1 || r.bodies < 1) return "a world has at least one node";
  if (r.bodies > r.nodes) return "a body has at least one node";
  if ((r.actuated || r.matched) && !r.laid_out) return "there is no layout";
  if (r.timers > 2 || (r.waves && r.timers != 2)) return "a timer has one or two numbers";
  if (r.sites > r.rows) return "a network has an input for each site";
  if (r.senses < 0 || r.senses > ALL_SENSES) return "there is no such sense";
  const int inputs = r.sites + r.timers * (r.waves ? 2 : 1) + count_of(r.senses);
  if (r.commands == NETWORK && (r.inputs != inputs || r.rows < inputs + 2))
    return "a network has an input for each that it is given, and two outputs";
  return "";
}

// Read the sizes and the form of a world; return what is wrong with them, or "".
template <class Numbers>
std::string read_world(Rollout& r, Numbers number) {
  r.height = number("height"), r.width = number("width");
  r.iterations = number("iterations");
  r.sweeps = number("sweeps"), r.layers = number("layers");
  r.projection = Projection(number("projection"));
  r.delta = Delta(number("delta"));
  r.fixed_magic = number("magic");
  r.soft = number("soft");
  r.fluid = number("fluid"), r.repelled = number("repelled"), r.energetic = number("energetic");
  r.paired = number("paired");
  r.driven = number("driven"), r.varied = number("varied"), r.walled = number("walled"),
  r.barred = number("barred"), r.damped = number("damped"), r.observed = number("observed"),
  r.timed = number("timed"), r.threads = number("threads");
  if (!number.error.empty()) return number.error;
  if (r.height < 4 || r.width < 4) return "a world has at least 4 cells along each axis";
  if (r.paired && (r.height < 16 || r.width < 16))
    return "bodies meet in a world of at least 16 cells along each axis";
  if (r.threads < 1 || r.threads > 1024) return "there is at least one thread, and at most 1024";
  if (!r.observed && r.commands != GIVEN) return "what is commanded is observed";
  if (r.iterations < 1 || r.layers < 1 || r.layers > 2 || r.sweeps < 0)
    return "iterations, sweeps or layers";
  if (r.delta < 0 || r.delta > HAT) return "there is no such delta";
  if (r.projection < NOTHING || r.projection > FORCE_AND_TORQUE)
    return "there is no such projection";
  return "";
}

// Read the numbers of a call; return what is wrong with them, or "".
template <class Numbers>
std::string read_rollout(Rollout& r, Numbers number) {
  std::string wrong = read_body(r, number);
  if (wrong.empty()) wrong = read_world(r, number);
  if (wrong.empty() && r.senses & ~SENSED_ENERGY)
    wrong = "a rollout knows the sense of energy alone";
  return wrong;
}

// Read the numbers of a window; return what is wrong with them, or "".
template <class Numbers>
std::string read_window(Slots& w, Numbers number) {
  std::string wrong = read_body(w.r, number);
  if (wrong.empty()) wrong = read_world(w.r, number);
  if (!wrong.empty()) return wrong;
  w.slots = number("slots"), w.every = number("every");
  w.r.fed = number("fed"), w.r.carried = number("carried");
  w.r.food_every = number("food_every");
  if (!number.error.empty()) return number.error;
  if (w.slots < 1 || w.every < 1) return "there is at least one slot, and a step to a command";
  if (w.r.commands != NETWORK || w.r.timers != 2 || !w.r.laid_out || w.r.bodies != 1)
    return "a slot has one body with a layout and a network with a periodic timer";
  const int32_t of_energy = SENSED_ENERGY | SENSED_ENERGY_ACROSS | SENSED_ENERGY_ALONG;
  const int32_t of_flow = SENSED_FLOW_ALONG | SENSED_FLOW_ACROSS;
  if (w.r.fed && w.r.energetic) return "a world has energy or food";
  if (w.r.fed && w.r.food_every < 1) return "food changes every step or more seldom";
  if (w.r.fed && w.r.carried && !w.r.fluid) return "there is no flow that carries food";
  if (w.r.senses & SENSED_ACCOUNT && !w.r.fed) return "there is no account to sense";
  if (w.r.senses & of_energy && !w.r.energetic && !w.r.fed) return "there is no energy to sense";
  if (w.r.senses & of_flow && !w.r.fluid) return "there is no flow to sense";
  return "";
}

template <class Numbers>
std::string read_development(Rollout& r, Numbers number) {
  const std::string wrong = read_body(r, number);
  if (!wrong.empty()) return wrong;
  if (r.commands == GIVEN || r.senses) return "there is nothing to develop";
  r.matched = true;  // A development sweeps nothing: it needs no colours.
  return "";
}

template <class Numbers>
std::string read_summary(Observed& o, Numbers number) {
  o.height = number("height"), o.width = number("width"), o.steps = number("steps");
  o.nodes = number("nodes"), o.edges = number("edges"), o.joints = number("joints");
  o.bodies = number("bodies"), o.energetic = number("energetic");
  o.driven = number("driven"), o.varied = number("varied"), o.walled = number("walled");
  if (!number.error.empty()) return number.error;
  for (int32_t one : {o.height, o.width, o.steps, o.nodes, o.bodies})
    if (one < 1) return "a motion has at least one step of one node in one cell";
  return "";
}

constexpr char LACKS[] = "the body or the network refers to what it lacks";

inline int64_t when(bool holds, int64_t count) { return holds ? count : 0; }

// Name the arrays of a body at its start. What is absent has no items.
template <class Arrays>
void name_body(Arrays& a, Rollout& r) {
  const int64_t N = r.nodes, E = r.edges, J = r.joints, laid = r.laid_out;
  a.in("positions", &r.positions, {N, 2}), a.in("angles", &r.angles, {E});
  a.in("edges", &r.ends, {E, 2}), a.in("joints", &r.pairs, {J, 2});
  a.in("member", &r.member, {N}), a.in("piece", &r.piece, {N}), a.in("present", &r.present, {N});
  a.in("layout angles", &r.layout_angle, {laid * E});
  a.in("layout rest angles", &r.layout_rest_angle, {laid * J});
  a.in("bends", &r.bends, {laid * J});
}

// Name the arrays of a controller.
template <class Arrays>
void name_controller(Arrays& a, Rollout& r) {
  const int64_t N = r.nodes, E = r.edges, J = r.joints, T = r.steps;
  const int64_t R = r.rows, L = r.links, K = r.terms;
  const bool network = r.commands == NETWORK, series = r.commands == SERIES;
  const bool controlled = network || series;
  a.in("bounds of the controller", &r.control, {BOUND_COUNT});
  a.in("activations", &r.activation, {R}), a.in("biases", &r.bias, {R});
  a.in("sources", &r.source, {L}), a.in("targets", &r.target, {L}), a.in("weights", &r.weight, {L});
  a.in("timer", &r.timer, {when(network, T), r.timers}),
      a.in("ramp", &r.ramp, {when(controlled, T)});
  a.in("sites", &r.site, {r.sites, when(network, N)});
  a.in("lags", &r.lag, {when(network && r.waves, N)});
  a.in("nodes of joints", &r.joint_node, {when(network, J)});
  a.in("gains of joints", &r.gain, {when(network, J)});
  a.in("rest angles of the body", &r.body_angle, {when(controlled, J)});
  a.in("rest lengths of the body", &r.body_length, {when(controlled, E)});
  a.in("basis", &r.basis, {when(series, T), K}), a.in("genes", &r.genes, {K, when(series, J + E)});
}

// Name the arrays of what is around bodies.
template <class Arrays>
void name_surroundings(Arrays& a, Rollout& r) {
  const int64_t H = r.height, W = r.width;
  const int64_t smoothed = when(r.repelled && !r.paired, 2);
  a.in("smoothing across rows", &r.smoothing_x, {smoothed, H});
  a.in("smoothing along rows", &r.smoothing_y, {smoothed, W});
  a.in("uniform force", &r.uniform_force, {when(r.driven, 2)});
  a.in("forces across rows", &r.force_x, {when(r.varied, H), W});
  a.in("forces along rows", &r.force_y, {when(r.varied, H), W});
  a.in("walls", &r.walls, {when(r.walled, H), W});
  a.in("displacements across rows", &r.away_x, {when(r.barred, H), W});
  a.in("displacements along rows", &r.away_y, {when(r.barred, H), W});
  a.in("strength of the sponge", &r.sponge, {when(r.damped, H), W});
  a.in("velocity of the sponge", &r.sponge_velocity, {when(r.damped, 2)});
}

// Name the arrays of a window: a slot is the first axis of what belongs to one.
template <class Arrays>
void name_window(Arrays& a, Slots& w) {
  Rollout& r = w.r;
  const int64_t H = r.height, W = r.width, N = r.nodes, E = r.edges, J = r.joints, S = w.slots;
  const int64_t R = r.rows, L = r.links, swept = when(!r.matched, S);
  for (int i = 0; i < 9; i++) a.in("a plane", &r.populations[i], {H, W});
  a.in("positions", &r.positions, {S, N, 2}), a.in("angles", &r.angles, {S, E});
  a.in("boxes", &r.boxes, {S, 2}), a.in("ages", &w.age, {S});
  a.in("angles of shapes", &w.shape_angles, {S, SHAPE_COUNT, J});
  a.in("lengths of shapes", &w.shape_lengths, {S, SHAPE_COUNT, E});
  a.in("values of networks", &w.values, {when(r.recurrent, S), R, N});
  a.in("energy", &r.energy, {when(r.energetic, H), W});
  a.in("collected", &r.collected, {when(r.energetic, S), N});
  a.in("food", &r.food, {when(r.fed, H), W}), a.in("accounts", &w.account, {when(r.fed, S)});
  a.in("time", &r.time, {when(r.fed, 1)});
  a.in("filled", &w.filled, {S}), a.in("numbers", &w.number, {S});
  a.in("edges", &r.ends, {S, E, 2}), a.in("joints", &r.pairs, {S, J, 2});
  a.in("piece", &r.piece, {S, N}), a.in("present", &r.present, {S, N});
  a.in("layout angles", &r.layout_angle, {S, E});
  a.in("layout rest angles", &r.layout_rest_angle, {S, J});
  a.in("bends", &r.bends, {S, J});
  a.in("colours of edges", &r.edge_colour, {swept, E});
  a.in("colours of joints", &r.joint_colour, {swept, J});
  a.in("whole turns", &r.whole, {swept, J});
  a.in("stretch", &r.stretch, {S, E}), a.in("shear", &r.shear, {S, E});
  a.in("bend", &r.bend, {S, J}), a.in("actuation", &w.actuation, {S, ACTUATION_COUNT});
  a.in("activations", &r.activation, {S, R}), a.in("biases", &r.bias, {S, R});
  a.in("sources", &r.source, {S, L}), a.in("targets", &r.target, {S, L});
  a.in("weights", &r.weight, {S, L}), a.in("sites", &r.site, {S, r.sites, N});
  a.in("lags", &r.lag, {when(r.waves, S), N});
  a.in("nodes of joints", &r.joint_node, {S, J}), a.in("gains of joints", &r.gain, {S, J});
  a.in("rest lengths of bodies", &r.body_length, {S, E});
  a.in("parameters", &r.parameters, {STEP_LENGTHS + r.iterations});
  a.in("capacity", &r.capacity, {when(r.fed, H), W});
  a.in("rations", &r.rations, {when(r.fed, RATION_COUNT)});
  name_surroundings(a, r);
  for (int i = 0; i < 9; i++) a.out("a plane", &r.end_populations[i], {H, W});
  a.out("positions", &r.end_positions, {S, N, 2}), a.out("angles", &r.end_angles, {S, E});
  a.out("boxes", &r.end_boxes, {S, 2}), a.out("ages", &w.end_age, {S});
  a.out("angles of shapes", &w.end_shape_angles, {S, SHAPE_COUNT, J});
  a.out("lengths of shapes", &w.end_shape_lengths, {S, SHAPE_COUNT, E});
  a.out("values of networks", &w.end_values, {when(r.recurrent, S), R, N});
  a.out("energy", &r.end_energy, {when(r.energetic, H), W});
  a.out("collected", &r.end_collected, {when(r.energetic, S), N});
  a.out("food", &r.end_food, {when(r.fed, H), W});
  a.out("accounts", &w.end_account, {when(r.fed, S)});
  a.out("time", &r.end_time, {when(r.fed, 1)});
  a.out("measures", &w.tally, {S, TALLY_COUNT});
  a.out("grown", &r.grown, {when(r.fed, H), 2}), a.out("lost", &r.lost, {when(r.fed, H), 2});
  a.out("seconds", &r.seconds, {PART_COUNT}), a.out("memory", &r.memory, {1});
  a.end();
}

// Name the arrays of a rollout.
template <class Arrays>
void name_rollout(Arrays& a, Rollout& r) {
  const int64_t H = r.height, W = r.width, N = r.nodes, E = r.edges, J = r.joints;
  const bool closed = r.commands != GIVEN, energetic = r.energetic;
  const int64_t T = when(r.observed, r.steps), given = when(!closed, r.observed ? T : 1);
  const int64_t swept = !r.matched, B = r.bodies;
  for (int i = 0; i < 9; i++) a.in("a plane", &r.populations[i], {H, W});
  name_body(a, r);
  a.in("colours of edges", &r.edge_colour, {swept * E});
  a.in("colours of joints", &r.joint_colour, {swept * J});
  a.in("whole turns", &r.whole, {swept * J});
  a.in("stretch", &r.stretch, {E}), a.in("shear", &r.shear, {E}), a.in("bend", &r.bend, {J});
  a.in("parameters", &r.parameters, {STEP_LENGTHS + r.iterations});
  a.in("boxes", &r.boxes, {B, 2});
  a.in("energy", &r.energy, {when(energetic, H), W});
  a.in("collected", &r.collected, {when(energetic, N)});
  name_surroundings(a, r);
  a.in("rest angles", &r.given_angle, {given, J});
  a.in("rest lengths", &r.given_length, {given, E});
  name_controller(a, r);
  for (int i = 0; i < 9; i++) a.out("a plane", &r.end_populations[i], {H, W});
  a.out("positions", &r.end_positions, {N, 2}), a.out("angles", &r.end_angles, {E});
  a.out("boxes", &r.end_boxes, {B, 2});
  a.out("energy", &r.end_energy, {when(energetic, H), W});
  a.out("collected", &r.end_collected, {when(energetic, N)});
  a.out("rest angles", &r.rest_angle, {when(closed, T), J});
  a.out("rest lengths", &r.rest_length, {when(closed, T), E});
  a.out("centre", &r.centre, {T, 2}), a.out("path", &r.path, {T, N, 2});
  a.out("speed", &r.speed, {T}), a.out("node speed", &r.node_speed, {T});
  a.out("held", &r.held, {T}), a.out("heading", &r.heading, {T});
  a.out("curvature", &r.curvature, {T, J}), a.out("power", &r.power, {T});
  a.out("force", &r.force, {T, B, 2}), a.out("box", &r.box, {T, B, 2});
  a.out("seconds", &r.seconds, {PART_COUNT}), a.out("memory", &r.memory, {1});
  a.end();
}

// Name the arrays of a development.
template <class Arrays>
void name_development(Arrays& a, Rollout& r) {
  name_body(a, r);
  name_controller(a, r);
  a.out("rest angles", &r.rest_angle, {r.steps, r.joints});
  a.out("rest lengths", &r.rest_length, {r.steps, r.edges});
  a.out("clock", &r.clock, {r.steps});
  a.end();
}

// Name the arrays of a summary.
template <class Arrays>
void name_summary(Arrays& a, Observed& o) {
  const int64_t H = o.height, W = o.width, N = o.nodes, E = o.edges, J = o.joints, T = o.steps;
  for (int i = 0; i < 9; i++) a.in("a plane", &o.populations[i], {H, W});
  a.in("uniform force", &o.uniform_force, {when(o.driven, 2)});
  a.in("forces across rows", &o.force_x, {when(o.varied, H), W});
  a.in("forces along rows", &o.force_y, {when(o.varied, H), W});
  a.in("walls", &o.walls, {when(o.walled, H), W});
  a.in("positions", &o.positions, {N, 2}), a.in("angles", &o.angles, {E});
  a.in("edges", &o.ends, {E, 2}), a.in("joints", &o.pairs, {J, 2});
  a.in("member", &o.member, {N}), a.in("present", &o.present, {N});
  a.in("boxes", &o.boxes, {o.bodies, 2});
  a.in("collected", &o.collected, {when(o.energetic, N)});
  a.in("rest angles", &o.rest_angle, {T, J}), a.in("rest lengths", &o.rest_length, {T, E});
  a.in("centre", &o.centre, {T, 2}), a.in("path", &o.path, {T, N, 2});
  a.in("speed", &o.speed, {T}), a.in("node speed", &o.node_speed, {T});
  a.in("held", &o.held, {T}), a.in("heading", &o.heading, {T});
  a.in("curvature", &o.curvature, {T, J}), a.in("power", &o.power, {T});
  a.in("force", &o.force, {T, o.bodies, 2}), a.in("box", &o.box, {T, o.bodies, 2});
  a.in("clock", &o.clock, {T}), a.in("scales", &o.scales, {3});
  a.out("places", &o.places, {PLACES, 2});
  a.out("frames", &o.frames, {FRAMES, N, 2});
  a.out("middles", &o.middles, {FRAMES, 2}), a.out("shown", &o.shown, {SHOWN});
  a.out("measures", &o.measures, {MEASURE_COUNT});
  a.end();
}

inline bool within(const int32_t* values, int64_t count, int32_t least, int64_t limit) {
  for (int64_t i = 0; i < count; i++)
    if (values[i] < least || values[i] >= limit) return false;
  return true;
}

// Return whether all numbers by which graphs refer to items are in range: the kernel indexes by
// them without further checks.
inline bool sound(const Rollout& r) {
  const bool colours = r.matched || (within(r.edge_colour, r.edges, 0, r.edges) &&
                                     within(r.joint_colour, r.joints, 0, r.joints));
  const bool network =
      r.commands != NETWORK ||
      (within(r.activation, r.rows, -1, 9) && within(r.activation, r.inputs, -1, 0) &&
       within(r.source, r.links, -1, r.rows) && within(r.target, r.links, 0, r.rows) &&
       within(r.joint_node, r.joints, 0, r.nodes));
  return colours && network && within(r.ends, 2 * r.edges, 0, r.nodes) &&
         within(r.pairs, 2 * r.joints, 0, r.edges) && within(r.member, r.nodes, 0, r.bodies) &&
         within(r.piece, r.nodes, 0, r.nodes) && within(r.present, r.nodes, 0, 2) &&
         within(r.bends, r.laid_out ? r.joints : 0, 0, 2);
}

inline bool between(float value, float least, float most) {
  return value >= least && value <= most;
}

// Return whether whole numbers stay whole numbers: of what is rounded, and of sums.
inline bool sound_food(const Slots& w) {
  const Rollout& r = w.r;
  if (!r.fed) return true;
  const int64_t cells = int64_t(r.height) * r.width;
  const float *given = r.rations, most = 16777216;
  // What a row of cells gains in a window has to fit into `Rollout::grown`.
  const int64_t times = r.steps / r.food_every + 1;
  if (times * r.width >= int64_t(1) << 19) return false;
  return between(given[BITE], 0, most) && given[BITE] * float(r.nodes) <= 1073741824.0f &&
         between(given[REGROWTH], 0, 1) && between(given[DECAY], 0, 1) &&
         between(given[FOOD_DIFFUSION], 0, 0.25f) && given[UNIT] > 0 && given[FULL] > 0 &&
         within(r.capacity, cells, 0, (1 << 24) + 1) && within(r.food, cells, 0, 1 << 30) &&
         within(w.account, w.slots, 0, int64_t(1) << 31) &&
         within(r.time, 1, 0, INT32_MAX - int64_t(r.steps));
}

// Return whether a creature has a clock that goes, and bounds that are not 0, which is none.
inline bool sound_actuation(const float* given) {
  return given[PERIOD] > 0 && given[PERIOD] < 1e30f && given[RAMP] >= 0 && given[MAX_SPEED] > 0 &&
         given[MAX_BEND] > 0 && between(given[LAG_SHARE], 0, 1);
}

inline bool sound(const Observed& o) {
  return within(o.ends, 2 * o.edges, 0, o.nodes) && within(o.pairs, 2 * o.joints, 0, o.edges) &&
         within(o.member, o.nodes, 0, o.bodies) && within(o.present, o.nodes, 0, 2);
}

// Return why a call cannot be carried out, or "".
template <class Given>
std::string refused(const Given& given) {
  return sound(given) ? "" : LACKS;
}

// Return why slots cannot live, or "".
inline std::string refused(const Slots& w) {
  if (!within(w.filled, w.slots, 0, 2)) return "a slot is filled, 1, or empty, 0";
  if (!within(w.age, w.slots, 0, int64_t(1) << 31)) return "an age is negative";
  if (!sound_food(w)) return "food, an account, a time or a share is out of range";
  std::vector<int32_t> numbers;  // The order of creatures, so no two may be equal.
  for (int s = 0; s < w.slots; s++)
    if (w.filled[s]) numbers.push_back(w.number[s]);
  std::sort(numbers.begin(), numbers.end());
  if (std::adjacent_find(numbers.begin(), numbers.end()) != numbers.end())
    return "two creatures have one number";
  for (int64_t s = 0; s < w.slots; s++) {
    if (!w.filled[s]) continue;
    Rollout r = w.r;
    const int64_t N = r.nodes, E = r.edges, J = r.joints, R = r.rows, L = r.links;
    r.ends += 2 * s * E, r.pairs += 2 * s * J, r.piece += s * N, r.present += s * N;
    r.bends += s * J, r.activation += s * R, r.source += s * L, r.target += s * L;
    r.joint_node += s * J, r.edge_colour += r.matched ? 0 : s * E;
    r.joint_colour += r.matched ? 0 : s * J;
    const std::vector<int32_t> member(N, 0);
    r.member = member.data();
    if (!sound(r)) return LACKS;
    if (!sound_actuation(w.actuation + s * ACTUATION_COUNT))
      return "a clock or a bound is out of range";
    if (!std::count(r.present, r.present + N, 1)) return "nothing of a creature has grown";
    // A joint that has grown turns by the output at a node that has.
    auto grown = [&](int32_t edge) {
      const int32_t one = r.ends[2 * edge], other = r.ends[2 * edge + 1];
      return one != other && r.present[one] && r.present[other];
    };
    for (int64_t j = 0; j < J; j++)
      if (r.bends[j] && grown(r.pairs[2 * j]) && grown(r.pairs[2 * j + 1]) &&
          !r.present[r.joint_node[j]])
        return LACKS;
  }
  return "";
}

}  // namespace microcosmos
