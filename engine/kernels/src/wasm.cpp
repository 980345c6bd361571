// The kernel's calls for WebAssembly. The page provides numbers by their names, and operands and
// results by their places; its functions throw where it lacks one.
#include <cstdlib>
#include <initializer_list>

#include "calls.h"
#include "crossing.h"
#include "step.h"

#define PAGE(name) __attribute__((import_module("page"), import_name(#name)))
#define EXPORT(name) extern "C" __attribute__((export_name(#name)))

extern "C" {
PAGE(number) int32_t page_number(const char* name);
// Arrays of `items` of four bytes each, in this memory.
PAGE(operand) void* page_operand(int32_t place, const char* name, int32_t items);
PAGE(result) void* page_result(int32_t place, const char* name, int32_t items);
PAGE(refuse) void page_refuse(const char* reason);
}

namespace {

using namespace microcosmos;

struct Numbers {
  std::string error;  // The page throws before there is one.
  int32_t operator()(const char* name) { return page_number(name); }
};

// Operands and results in the order in which they are named.
class Arrays {
 public:
  using Shape = std::initializer_list<int64_t>;

  void in(const char* name, const float** to, Shape shape) { operand(name, (void**)to, shape); }
  void in(const char* name, const int32_t** to, Shape shape) { operand(name, (void**)to, shape); }
  void out(const char* name, int32_t** to, Shape shape) { out(name, (float**)to, shape); }
  void out(const char* name, float** to, Shape shape) {
    *to = static_cast<float*>(page_result(results_++, name, items(shape)));
  }
  void end() {}

 private:
  static int32_t items(Shape shape) {
    int64_t count = 1;
    for (int64_t one : shape) count *= one;
    if (count < 0 || count > INT32_MAX / 4) page_refuse("an array does not fit into the memory");
    return int32_t(count);
  }

  void operand(const char* name, void** to, Shape shape) {
    *to = page_operand(operands_++, name, items(shape));
  }

  int32_t operands_ = 0, results_ = 0;
};

// Refuse numbers or references that are wrong.
void require(const std::string& wrong) {
  if (!wrong.empty()) page_refuse(wrong.c_str());
}
template <class Given>
void require_sound(const Given& given) {
  require(refused(given));
}

}  // namespace

EXPORT(allocate) void* allocate(int32_t bytes) { return std::calloc(size_t(bytes) + 1, 1); }

EXPORT(develop) void call_develop() {
  Rollout r = {};
  Arrays arrays;
  require(read_development(r, Numbers()));
  name_development(arrays, r);
  require_sound(r);
  ISA::develop(r);
}

EXPORT(rollout) void call_rollout() {
  Rollout r = {};
  Arrays arrays;
  require(read_rollout(r, Numbers()));
  name_rollout(arrays, r);
  require_sound(r);
  ISA::World(r).run();
}

EXPORT(live) void call_live() {
  Slots w = {};
  Arrays arrays;
  require(read_window(w, Numbers()));
  name_window(arrays, w);
  require_sound(w);
  ISA::live(w);
}

EXPORT(summarise) void call_summarise() {
  Observed o = {};
  Arrays arrays;
  require(read_summary(o, Numbers()));
  name_summary(arrays, o);
  require_sound(o);
  ISA::Summary(o).write();
}

EXPORT(cross) void call_cross() {
  Crossing c = {};
  Arrays arrays;
  require(read_crossing(c, Numbers()));
  name_crossing(arrays, c);
  require_sound(c);
  write(c);
}
