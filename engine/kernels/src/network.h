// Networks of NEAT genes, evaluated at many points at once.
#pragma once
#include <algorithm>

#include "functions.h"
#include "memory.h"
#include "rollout.h"

namespace microcosmos::ISA {

// The order is that of `naming.ACTIVATIONS`.
enum Activation { IDENTITY, SIGMOID, TANH, RELU, SINE, COSINE, GAUSSIAN, ABSOLUTE, SQUARE };

INLINE Vec activated(int function, Vec z) {
  switch (function) {
    case SIGMOID:
      return 1.0f / (1.0f + exponential(-z));
    case TANH:
      return hyperbolic_tangent(z);
    case RELU:
      return z < 0.0f ? Vec{} : z;
    case SINE:
    case COSINE: {
      Vec s, c;
      sine_cosine_any(z, s, c);
      return function == SINE ? s : c;
    }
    case GAUSSIAN:
      return exponential(-z * z);
    case ABSOLUTE:
      return absolute(z);
    case SQUARE:
      return z * z;
    default:
      return z;
  }
}

// A network; its rows are inputs, outputs, then hidden nodes.
class Network {
 public:
  explicit Network(const Rollout& r) : rows_(r.rows), recurrent_(r.recurrent) {
    List<List<int>> into(rows_);
    for (int c = 0; c < r.links; c++)
      if (r.source[c] >= 0) into[r.target[c]].push_back(c);
    for (int row : order(r, into)) {
      if (r.activation[row] < 0) continue;  // An input, or no node.
      Unit unit = {row, r.activation[row], r.bias[row], int(source_.size()), 0};
      // By source, not by place in the genome: JAX adds in that order too.
      std::sort(into[row].begin(), into[row].end(), [&](int a, int b) {
        return std::make_pair(r.source[a], a) < std::make_pair(r.source[b], b);
      });
      for (int c : into[row]) source_.push_back(r.source[c]), weight_.push_back(r.weight[c]);
      unit.to = int(source_.size());
      units_.push_back(unit);
    }
  }

  // Room for the values of all rows at so many points, a multiple of BLOCK.
  void place(int points) {
    points_ = points;
    values = Floats(size_t(rows_) * points);
    if (recurrent_) next_ = Floats(size_t(rows_) * points);
  }

  float* row(int number) const { return values + size_t(number) * points_; }

  // Compute all nodes from the inputs, which stand in the first rows: in the order of the
  // connections, or in a recurrent network all from the values before.
  void advance() {
    for (const Unit& unit : units_) {
      float* out = (recurrent_ ? next_ : values) + size_t(unit.row) * points_;
      for (int i = 0; i < points_; i += LANES) {
        Vec z = all(unit.bias);
        for (int c = unit.from; c < unit.to; c++) z = z + weight_[c] * load(row(source_[c]) + i);
        z = activated(unit.activation, z);
        z = z < -BOUND ? all(-BOUND) : z;  // What is no number stays so.
        store(out + i, z > BOUND ? all(BOUND) : z);
      }
    }
    if (!recurrent_) return;
    for (const Unit& unit : units_)
      std::memcpy(row(unit.row), next_ + size_t(unit.row) * points_, 4 * size_t(points_));
  }

  Floats values;  // (row, point)

 private:
  static constexpr float BOUND = 1e6f;  // As in `genomes.cppn`: chains of squares would overflow.
  struct Unit {
    int row, activation;
    float bias;
    int from, to;  // Connections.
  };

  // Return rows by the length of the longest path to them, so that sources come first. A recurrent
  // network computes all rows from the values before: any order will do.
  List<int> order(const Rollout& r, const List<List<int>>& into) const {
    List<int> depth(rows_), sorted(rows_);
    bool changed = !recurrent_;
    for (int n = 0; n < rows_ && changed; n++) {
      changed = false;
      for (int row = 0; row < rows_; row++)
        for (int c : into[row])
          if (depth[row] <= depth[r.source[c]]) depth[row] = depth[r.source[c]] + 1, changed = true;
    }
    for (int row = 0; row < rows_; row++) sorted[row] = row;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](int a, int b) { return depth[a] < depth[b]; });
    return sorted;
  }

  int rows_, points_ = 0;
  bool recurrent_;
  List<Unit> units_;
  List<int> source_;
  List<float> weight_;
  Floats next_;
};

}  // namespace microcosmos::ISA
