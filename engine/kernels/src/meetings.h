// Where bodies meet: the density of other bodies at each node, and its gradient, node by node, as
// in `fields.contact`.
//
// A pair of nodes acts as on the lattice: each is shared by the four cells around it, and the
// density is smoothed by binomial weights. Pairs farther apart than the weights reach add nothing,
// so that leaving them out changes no bit.
#pragma once
#include "density.h"
#include "nodes.h"

namespace microcosmos::ISA {

class Meetings {
 public:
  Floats others, others_x, others_y;  // Density of other bodies at each slot, and its gradient.
  Floats own_x, own_y;                // The gradient of the body's own density.

  // `alone`: whether bodies feel their own density too.
  Meetings(const Bodies& b, const Rollout& r, bool alone, int members)
      : b_(b), r_(r), alone_(alone) {
    for (Floats* one : {&others, &others_x, &others_y, &own_x, &own_y})
      *one = Floats(b.node_slots + BLOCK);
    for (Floats* one : {&x_, &y_, &wide_, &high_}) *one = Floats(r.bodies + BLOCK);
    starts_.assign(r.bodies + 1, 0), slots_.assign(r.bodies, {});
    for (const Piece& piece : b.pieces)
      for (int node : piece.node_of)
        if (r.present[node]) slots_[r.member[node]].push_back(b.node_slot[node]);
    for (int body = 0; body < r.bodies; body++)
      starts_[body + 1] = starts_[body] + (int(slots_[body].size()) + BLOCK - 1) / BLOCK * BLOCK;
    const size_t room = starts_[r.bodies] + BLOCK;
    cell_x_ = Array<int32_t>(room), cell_y_ = Array<int32_t>(room);
    share_x_ = Floats(room), share_y_ = Floats(room);
    touching.resize(members);
    // Bodies of which nothing has grown, and what fills up the last block, are out of reach.
    for (int body = 0; body < r.bodies + BLOCK; body++) wide_[body] = high_[body] = -1e30f;
  }

  List<List<std::pair<int32_t, int32_t>>> touching;  // Pairs of bodies, of each member.

  void find(const Nodes& n, const Member& me) {
    const Range bodies = me.share.bodies;
    for (int body = bodies.from; body < bodies.to; body++) place(body, n);
    touching[me.number].clear();
    me.wait();  // Bodies of all members are looked at.
    for (int body = bodies.from; body < bodies.to; body++) meet(body, me.number);
  }

 private:
  static constexpr int REACH = 4;  // Cells from a node's to another's, beyond which nothing acts.
  // Weights of a node by cells from its own, from -REACH to REACH + 1.
  struct Table {
    float smooth[2 * REACH + 2], slope[2 * REACH + 2];
  };

  void place(int body, const Nodes& n) {
    float low_x = 0, high_x = 0, low_y = 0, high_y = 0;
    const auto& slots = slots_[body];
    for (size_t k = 0; k < slots.size(); k++) {
      const float x = n.x[slots[k]], y = n.y[slots[k]];
      const int at = starts_[body] + int(k);
      cell_x_[at] = cell(x, r_.height, share_x_[at]), cell_y_[at] = cell(y, r_.width, share_y_[at]);
      low_x = k && low_x < x ? low_x : x, high_x = k && high_x > x ? high_x : x;
      low_y = k && low_y < y ? low_y : y, high_y = k && high_y > y ? high_y : y;
    }
    if (slots.empty()) return;
    x_[body] = 0.5f * (low_x + high_x), wide_[body] = 0.5f * (high_x - low_x);
    y_[body] = 0.5f * (low_y + high_y), high_[body] = 0.5f * (high_y - low_y);
  }

  static Table weights(float share) {
    constexpr float SMOOTH[] = {0,         0,         0, 1 / 16.0f, 4 / 16.0f, 6 / 16.0f,
                                4 / 16.0f, 1 / 16.0f, 0, 0,         0};
    constexpr float SLOPE[] = {0,         0,         -1 / 32.0f, -4 / 32.0f, -5 / 32.0f, 0,
                               5 / 32.0f, 4 / 32.0f, 1 / 32.0f,  0,          0};
    Table w;
    for (int m = 0; m < 2 * REACH + 2; m++) {
      w.smooth[m] = (1 - share) * SMOOTH[m + 1] + share * SMOOTH[m];
      w.slope[m] = (1 - share) * SLOPE[m + 1] + share * SLOPE[m];
    }
    return w;
  }

  // Whole cells from one to another by the shorter way around the box.
  INLINE static Ints way(Ints cells, int size) {
    const int half = size / 2;
    cells = cells - ((cells > half) & size);
    return cells + ((cells < -half) & size);
  }
  static float way(float cells, float size) {
    return cells - size * nearest(all(cells * (1 / size)))[0];
  }

  void meet(int body, int member) {
    const auto& slots = slots_[body];
    for (int32_t slot : slots)
      for (float* one :
           {others + slot, others_x + slot, others_y + slot, own_x + slot, own_y + slot})
        *one = 0;
    if (slots.empty()) return;
    if (alone_) add(body, body, own_x, own_y, nullptr);
    const float H = float(r_.height), W = float(r_.width);
    const float x = x_[body], y = y_[body], wide = wide_[body] + REACH + 2,
                high = high_[body] + REACH + 2;
    for (int first = 0; first < r_.bodies; first += LANES) {
      Vec dx = load(x_ + first) - x, dy = load(y_ + first) - y;
      dx = absolute(dx - H * nearest(dx * (1 / H))), dy = absolute(dy - W * nearest(dy * (1 / W)));
      const Ints near = (dx <= wide + load(wide_ + first)) & (dy <= high + load(high_ + first));
      if (!any(near)) continue;
      for (int l = 0; l < LANES; l++) {
        const int other = first + l;
        if (!near[l] || other == body || other >= r_.bodies) continue;
        if (add(body, other, others_x, others_y, others)) touching[member].push_back({body, other});
      }
    }
  }

  // Add the density of the other body at the nodes of one; return whether there is any.
  bool add(int body, int other, float* to_x, float* to_y, float* density) {
    const int H = r_.height, W = r_.width, count = int(slots_[other].size());
    const int from = starts_[other];
    // Edges of the other body's box, in cells beyond which it acts on no node.
    const float wide = wide_[other] + REACH + 2, high = high_[other] + REACH + 2;
    bool acts = false;
    for (size_t k = 0; k < slots_[body].size(); k++) {
      const int at = starts_[body] + int(k), slot = slots_[body][k];
      const float fx = share_x_[at], fy = share_y_[at];
      if (body != other) {
        const float dx = way(float(cell_x_[at]) + fx - x_[other], float(H));
        const float dy = way(float(cell_y_[at]) + fy - y_[other], float(W));
        if (!(dx <= wide && dx >= -wide && dy <= high && dy >= -high)) continue;
      }
      Table wx, wy;
      bool weighed = false;
      for (int j = 0; j < count; j += LANES) {
        Ints mx, my;
        std::memcpy(&mx, cell_x_ + from + j, sizeof mx);
        std::memcpy(&my, cell_y_ + from + j, sizeof my);
        mx = way(mx - cell_x_[at], H), my = way(my - cell_y_[at], W);
        const Ints near = (mx >= -REACH) & (mx <= REACH) & (my >= -REACH) & (my <= REACH);
        if (!any(near)) continue;
        for (int l = 0; l < LANES && j + l < count; l++) {
          if (!near[l]) continue;
          if (!weighed) wx = weights(fx), wy = weights(fy), weighed = true;
          const int a = mx[l] + REACH, b = my[l] + REACH;
          const float gx = share_x_[from + j + l], gy = share_y_[from + j + l];
          const float smooth_x = (1 - gx) * wx.smooth[a] + gx * wx.smooth[a + 1];
          const float smooth_y = (1 - gy) * wy.smooth[b] + gy * wy.smooth[b + 1];
          const float slope_x = (1 - gx) * wx.slope[a] + gx * wx.slope[a + 1];
          const float slope_y = (1 - gy) * wy.slope[b] + gy * wy.slope[b + 1];
          const float both = smooth_x * smooth_y, ax = slope_x * smooth_y, ay = smooth_x * slope_y;
          to_x[slot] += ax, to_y[slot] += ay;
          if (density) density[slot] += both;
          // The gradient reaches a cell farther than the density.
          acts |= both > 0 || ax != 0 || ay != 0;
        }
      }
    }
    return acts;
  }

  const Bodies& b_;
  const Rollout& r_;
  bool alone_;
  List<int> starts_;           // Of each body in the arrays of nodes below, whole blocks.
  List<List<int32_t>> slots_;  // Of each body's nodes that have grown.
  Array<int32_t> cell_x_, cell_y_;
  Floats share_x_, share_y_;    // Distances of nodes from their cells.
  Floats x_, y_, wide_, high_;  // Middle and half the extent of each body.
};

// The bodies that touch each other, directly or by others, and one factor for all of them.
class Clusters {
 public:
  explicit Clusters(int bodies) : parent_(bodies) {}

  // Lower the factor of each body to the least of its cluster.
  void share(const List<List<std::pair<int32_t, int32_t>>>& touching, float* factor) {
    for (size_t body = 0; body < parent_.size(); body++) parent_[body] = int32_t(body);
    for (const auto& pairs : touching)
      for (const auto& [one, other] : pairs) {
        const int32_t a = root_of(one), b = root_of(other);
        parent_[a < b ? b : a] = a < b ? a : b;
      }
    for (size_t body = 0; body < parent_.size(); body++) {
      const int32_t root = root_of(int32_t(body));
      factor[root] = factor[body] < factor[root] ? factor[body] : factor[root];
    }
    for (size_t body = 0; body < parent_.size(); body++)
      factor[body] = factor[root_of(int32_t(body))];
  }

 private:
  int32_t root_of(int32_t body) {
    while (parent_[body] != body) body = parent_[body] = parent_[parent_[body]];
    return body;
  }

  List<int32_t> parent_;
};

}  // namespace microcosmos::ISA
