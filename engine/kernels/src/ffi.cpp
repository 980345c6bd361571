// Targets of XLA's foreign function interface: one world, or a batch of them in turn.
#include "arrays.h"
#include "calls.h"
#include "processor.h"
#include "step.h"

namespace ffi = xla::ffi;
using microcosmos::Arrays;
using microcosmos::Observed;
using microcosmos::Rollout;
using microcosmos::Slots;

namespace {

// The numbers of a call, by name; an error if one is missing.
class Numbers {
 public:
  std::string error;

  explicit Numbers(const ffi::Dictionary& given) : given_(given) {}

  int32_t operator()(const char* name) {
    const auto number = given_.get<int32_t>(name);
    if (number.has_value()) return *number;
    error = std::string("there is no number ") + name;
    return 0;
  }

 private:
  const ffi::Dictionary& given_;
};

ffi::Error invalid(const std::string& reason) {
  return ffi::Error::InvalidArgument("microcosmos-kernels: " + reason);
}

// Do the work for each world of a batch in turn.
template <class Given, class Work>
ffi::Error each_world(Arrays& arrays, const Given& given, Work work) {
  if (!arrays.error.empty()) return invalid(arrays.error);
  for (int64_t world = 0; world < arrays.worlds(); world++) {
    arrays.point(world);
    // References may differ between the worlds of a batch, so each world is checked.
    const std::string wrong = refused(given);
    if (!wrong.empty()) return invalid(wrong);
    try {
      work();
    } catch (const std::bad_alloc&) {
      return ffi::Error(ffi::ErrorCode::kResourceExhausted,
                        "microcosmos-kernels: no memory for a world");
    }
  }
  return ffi::Error::Success();
}

ffi::Error rollout(ffi::RemainingArgs args, ffi::RemainingRets rets, ffi::Dictionary numbers) {
  Rollout r = {};
  const std::string wrong = read_rollout(r, Numbers(numbers));
  if (!wrong.empty()) return invalid(wrong);
  Arrays arrays(args, rets);
  if (arrays.begin()) name_rollout(arrays, r);
  return each_world(arrays, r, [&] {
    std::fill(r.seconds, r.seconds + microcosmos::PART_COUNT, 0.0f), *r.memory = 0;
    microcosmos::ISA::World(r).run();
  });
}

ffi::Error live(ffi::RemainingArgs args, ffi::RemainingRets rets, ffi::Dictionary numbers) {
  Slots w = {};
  const std::string wrong = read_window(w, Numbers(numbers));
  if (!wrong.empty()) return invalid(wrong);
  Arrays arrays(args, rets);
  if (arrays.begin()) name_window(arrays, w);
  return each_world(arrays, w, [&] { microcosmos::ISA::live(w); });
}

ffi::Error develop(ffi::RemainingArgs args, ffi::RemainingRets rets, ffi::Dictionary numbers) {
  Rollout r = {};
  const std::string wrong = read_development(r, Numbers(numbers));
  if (!wrong.empty()) return invalid(wrong);
  Arrays arrays(args, rets);
  if (arrays.begin()) name_development(arrays, r);
  return each_world(arrays, r, [&] { microcosmos::ISA::develop(r); });
}

ffi::Error summarise(ffi::RemainingArgs args, ffi::RemainingRets rets, ffi::Dictionary numbers) {
  Observed o = {};
  const std::string wrong = read_summary(o, Numbers(numbers));
  if (!wrong.empty()) return invalid(wrong);
  Arrays arrays(args, rets);
  if (arrays.begin()) name_summary(arrays, o);
  return each_world(arrays, o, [&] { microcosmos::ISA::Summary(o).write(); });
}

}  // namespace

#define MICROCOSMOS_TARGET(function)                                                       \
  extern "C" __attribute__((visibility("default"))) XLA_FFI_Error* microcosmos_##function( \
      XLA_FFI_CallFrame*);                                                                 \
  XLA_FFI_DEFINE_HANDLER_SYMBOL(microcosmos_##function, function,                          \
                                ffi::Ffi::Bind().RemainingArgs().RemainingRets().Attrs())

MICROCOSMOS_TARGET(rollout);
MICROCOSMOS_TARGET(live);
MICROCOSMOS_TARGET(develop);
MICROCOSMOS_TARGET(summarise);

extern "C" __attribute__((visibility("default"))) int microcosmos_instruction_set() {
  return microcosmos::instruction_set();
}
