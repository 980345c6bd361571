// Coloured Gauss-Seidel sweeps of soft bodies: Mueller et al., J. Vis. Commun. Image R. 18, 109
// (2007); Umetani, Schmidt and Stam, SCA 2014.
#pragma once
#include "nodes.h"

namespace microcosmos::ISA {

class Sweeps {
 public:
  Sweeps(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    for (Floats* one : {&rest_angle_, &rest_length_, &bend_, &stretch_, &shear_})
      *one = Floats(b.edge_slots + BLOCK);
    // Each partner corrects half of an error. In a viscous fluid actuators may be weaker.
    const float strength = 0.5f / (1 + r.parameters[VISCOSITY] / r.parameters[NU_C]);
    for (int p : b.filaments) {
      const Piece& piece = b.pieces[p];
      place(piece.joint_of, piece, r.bend, strength, bend_);
      place(piece.edge_of, piece, r.stretch, 0.5f, stretch_);
      place(piece.edge_of, piece, r.shear, 1, shear_);
    }
    for (const auto& tile : b.tiles) {
      size_t room = 0;
      for (const auto& colours : {&tile.edge_colours, &tile.joint_colours})
        for (const Pairs& pairs : *colours) room += 3 * pairs.places();
      values_.push_back(Floats(room));
      float* at = values_.back();
      for (const Pairs& pairs : tile.joint_colours) {
        fill(pairs, r.bend, strength, at + pairs.places());
        at += 2 * pairs.places();
      }
      for (const Pairs& pairs : tile.edge_colours) {
        fill(pairs, r.stretch, 0.5f, at + pairs.places());
        fill(pairs, r.shear, 1, at + 2 * pairs.places());
        at += 3 * pairs.places();
      }
    }
  }

  // Sweep bending, then stretching and shearing, `sweeps` times.
  void apply(Nodes& n, const float* rest_angle, const float* rest_length, const Share& share) {
    for (int f = share.filaments.from; f < share.filaments.to; f++) {
      const Piece& piece = b_.pieces[b_.filaments[f]];
      place(piece.joint_of, piece, rest_angle, 1, rest_angle_);
      place(piece.edge_of, piece, rest_length, 1, rest_length_);
      switch ((piece.nodes.to - piece.nodes.from) / (2 * BLOCK)) {
        case 1:
          filament<1 * PARTS>(piece, n);
          break;
        case 2:
          filament<2 * PARTS>(piece, n);
          break;
        case 3:
          filament<3 * PARTS>(piece, n);
          break;
        default:
          filament<4 * PARTS>(piece, n);
      }
    }
    for (int t = share.tiles.from; t < share.tiles.to; t++) {
      const Bodies::Tile& tile = b_.tiles[t];
      float* at = values_[t];
      for (const Pairs& pairs : tile.joint_colours) {
        fill(pairs, rest_angle, 1, at);
        at += 2 * pairs.places();
      }
      for (const Pairs& pairs : tile.edge_colours) {
        fill(pairs, rest_length, 1, at);
        at += 3 * pairs.places();
      }
      for (int sweep = 0; sweep < r_.sweeps; sweep++) {
        at = values_[t];
        for (const Pairs& pairs : tile.joint_colours) {
          bend(pairs, at, n);
          at += 2 * pairs.places();
        }
        for (const Pairs& pairs : tile.edge_colours) {
          stretch(pairs, at, n);
          at += 3 * pairs.places();
        }
      }
    }
  }

 private:
  // Store values of a filament's joints or edges by slots; a joint has the slot of its first edge.
  void place(const List<int32_t>& items, const Piece& piece, const float* values, float factor,
             float* out) {
    for (size_t k = 0; k < items.size(); k++)
      out[b_.edge_slot[piece.edge_of[k]]] = factor * values[items[k]];
  }

  // Carry out all sweeps of one filament in registers: N vectors each of even and of odd nodes and
  // edges. Even constraints join the lanes of both, odd ones an odd lane and the next even one.
  template <int N>
  __attribute__((noinline)) void filament(const Piece& piece, Nodes& n) {
    const int even = piece.nodes.from, odd = even + N * LANES;
    const int even_edge = piece.edges.from, odd_edge = (even_edge + piece.edges.to) / 2;
    const int edges = odd_edge - even_edge;  // Slots of one half; nodes may have one block more.
    Vec xe[N], ye[N], xo[N], yo[N], te[N], to[N], dx[N], dy[N];
    for (int i = 0; i < N; i++) {
      const int at = i * LANES;
      xe[i] = load(n.new_x + even + at), ye[i] = load(n.new_y + even + at);
      xo[i] = load(n.new_x + odd + at), yo[i] = load(n.new_y + odd + at);
      te[i] = at < edges ? load(n.angle + even_edge + at) : Vec{};
      to[i] = at < edges ? load(n.angle + odd_edge + at) : Vec{};
    }
    // The neighbours at the next place, and at the one before.
    auto next = [](const Vec* a, int i) __attribute__((always_inline)) {
      return right(a[i], a[i + 1 < N ? i + 1 : i]);
    };
    auto before = [](const Vec* a, int i)
                      __attribute__((always_inline)) { return left(i ? a[i - 1] : Vec{}, a[i]); };
    for (int sweep = 0; sweep < r_.sweeps; sweep++) {
      for (int i = 0; i < N && i * LANES < edges; i++) {
        const int at = even_edge + i * LANES;
        const Vec t = load(bend_ + at) * wrapped((to[i] - te[i]) - load(rest_angle_ + at));
        te[i] = te[i] + t, to[i] = to[i] - t;
      }
      // An odd joint joins an odd edge and the next even one, whose turn is thus one lane later.
      for (int i = 0; i < N; i++) dx[i] = Vec{};
      for (int i = 0; i < N && i * LANES < edges; i++) {
        const int at = odd_edge + i * LANES;
        dx[i] = load(bend_ + at) * wrapped((next(te, i) - to[i]) - load(rest_angle_ + at));
        to[i] = to[i] + dx[i];
      }
      for (int i = 0; i < N; i++) te[i] = te[i] - before(dx, i);
      for (int i = 0; i < N && i * LANES < edges; i++) {
        Vec x, y;
        pull(xo[i] - xe[i], yo[i] - ye[i], te[i], even_edge + i * LANES, x, y);
        xe[i] = xe[i] + x, ye[i] = ye[i] + y, xo[i] = xo[i] - x, yo[i] = yo[i] - y;
      }
      for (int i = 0; i < N; i++) dx[i] = dy[i] = Vec{};
      for (int i = 0; i < N && i * LANES < edges; i++) {
        pull(next(xe, i) - xo[i], next(ye, i) - yo[i], to[i], odd_edge + i * LANES, dx[i], dy[i]);
        xo[i] = xo[i] + dx[i], yo[i] = yo[i] + dy[i];
      }
      for (int i = 0; i < N; i++) xe[i] = xe[i] - before(dx, i), ye[i] = ye[i] - before(dy, i);
    }
    for (int i = 0; i < N; i++) {
      const int at = i * LANES;
      store(n.new_x + even + at, xe[i]), store(n.new_y + even + at, ye[i]);
      store(n.new_x + odd + at, xo[i]), store(n.new_y + odd + at, yo[i]);
      if (at < edges) store(n.angle + even_edge + at, te[i]), store(n.angle + odd_edge + at, to[i]);
    }
  }

  // Return the first end's displacement: along the tangent to the rest length, and by shear towards
  // the director.
  INLINE void pull(Vec vx, Vec vy, Vec angle, int slot, Vec& dx, Vec& dy) {
    correct(vx, vy, angle, load(rest_length_ + slot), load(stretch_ + slot), load(shear_ + slot),
            dx, dy);
  }
  INLINE static void correct(Vec vx, Vec vy, Vec angle, Vec length, Vec share, Vec shear, Vec& dx,
                             Vec& dy) {
    Vec s, c;
    sine_cosine(angle, s, c);
    const Vec ratio = length / root(vx * vx + vy * vy + 1e-12f);
    const Vec ax = vx - vx * ratio, ay = vy - vy * ratio;
    const Vec gx = vx - c * length, gy = vy - s * length;
    dx = share * (ax + shear * (gx - ax)), dy = share * (ay + shear * (gy - ay));
  }

  void fill(const Pairs& pairs, const float* values, float factor, float* out) {
    for (int i = 0; i < pairs.places(); i++)
      if (pairs.item[i] >= 0) out[i] = factor * values[pairs.item[i]];
  }

  void bend(const Pairs& pairs, const float* values, Nodes& n) {
    const float *rest = values, *share = values + pairs.places();
    each(0, pairs.places(), [&](int i, int) __attribute__((always_inline)) {
      const bool adjacent = pairs.adjacent[i / BLOCK];
      const int32_t *one = &pairs.first[i], *other = &pairs.second[i], *item = &pairs.item[i];
      const Vec a = gather(n.angle, one, adjacent), b = gather(n.angle, other, adjacent);
      const Vec turn = load(share + i) * wrapped((b - a) - load(rest + i));
      // The second before the first, see `Pairs::consecutive`.
      scatter(n.angle, other, item, adjacent, b - turn);
      scatter(n.angle, one, item, adjacent, a + turn);
    });
  }

  void stretch(const Pairs& pairs, const float* values, Nodes& n) {
    const int places = pairs.places();
    const float *rest = values, *share = values + places, *shear = share + places;
    each(0, places, [&](int i, int) __attribute__((always_inline)) {
      const bool adjacent = pairs.adjacent[i / BLOCK];
      const int32_t *one = &pairs.first[i], *other = &pairs.second[i], *item = &pairs.item[i];
      const Vec x1 = gather(n.new_x, one, adjacent), y1 = gather(n.new_y, one, adjacent);
      const Vec x2 = gather(n.new_x, other, adjacent), y2 = gather(n.new_y, other, adjacent);
      Vec dx, dy;
      correct(x2 - x1, y2 - y1, gather(n.angle, &pairs.own[i], adjacent), load(rest + i),
              load(share + i), load(shear + i), dx, dy);
      scatter(n.new_x, other, item, adjacent, x2 - dx),
          scatter(n.new_y, other, item, adjacent, y2 - dy);
      scatter(n.new_x, one, item, adjacent, x1 + dx),
          scatter(n.new_y, one, item, adjacent, y1 + dy);
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats rest_angle_, rest_length_, bend_, stretch_, shear_;  // Of filaments, by slots.
  List<Floats> values_;  // Of each tile: rest values and stiffnesses, colour by colour.
};

}  // namespace microcosmos::ISA
