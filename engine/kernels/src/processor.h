// The instruction set of the processor.
#pragma once

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace microcosmos {

// The best instruction set of this processor: 0 basic, 1 avx2, 2 avx512. Compilers have a function
// for this, __builtin_cpu_supports, but with Zig it says no to everything.
inline int instruction_set() {
#if defined(__x86_64__)
  unsigned a, b, c, d, saved, high;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return 0;
  // The vector registers that the operating system saves.
  asm("xgetbv" : "=a"(saved), "=d"(high) : "c"(0));
  constexpr unsigned middle = 0x06, wide = 0xe6;
  if ((saved & middle) != middle || !__get_cpuid_count(7, 0, &a, &b, &c, &d)) return 0;
  constexpr unsigned avx512 = bit_AVX512F | bit_AVX512VL | bit_AVX512DQ | bit_AVX512BW;
  if ((saved & wide) == wide && (b & avx512) == avx512) return 2;
  if (b & bit_AVX2) return 1;
#endif
  return 0;
}

}  // namespace microcosmos
