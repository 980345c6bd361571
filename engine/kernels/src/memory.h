// Arrays at the boundary of cache lines, filled with zeros.
#pragma once
#include <cstdlib>
#include <cstring>
#include <new>

#include "vectors.h"

namespace microcosmos::ISA {

template <class T>
class Array {
 public:
  Array() = default;
  explicit Array(size_t count) {
    const size_t bytes = (count * sizeof(T) + 127) / 64 * 64;
    data_ = static_cast<T*>(std::aligned_alloc(64, bytes));
    if (!data_) throw std::bad_alloc();
    std::memset(data_, 0, bytes);
  }
  Array(Array&& other) noexcept { std::swap(data_, other.data_); }
  Array& operator=(Array&& other) noexcept {
    std::swap(data_, other.data_);
    return *this;
  }
  ~Array() { std::free(data_); }
  operator T*() const { return data_; }

 private:
  T* data_ = nullptr;
};
using Floats = Array<float>;

}  // namespace microcosmos::ISA
