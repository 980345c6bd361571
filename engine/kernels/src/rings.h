// Joints in rings: around a branch of d edges stand d joints, whose angles have one sum.
#pragma once
#include "bodies.h"

namespace microcosmos::ISA {

// A joint, and 1 or -1: the way in which it is passed on the way around its ring.
struct Passed {
  int32_t joint;
  float sign;
};
using Ring = List<Passed>;

// Return the first node that both edges of a joint have; -1 without one.
inline int shared_node(const Rollout& r, int joint) {
  int found = -1;
  for (int one : {0, 1})
    for (int other : {0, 1}) {
      const int node = r.ends[2 * r.pairs[2 * joint] + one];
      if (node == r.ends[2 * r.pairs[2 * joint + 1] + other] && (found < 0 || node < found))
        found = node;
    }
  return found;
}

// Return joints of one node in the order of their ring; none if it does not close.
inline Ring around(const Rollout& r, const List<int32_t>& met) {
  if (met.size() < 3) return {};
  Ring ring = {{met[0], 1}};
  const int first = r.pairs[2 * met[0]];
  int edge = r.pairs[2 * met[0] + 1];
  List<uint8_t> used(met.size());
  used[0] = 1;
  while (edge != first) {
    int next = -1, several = 0;
    for (size_t k = 0; k < met.size(); k++) {
      const int32_t* pair = r.pairs + 2 * met[k];
      if (used[k] || (pair[0] != edge && pair[1] != edge)) continue;
      next = int(k), several++;
    }
    if (several != 1) return {};
    const int32_t* pair = r.pairs + 2 * met[next];
    ring.push_back({met[next], pair[0] == edge ? 1.0f : -1.0f});
    used[next] = 1, edge = pair[0] == edge ? pair[1] : pair[0];
  }
  return ring.size() == met.size() ? ring : Ring{};
}

// Return the rings among joints, as `bodies.rings`, in the order of their nodes.
inline List<Ring> rings_of(const Rollout& r, const List<int32_t>& joints) {
  List<std::pair<int32_t, int32_t>> order;  // Node, joint.
  for (int32_t j : joints) order.push_back({shared_node(r, j), j});
  std::sort(order.begin(), order.end());
  List<Ring> found;
  for (size_t k = 0; k < order.size();) {
    const int32_t node = order[k].first;
    List<int32_t> met;
    for (; k < order.size() && order[k].first == node; k++) met.push_back(order[k].second);
    Ring ring = node < 0 ? Ring{} : around(r, met);
    if (ring.size() >= 3) found.push_back(std::move(ring));
  }
  return found;
}

// The misfit of each ring is shared by its joints, as in `filaments.closed`.
class Rings {
 public:
  Rings(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    if (r.matched) return;
    of_.resize(b.pieces.size());
    for (size_t p = 0; p < b.pieces.size(); p++)
      for (Ring& ring : rings_of(r, b.pieces[p].joint_of)) {
        // A joint without stiffness takes up any misfit.
        const auto stiff = [&](const Passed& one) { return r.bend[one.joint] > 0; };
        if (!std::all_of(ring.begin(), ring.end(), stiff)) continue;
        of_[p].push_back(std::move(ring));
        any_ = true;
      }
    if (any_) closed_.resize(r.joints);
  }

  // Return the rest angles with the misfits shared: of the joints of these pieces.
  const float* closed(const float* rest_angle, Range pieces) {
    if (!any_) return rest_angle;
    for (int p = pieces.from; p < pieces.to; p++) {
      for (int j : b_.pieces[p].joint_of) closed_[j] = rest_angle[j];
      for (const Ring& ring : of_[p]) {
        float sum = 0;
        for (const Passed& one : ring) sum = sum + one.sign * rest_angle[one.joint];
        const float share = (sum - r_.whole[ring[0].joint]) / float(ring.size());
        for (const Passed& one : ring)
          closed_[one.joint] = rest_angle[one.joint] - one.sign * share;
      }
    }
    return closed_.data();
  }

 private:
  const Bodies& b_;
  const Rollout& r_;
  bool any_ = false;
  List<List<Ring>> of_;  // Of each piece.
  List<float> closed_;
};

}  // namespace microcosmos::ISA
