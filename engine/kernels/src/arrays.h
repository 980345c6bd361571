// The arrays of a call of XLA's foreign function interface: shapes checked, batches taken apart.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "xla/ffi/api/ffi.h"

namespace microcosmos {

namespace ffi = xla::ffi;
using Shape = std::vector<int64_t>;

inline std::string text(const Shape& shape) {
  std::string listed = "(";
  for (int64_t one : shape) listed += std::to_string(one) + ", ";
  return listed + ")";
}

// Operands and results in the order in which they are named. Batch axes come first; an operand
// whose batch axis has length 1 is the same for all worlds.
class Arrays {
 public:
  std::string error;
  Shape batch;

  Arrays(ffi::RemainingArgs args, ffi::RemainingRets rets) : args_(args), rets_(rets) {}

  // Take the batch axes from the first result, all but its last two.
  bool begin() {
    auto first = rets_.get<ffi::AnyBuffer>(0);
    if (first.has_error() || (**first).dimensions().size() < 2) {
      error = "the planes must have two axes";
      return false;
    }
    const auto dimensions = (**first).dimensions();
    batch = Shape(dimensions.begin(), dimensions.end() - 2);
    return true;
  }

  void in(const char* name, const float** to, const Shape& base) {
    operand(name, (void**)to, base, ffi::DataType::F32);
  }
  void in(const char* name, const int32_t** to, const Shape& base) {
    operand(name, (void**)to, base, ffi::DataType::S32);
  }
  void out(const char* name, float** to, const Shape& base) {
    auto buffer = rets_.get<ffi::AnyBuffer>(results_++);
    if (buffer.has_error()) return fail(std::string("there is no result ") + name);
    bind(name, (void**)to, base, ffi::DataType::F32, **buffer);
  }

  void out(const char* name, int32_t** to, const Shape& base) {
    auto buffer = rets_.get<ffi::AnyBuffer>(results_++);
    if (buffer.has_error()) return fail(std::string("there is no result ") + name);
    bind(name, (void**)to, base, ffi::DataType::S32, **buffer);
  }

  void end() {
    if (operands_ != args_.size() || results_ != rets_.size())
      fail("there are " + std::to_string(operands_) + " operands and " + std::to_string(results_) +
           " results");
  }

  int64_t worlds() const {
    int64_t count = 1;
    for (int64_t one : batch) count *= one;
    return count;
  }

  // Point at the arrays of one world.
  void point(int64_t world) const {
    for (const Bound& one : bound_) {
      int64_t index = 0, scale = 1, rest = world;
      for (size_t axis = batch.size(); axis-- > 0;) {
        const int64_t place = rest % batch[axis];
        rest /= batch[axis];
        // JAX gives an operand that all worlds share an axis of length 1 ("expand_dims").
        index += one.dimensions[axis] == 1 ? 0 : place * scale;
        scale *= one.dimensions[axis];
      }
      *one.to = static_cast<char*>(one.data) + 4 * one.size * index;
    }
  }

 private:
  struct Bound {
    void** to;
    void* data;
    Shape dimensions;
    int64_t size;  // Items of one world, of four bytes each.
  };

  void operand(const char* name, void** to, const Shape& base, ffi::DataType type) {
    const auto buffer = args_.get<ffi::AnyBuffer>(operands_++);
    if (buffer.has_error()) return fail(std::string("there is no operand ") + name);
    bind(name, to, base, type, *buffer);
  }

  void bind(const char* name, void** to, const Shape& base, ffi::DataType type,
            const ffi::AnyBuffer& buffer) {
    const Shape shape(buffer.dimensions().begin(), buffer.dimensions().end());
    bool fits = shape.size() == batch.size() + base.size() && buffer.element_type() == type;
    for (size_t i = 0; fits && i < batch.size(); i++) fits = shape[i] == batch[i] || shape[i] == 1;
    for (size_t i = 0; fits && i < base.size(); i++) fits = shape[batch.size() + i] == base[i];
    if (!fits)
      return fail(std::string(name) + " must have the shape " + text(base) + " and four bytes an " +
                  "item, got " + text(shape));
    int64_t size = 1;
    for (int64_t one : base) size *= one;
    bound_.push_back({to, buffer.untyped_data(), shape, size});
  }

  void fail(const std::string& reason) {
    if (error.empty()) error = reason;
  }

  ffi::RemainingArgs args_;
  ffi::RemainingRets rets_;
  size_t operands_ = 0, results_ = 0;
  std::vector<Bound> bound_;
};

}  // namespace microcosmos
