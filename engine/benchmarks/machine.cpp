// What a core of this machine can do, for `budget.py`: the bandwidth of its caches and memory, and
// a fluid without bodies.
//
// `lattice` is the usual way to write a fast lattice Boltzmann fluid: two copies of all
// populations, read from the neighbours, collided, and written to the other copy. It has no
// forces.
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace {

constexpr int LANES = 16, PLANES = 9;
typedef float Vec __attribute__((vector_size(4 * LANES)));

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

float* filled(size_t floats, float value) {
  const size_t bytes = (4 * floats + 4095) / 4096 * 4096;
  auto* found = static_cast<float*>(std::aligned_alloc(4096, bytes));
  for (size_t i = 0; i < floats; i++) found[i] = value;
  return found;
}

// Keeps the compiler from removing or merging passes over an array.
inline void used(float* data) { __asm__ volatile("" : : "r"(data) : "memory"); }

struct Rates {
  float even, odd;
};

// Relax a pair of opposite populations that stream along +c and -c.
inline void relax(float there, float back, float weight, float flow, float common, Rates rates,
                  float* to, float* from) {
  const float even = rates.even * (0.5f * (there + back) - weight * (common + 4.5f * flow * flow));
  const float odd = rates.odd * (0.5f * (there - back) - 3 * weight * flow);
  *to = there - even - odd, *from = back - even + odd;
}

// Collide one cell: `read` and `written` have the rows of the nine populations.
inline void collide(const float* const* read, float* const* written, int y, int before, int after,
                    Rates rates) {
  const float rest = read[0][y], east = read[1][before], west = read[2][after];
  const float north = read[3][y], south = read[4][y];
  const float ne = read[5][before], sw = read[6][after], nw = read[7][after], se = read[8][before];
  const float rho = rest + ((east + west) + (north + south)) + ((ne + sw) + (nw + se));
  const float volume = 1 / rho;
  const float u = volume * ((east - west) + ((ne - sw) - (nw - se)));
  const float v = volume * ((north - south) + ((ne - sw) + (nw - se)));
  const float common = 1 - 1.5f * (u * u + v * v);
  written[0][y] = rest - rates.even * (rest - rho * (4.0f / 9) * common);
  const float straight = rho * (1.0f / 9), diagonal = rho * (1.0f / 36);
  relax(east, west, straight, u, common, rates, written[1] + y, written[2] + y);
  relax(north, south, straight, v, common, rates, written[3] + y, written[4] + y);
  relax(ne, sw, diagonal, u + v, common, rates, written[5] + y, written[6] + y);
  relax(nw, se, diagonal, v - u, common, rates, written[7] + y, written[8] + y);
}

void step(const float* from, float* to, int height, int width, Rates rates) {
  constexpr int ROW_BEFORE[PLANES] = {0, 0, 0, 1, -1, 1, -1, 1, -1};
  const size_t plane = size_t(height) * width;
  for (int x = 0; x < height; x++) {
    const float* read[PLANES];
    float* written[PLANES];
    for (int i = 0; i < PLANES; i++) {
      const int source = (x - ROW_BEFORE[i] + height) % height;
      read[i] = from + i * plane + size_t(source) * width;
      written[i] = to + i * plane + size_t(x) * width;
    }
    collide(read, written, 0, width - 1, 1, rates);
#pragma GCC ivdep
    for (int y = 1; y < width - 1; y++) collide(read, written, y, y - 1, y + 1, rates);
    collide(read, written, width - 1, width - 2, 0, rates);
  }
}

}  // namespace

// Seconds of a pass that multiplies all of an array in place. `floats` is a multiple of 64.
extern "C" double in_place(size_t floats, int passes) {
  float* a = filled(floats, 1);
  const double begun = now();
  for (int n = 0; n < passes; n++) {
    for (size_t i = 0; i < floats; i += 4 * LANES)
      for (int k = 0; k < 4; k++) {
        Vec& one = *reinterpret_cast<Vec*>(a + i + k * LANES);
        one = one * 1.0000001f;
      }
    used(a);
  }
  const double seconds = (now() - begun) / passes;
  std::free(a);
  return seconds;
}

// Seconds of a step of the fluid alone, by two copies of its populations.
extern "C" double lattice(int height, int width, int steps) {
  const size_t floats = PLANES * size_t(height) * width;
  float *from = filled(floats, 1.0f / PLANES), *to = filled(floats, 0);
  const double begun = now();
  for (int n = 0; n < steps; n++) {
    step(from, to, height, width, {1.5f, 0.8f});
    std::swap(from, to);
    used(from);
  }
  const double seconds = (now() - begun) / steps;
  std::free(from), std::free(to);
  return seconds;
}
