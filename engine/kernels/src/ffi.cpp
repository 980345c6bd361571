// The rollout as a target of XLA's foreign function interface: one world, or a batch of them in
// turn.
//
// Operands and results have the order of `microcosmos.kernel`. Batch axes come first; an operand
// whose batch axis has length 1 is the same for all worlds.
#include "xla/ffi/api/ffi.h"

#include <string>
#include <vector>

#include "step.h"

namespace ffi = xla::ffi;
using microcosmos::Rollout;

namespace {

enum Operand {
  PLANES = 0,
  POSITIONS = 9,
  ANGLES,
  REST_ANGLE,
  REST_LENGTH,
  PARAMETERS,
  ENDS,
  PAIRS,
  MEMBER,
  PIECE,
  PRESENT,
  LAYOUT_ANGLE,
  LAYOUT_REST_ANGLE,
  TURNED,
  PLACED,
  EDGE_COLOUR,
  JOINT_COLOUR,
  STRETCH,
  SHEAR,
  BEND,
  OPERANDS
};
enum Result {
  END_POSITIONS = 9,
  END_ANGLES,
  CENTRE,
  PATH,
  SPEED,
  NODE_SPEED,
  HELD,
  HEADING,
  CURVATURE,
  POWER,
  FORCE,
  SECONDS,
  RESULTS
};

using Shape = std::vector<int64_t>;

std::string text(const Shape& shape) {
  std::string found = "(";
  for (int64_t one : shape) found += std::to_string(one) + ", ";
  return found + ")";
}

// The array of one operand or result, and its place in each world of the batch.
struct Array {
  void* data;
  Shape dimensions;
  int64_t size = 1;  // Items of one world.

  Array(const ffi::AnyBuffer& buffer)
      : data(buffer.untyped_data()),
        dimensions(buffer.dimensions().begin(), buffer.dimensions().end()) {}

  // The part of one world; all items have four bytes.
  void* at(int64_t world, const Shape& batch) const {
    int64_t index = 0, scale = 1;
    for (size_t axis = batch.size(); axis-- > 0;) {
      const int64_t place = world % batch[axis];
      world /= batch[axis];
      index += dimensions[axis] == 1 ? 0 : place * scale;
      scale *= dimensions[axis];
    }
    return static_cast<char*>(data) + 4 * size * index;
  }
};

// The shapes of a rollout, checked.
class Call {
 public:
  std::string error;
  Shape batch;
  std::vector<Array> operands, results;

  Call(ffi::RemainingArgs args, ffi::RemainingRets rets, Rollout& r) {
    if (args.size() != OPERANDS || rets.size() != RESULTS) {
      error = "a rollout has " + std::to_string(OPERANDS) + " operands and " +
              std::to_string(RESULTS) + " results";
      return;
    }
    for (size_t i = 0; i < args.size(); i++) {
      const auto one = args.get<ffi::AnyBuffer>(i);
      const bool whole = (i >= ENDS && i <= PRESENT) || i == EDGE_COLOUR || i == JOINT_COLOUR;
      check(one->element_type() == (whole ? ffi::DataType::S32 : ffi::DataType::F32), "type", i);
      operands.push_back(Array(*one));
    }
    for (size_t i = 0; i < rets.size(); i++)
      results.push_back(Array(**rets.get<ffi::AnyBuffer>(i)));
    const Shape& planes = results[PLANES].dimensions;
    if (planes.size() < 2) fail("the planes must have two axes");
    if (!error.empty()) return;
    batch = Shape(planes.begin(), planes.end() - 2);
    const int32_t H = r.height = int32_t(planes[batch.size()]),
                  W = r.width = int32_t(planes[batch.size() + 1]);
    const size_t k = batch.size();
    for (size_t i = PLANES; i < OPERANDS; i++)
      if (operands[i].dimensions.size() <= k) fail("too few axes", i);
    if (!error.empty()) return;
    const int32_t N = r.nodes = int32_t(operands[POSITIONS].dimensions[k]);
    const int32_t E = r.edges = int32_t(operands[ANGLES].dimensions[k]);
    const int32_t T = r.steps = int32_t(operands[REST_ANGLE].dimensions[k]);
    const int32_t J = r.joints = int32_t(operands[BEND].dimensions[k]);
    const Shape given[] = {{N, 2}, {E},    {T, J}, {T, E}, {4 + r.iterations},
                           {E, 2}, {J, 2}, {N},    {N},    {N},
                           {E},    {J},    {E, J}, {N, E}, {E},
                           {J},    {E},    {E},    {J}};
    const Shape wanted[] = {{N, 2},
                            {E},
                            {T, 2},
                            {T, N, 2},
                            {T},
                            {T},
                            {T},
                            {T},
                            {T, J},
                            {T},
                            {T, r.bodies, 2},
                            {microcosmos::PART_COUNT}};
    for (int i = 0; i < 9; i++) shaped(operands[i], {H, W}, i), shaped(results[i], {H, W}, i);
    for (int i = POSITIONS; i < OPERANDS; i++) {
      const bool layout = i >= LAYOUT_ANGLE && i <= PLACED,
                 colours = i == EDGE_COLOUR || i == JOINT_COLOUR;
      if ((layout && !r.matched) || (colours && r.matched)) continue;  // Not read.
      shaped(operands[i], given[i - POSITIONS], i);
    }
    for (int i = END_POSITIONS; i < RESULTS; i++) shaped(results[i], wanted[i - END_POSITIONS], i);
    if (H < 4 || W < 4) fail("a world has at least 4 cells along each axis");
    if (r.iterations < 1 || r.layers < 1 || r.layers > 2) fail("iterations or layers");
  }

  // The arrays of one world.
  void point(Rollout& r, int64_t world) const {
    auto in = [&](int i) { return static_cast<const float*>(operands[i].at(world, batch)); };
    auto whole = [&](int i) { return static_cast<const int32_t*>(operands[i].at(world, batch)); };
    auto out = [&](int i) { return static_cast<float*>(results[i].at(world, batch)); };
    for (int i = 0; i < 9; i++) r.populations[i] = in(i), r.end_populations[i] = out(i);
    r.positions = in(POSITIONS), r.angles = in(ANGLES), r.rest_angle = in(REST_ANGLE),
    r.rest_length = in(REST_LENGTH);
    r.parameters = in(PARAMETERS), r.ends = whole(ENDS), r.pairs = whole(PAIRS),
    r.member = whole(MEMBER);
    r.piece = whole(PIECE), r.present = whole(PRESENT), r.layout_angle = in(LAYOUT_ANGLE);
    r.layout_rest_angle = in(LAYOUT_REST_ANGLE), r.turned = in(TURNED), r.placed = in(PLACED);
    r.edge_colour = whole(EDGE_COLOUR), r.joint_colour = whole(JOINT_COLOUR);
    r.stretch = in(STRETCH), r.shear = in(SHEAR), r.bend = in(BEND);
    r.end_positions = out(END_POSITIONS), r.end_angles = out(END_ANGLES), r.centre = out(CENTRE),
    r.path = out(PATH);
    r.speed = out(SPEED), r.node_speed = out(NODE_SPEED), r.held = out(HELD),
    r.heading = out(HEADING);
    r.curvature = out(CURVATURE), r.power = out(POWER), r.force = out(FORCE),
    r.seconds = out(SECONDS);
    std::memset(r.seconds, 0, sizeof(float) * microcosmos::PART_COUNT);
  }

 private:
  void fail(const std::string& reason) {
    if (error.empty()) error = reason;
  }
  void fail(const std::string& reason, size_t operand) {
    fail(reason + " of operand " + std::to_string(operand));
  }
  void check(bool holds, const char* what, size_t operand) {
    if (!holds) fail(std::string("wrong ") + what, operand);
  }
  void shaped(Array& array, const Shape& base, int number) {
    const Shape& found = array.dimensions;
    bool fits = found.size() == batch.size() + base.size();
    for (size_t i = 0; fits && i < batch.size(); i++) fits = found[i] == batch[i] || found[i] == 1;
    for (size_t i = 0; fits && i < base.size(); i++) fits = found[batch.size() + i] == base[i];
    if (!fits)
      fail("array " + std::to_string(number) + " must have the shape " + text(base) + ", got " +
           text(found));
    array.size = 1;
    for (int64_t one : base) array.size *= one;
  }
};

// Whether the graph refers to nothing that is not there.
bool sound(const Rollout& r) {
  auto within = [](const int32_t* values, int64_t count, int32_t limit) {
    for (int64_t i = 0; i < count; i++)
      if (values[i] < 0 || values[i] >= limit) return false;
    return true;
  };
  const bool colours = r.matched || (within(r.edge_colour, r.edges, r.edges) &&
                                     within(r.joint_colour, r.joints, r.joints));
  return colours && within(r.ends, 2 * r.edges, r.nodes) &&
         within(r.pairs, 2 * r.joints, r.edges) && within(r.member, r.nodes, r.bodies) &&
         within(r.piece, r.nodes, r.nodes) && within(r.present, r.nodes, 2);
}

ffi::Error invalid(const std::string& reason) {
  return ffi::Error::InvalidArgument("microcosmos-kernels: " + reason);
}

ffi::Error rollout(ffi::RemainingArgs args, ffi::RemainingRets rets, int32_t iterations,
                   int32_t sweeps, int32_t layers, int32_t projection, int32_t delta,
                   int32_t matched, int32_t timed, int32_t bodies, float force_factor,
                   float theta_feedback) {
  Rollout r = {};
  r.iterations = iterations, r.sweeps = sweeps, r.layers = layers, r.bodies = bodies;
  r.projection = microcosmos::Projection(projection), r.delta = microcosmos::Delta(delta),
  r.matched = matched, r.timed = timed;
  r.force_factor = force_factor, r.theta_feedback = theta_feedback;
  Call call(args, rets, r);
  if (!call.error.empty()) return ffi::Error::InvalidArgument("microcosmos-kernels: " + call.error);
  int64_t worlds = 1;
  for (int64_t one : call.batch) worlds *= one;
  for (int64_t world = 0; world < worlds; world++) {
    call.point(r, world);
    if (!sound(r)) return invalid("the body refers to nodes or edges that it lacks");
    try {
      microcosmos::ISA::World(r).run();
    } catch (const std::bad_alloc&) {
      return ffi::Error(ffi::ErrorCode::kResourceExhausted,
                        "microcosmos-kernels: no memory for a world");
    }
  }
  return ffi::Error::Success();
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XLA_FFI_Error* microcosmos_rollout(
    XLA_FFI_CallFrame*);
XLA_FFI_DEFINE_HANDLER_SYMBOL(microcosmos_rollout, rollout,
                              ffi::Ffi::Bind()
                                  .RemainingArgs()
                                  .RemainingRets()
                                  .Attr<int32_t>("iterations")
                                  .Attr<int32_t>("sweeps")
                                  .Attr<int32_t>("layers")
                                  .Attr<int32_t>("projection")
                                  .Attr<int32_t>("delta")
                                  .Attr<int32_t>("matched")
                                  .Attr<int32_t>("timed")
                                  .Attr<int32_t>("bodies")
                                  .Attr<float>("force_factor")
                                  .Attr<float>("theta_feedback"));

// The best instruction set of this processor: 0 basic, 1 avx2, 2 avx512.
extern "C" __attribute__((visibility("default"))) int microcosmos_instruction_set() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    return 2;
  if (__builtin_cpu_supports("avx2")) return 1;
#endif
  return 0;
}
