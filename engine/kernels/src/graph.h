// Values of items from the differences of pairs: directions of edges from the turns of joints, and
// places of nodes from the ways along edges. Where loops and branches contradict themselves, the
// differences are met by least squares.
#pragma once
#include <algorithm>
#include <array>

#include "memory.h"

namespace microcosmos::ISA {

class Graph {
 public:
  Graph() = default;

  // `pairs` are (pair, 2) items. Those of `numbers` count whose items are both among `items`.
  Graph(const int32_t* pairs, const List<int32_t>& numbers, const List<int32_t>& items)
      : items_(items) {
    if (items.empty()) return;
    const auto ends = std::minmax_element(items.begin(), items.end());
    Walk w;
    w.first = *ends.first;
    w.place.assign(size_t(*ends.second - w.first) + 1, ABSENT);
    for (int32_t item : items) w.place[item - w.first] = UNMET;
    for (int32_t n : numbers) {
      const int32_t one = pairs[2 * n], other = pairs[2 * n + 1];
      if (one == other || !w.has(one) || !w.has(other)) continue;
      kept_.push_back({n, one, other});
      w.ways.push_back({one, other, n}), w.ways.push_back({other, one, n});
    }
    std::sort(w.ways.begin(), w.ways.end());
    for (int32_t item : items)
      if (w.of(item) == UNMET) walk(item, pairs, w);
    if (kept_.size() == steps_.size()) return;  // There is no loop.
    for (std::array<int32_t, 3>& one : kept_)
      for (int side : {1, 2}) one[side] = w.of(one[side]);
    factorise();
  }

  // Find the values: those of each part have the mean 0 if there are several.
  void solve(const float* differences, float* values) {
    if (diagonal_.empty()) {
      for (int32_t item : items_) values[item] = 0;
      for (const Step& step : steps_)
        values[step.to] = values[step.from] + step.sign * differences[step.by];
    } else
      meet(differences, values);
    for (const List<int32_t>& part : parts_) {
      float sum = 0;
      for (int32_t item : part) sum = sum + values[item];
      const float mean = sum / float(part.size());
      for (int32_t item : part) values[item] = values[item] - mean;
    }
  }

 private:
  // The value of an item is that of another plus or minus the difference of a pair.
  struct Step {
    int32_t to, from, by;
    float sign;
  };
  static constexpr int32_t ROOT = -1, UNMET = -2, ABSENT = -3;

  struct Walk {
    int32_t first;
    List<int32_t> place;                // Of each item: its step, or one of the above.
    List<std::array<int32_t, 3>> ways;  // From an item to another, by a pair.

    int32_t& of(int32_t item) { return place[item - first]; }
    bool has(int32_t item) const {
      return item >= first && size_t(item - first) < place.size() && place[item - first] != ABSENT;
    }
  };

  // Walk over all items that pairs connect with the first, breadth first.
  void walk(int32_t first, const int32_t* pairs, Walk& w) {
    List<int32_t> open = {first};
    w.of(first) = ROOT;
    for (size_t k = 0; k < open.size(); k++) {
      auto way = std::lower_bound(w.ways.begin(), w.ways.end(),
                                  std::array<int32_t, 3>{open[k], INT32_MIN, INT32_MIN});
      for (; way != w.ways.end() && (*way)[0] == open[k]; ++way) {
        const int32_t other = (*way)[1], n = (*way)[2];
        if (w.of(other) != UNMET) continue;
        w.of(other) = int32_t(steps_.size()), open.push_back(other);
        steps_.push_back({other, open[k], n, pairs[2 * n] == open[k] ? 1.0f : -1.0f});
      }
    }
    // An item alone has the value 0 anyway.
    if (open.size() < items_.size() && open.size() > 1) parts_.push_back(std::move(open));
  }

  // Find L and D of the normal matrix, which is L D L'. Its rows and columns are the items but the
  // first of each part, in the order of the walk; of L only what stands from the first number of
  // each row on is kept, since all before that is 0.
  void factorise() {
    const int count = int(steps_.size());
    from_.resize(count), diagonal_.assign(count, 0), right_.assign(count, 0);
    for (int k = 0; k < count; k++) from_[k] = k;
    for (const auto& [n, one, other] : kept_) {
      const int32_t low = std::min(one, other), high = std::max(one, other);
      if (low >= 0) from_[high] = std::min(from_[high], low);
      for (int32_t each : {low, high})
        if (each >= 0) diagonal_[each]++;
    }
    rows_.resize(count);
    size_t room = 0;
    for (int k = 0; k < count; k++) rows_[k] = room, room += size_t(k - from_[k]);
    lower_.assign(room + 1, 0);
    for (const auto& [n, one, other] : kept_)
      if (one >= 0 && other >= 0) row(std::max(one, other))[std::min(one, other)]--;
    for (int k = 0; k < count; k++) {
      double* mine = row(k);
      for (int i = from_[k]; i < k; i++) {
        const double* its = row(i);
        double sum = mine[i];
        for (int m = std::max(from_[k], from_[i]); m < i; m++) sum -= mine[m] * its[m];
        mine[i] = sum;  // Times D until the row is finished.
      }
      for (int i = from_[k]; i < k; i++) {
        const double product = mine[i];
        mine[i] = product / diagonal_[i];
        diagonal_[k] -= product * mine[i];
      }
    }
  }

  // The place of column 0 of a row of L; only columns from `from_` on exist.
  double* row(int k) { return lower_.data() + (ptrdiff_t(rows_[k]) - from_[k]); }

  // Meet the differences by least squares.
  void meet(const float* differences, float* values) {
    const int count = int(steps_.size());
    std::fill(right_.begin(), right_.end(), 0.0);
    for (const auto& [n, one, other] : kept_) {
      if (one >= 0) right_[one] -= differences[n];
      if (other >= 0) right_[other] += differences[n];
    }
    for (int k = 0; k < count; k++) {
      const double* mine = row(k);
      double sum = right_[k];
      for (int i = from_[k]; i < k; i++) sum -= mine[i] * right_[i];
      right_[k] = sum;
    }
    for (int k = 0; k < count; k++) right_[k] /= diagonal_[k];
    for (int k = count; k-- > 0;) {
      const double* mine = row(k);
      for (int i = from_[k]; i < k; i++) right_[i] -= mine[i] * right_[k];
    }
    for (int32_t item : items_) values[item] = 0;
    for (int k = 0; k < count; k++) values[steps_[k].to] = float(right_[k]);
  }

  List<int32_t> items_;
  List<List<int32_t>> parts_;  // Several items that pairs connect, if they do not connect all.
  List<Step> steps_;
  List<std::array<int32_t, 3>> kept_;  // Pairs, each with its two items.
  List<int> from_;
  List<size_t> rows_;
  List<double> diagonal_, lower_, right_;
};

}  // namespace microcosmos::ISA
