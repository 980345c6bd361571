// Arrays at the boundary of cache lines, filled with zeros; lists; and how much memory they take.
#pragma once
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "vectors.h"

namespace microcosmos::ISA {

// Bytes of all arrays and lists of the process.
inline std::atomic<int64_t> held{0};

[[noreturn]] inline void no_memory() {
#if defined(__cpp_exceptions)
  throw std::bad_alloc();
#else
  __builtin_trap();
#endif
}

template <class T>
class Array {
 public:
  Array() = default;
  explicit Array(size_t count) {
    // At least a line of a cache more than asked for: an empty array has memory too.
    const size_t bytes = (count * sizeof(T) + 127) / 64 * 64;
    data_ = static_cast<T*>(std::aligned_alloc(64, bytes));
    if (!data_) no_memory();
    std::memset(data_, 0, bytes);
    bytes_ = bytes, held += int64_t(bytes);
  }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Array() { std::free(data_), held -= int64_t(bytes_); }
  operator T*() const { return data_; }

 private:
  void swap(Array& other) { std::swap(data_, other.data_), std::swap(bytes_, other.bytes_); }

  T* data_ = nullptr;
  size_t bytes_ = 0;
};
using Floats = Array<float>;

// The allocator of lists, which counts their bytes.
template <class T>
struct Counted {
  using value_type = T;
  Counted() = default;
  template <class U>
  Counted(const Counted<U>&) {}
  T* allocate(size_t count) {
    T* data = std::allocator<T>().allocate(count);
    held += int64_t(count * sizeof(T));
    return data;
  }
  void deallocate(T* data, size_t count) {
    std::allocator<T>().deallocate(data, count);
    held -= int64_t(count * sizeof(T));
  }
  bool operator==(const Counted&) const { return true; }
  bool operator!=(const Counted&) const { return false; }
};
template <class T>
using List = std::vector<T, Counted<T>>;

}  // namespace microcosmos::ISA
