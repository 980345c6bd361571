// Energy in whole numbers, as in `fields.food`: creatures eat quanta from their cells; the rest
// drifts, spreads, decays and regrows. Sums of quanta are exact, in any order.
#pragma once
#include "density.h"
#include "points.h"

namespace microcosmos::ISA {

class Food {
 public:
  Food(const Bodies& b, const Rollout& r, const Lattice& l, int members)
      : r_(r), alone_(members == 1) {
    if (!r.fed) return;
    cell_x_ = Array<int32_t>(b.node_slots + BLOCK), cell_y_ = Array<int32_t>(b.node_slots + BLOCK);
    share_ = Floats(b.node_slots + BLOCK);
    const size_t cells = size_t(l.height + 1) * l.wide;
    field_ = Array<int32_t>(cells), eaters_ = Array<int32_t>(cells);
    for (int member = 0; member < members; member++) flows_.emplace_back(l.wide);
    for (Floats* one : {&along_x_, &along_y_, &share_x_, &share_y_})
      *one = Floats(r.carried ? cells : 0);
    for (int x = 0; x < l.height; x++)
      std::memcpy(field_ + x * l.wide, r.food + size_t(x) * l.width, 4 * size_t(l.width));
    for (const Band& band : l.bands) continue_rows(l, band);
    grown_.assign(l.height, 0), lost_.assign(l.height, 0);
    time_ = r.time[0], ate_.assign(r.bodies, 0);
  }

  // The energy around a point, by the weights of its window.
  float near(const Window& window, const Lattice& l) const {
    Vec4 sum = {};
    each_row(window, l, [&](int i, int32_t row) {
      typedef int32_t Ints4 __attribute__((vector_size(16)));
      sum = sum + window.weights[i] *
                      __builtin_convertvector(load<Ints4>((const float*)(field_ + row)), Vec4);
    });
    sum = sum * load<Vec4>(window.weights + 4);
    return ((sum[0] + sum[2]) + (sum[1] + sum[3])) / r_.rations[UNIT];
  }

  // The energy at any place, between the four cells around it.
  float at(float x, float y, const Lattice& l) const {
    float dx, dy;
    const int i = cell(x, l.height, dx), j = cell(y, l.width, dy);
    const int32_t* one = field_ + size_t(i) * l.wide;
    const int32_t* other = field_ + size_t(i + 1 < l.height ? i + 1 : 0) * l.wide;
    const int next = j + 1 < l.width ? j + 1 : 0;
    return ((1 - dx) * ((1 - dy) * float(one[j]) + dy * float(one[next])) +
            dx * ((1 - dy) * float(other[j]) + dy * float(other[next]))) /
           r_.rations[UNIT];
  }

  // Eat at the nodes of the bodies of a share, where they stand; `accounts` are by body.
  void eat(const Bodies& b, const Nodes& n, const Lattice& l, int32_t* accounts, const Member& me) {
    // A node eats from its nearest cell.
    first_cells(me.share.nodes, n.x, share_, cell_x_, l.height, -0.5f);
    first_cells(me.share.nodes, n.y, share_, cell_y_, l.width, -0.5f);
    each_eater(b, accounts, me, [&](int, int slot) {
      int32_t& count = eaters_[here(l, slot)];
      if (alone_)
        count++;
      else
        __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED);
    });
    me.wait();  // Eaters of all members are counted.
    // Accounts change at the end: until then they decide who eats.
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++) ate_[body] = 0;
    each_eater(b, accounts, me, [&](int body, int slot) {
      const int at = here(l, slot);
      ate_[body] += share(at, __atomic_load_n(&eaters_[at], __ATOMIC_RELAXED));
    });
    me.wait();  // Nobody takes from a cell before all know their shares.
    each_eater(b, accounts, me, [&](int, int slot) {
      const int at = here(l, slot);
      int32_t count;
      if (alone_)
        count = eaters_[at], eaters_[at] = 0;
      else
        count = __atomic_exchange_n(&eaters_[at], 0, __ATOMIC_RELAXED);
      if (count) take(at, count * share(at, count), l);
    });
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++)
      accounts[body] += ate_[body];
    me.wait();
  }

  // Let the food of a band change on its own, every so many steps.
  void change(Lattice& l, const Member& me) {
    const Band& band = l.bands[me.number];
    const int time = time_ + 1;
    if (time % r_.food_every == 0) {
      if (r_.carried) {
        measure(l, band);
        me.wait();  // Faces have cells of two bands.
        // So long that water of 1/16 cells a step crosses a quarter of a cell.
        const int turns = (r_.food_every + 3) / 4;
        find_shares(l, band, float(r_.food_every) / float(turns));
        for (int turn = 0; turn < turns; turn++) move(l, band, me, true);
      }
      if (r_.rations[FOOD_DIFFUSION] > 0) move(l, band, me, false);
      regrow(l, band);
      continue_rows(l, band);
    }
    me.wait();
    if (me.first()) time_ = time;
    me.wait();
  }

  void end(const Lattice& l) const {
    if (!r_.fed) return;
    for (int x = 0; x < l.height; x++)
      std::memcpy(r_.end_food + size_t(x) * l.width, field_ + x * l.wide, 4 * size_t(l.width));
    r_.end_time[0] = time_;
    for (int x = 0; x < l.height; x++)
      for (int part : {0, 1}) {
        r_.grown[2 * x + part] = int32_t(part ? grown_[x] & 4095 : grown_[x] >> 12);
        r_.lost[2 * x + part] = int32_t(part ? lost_[x] & 4095 : lost_[x] >> 12);
      }
  }

 private:
  // Quanta that flow out of the cells of a row: the one before, this one, and the last of a band;
  // and along this one, from its second block on.
  struct Flows {
    Array<int32_t> up, down, last, along;
    explicit Flows(size_t row) : up(row), down(row), last(row), along(row + 2 * BLOCK) {}
  };

  static constexpr int32_t FULL_ACCOUNT = 1 << 30;  // With so many quanta nobody eats.

  template <class Work>
  void each_eater(const Bodies& b, const int32_t* accounts, const Member& me, Work work) const {
    for (int p = me.share.pieces.from; p < me.share.pieces.to; p++)
      for (int node : b.pieces[p].node_of)
        if (r_.present[node] && accounts[r_.member[node]] < FULL_ACCOUNT)
          work(r_.member[node], b.node_slot[node]);
  }

  int here(const Lattice& l, int slot) const { return cell_x_[slot] * int(l.wide) + cell_y_[slot]; }

  int32_t share(int at, int count) const {
    const int32_t bite = int32_t(r_.rations[BITE]);
    // Most eaters are alone, and a division takes as long as all the rest.
    const int32_t part = count == 1 ? field_[at] : count ? field_[at] / count : 0;
    return part < bite ? part : bite;
  }

  void take(int at, int32_t quanta, const Lattice& l) {
    field_[at] -= quanta;
    const int y = at % int(l.wide);
    if (y < 3) field_[at + l.width] = field_[at];
  }

  // Windows that cross the edge of a row continue beyond it.
  void continue_rows(const Lattice& l, const Band& band) {
    for (int x = band.from; x < band.to; x++)
      for (int i = 0; i < 3; i++) field_[x * l.wide + l.width + i] = field_[x * l.wide + i];
  }

  bool solid(int x, int y) const { return r_.walled && r_.walls[size_t(x) * r_.width + y]; }

  // Call work(place, lanes) for each vector of a row that begins at a place; the last may be cut.
  template <class Work>
  INLINE static void each_vector(const Lattice& l, int x, Work work) {
    const size_t row = size_t(x) * l.wide;
    for (int y = 0; y < l.width; y += LANES) work(row + y, std::min(LANES, l.width - y));
  }

  INLINE static Ints load_whole(const int32_t* from) {
    Ints v;
    std::memcpy(&v, from, sizeof v);
    return v;
  }
  // Store some lanes: what stands beyond a row belongs to others.
  template <class V, class T>
  INLINE static void store_some(T* to, V v, int lanes) {
    if (lanes == LANES)
      std::memcpy(to, &v, sizeof v);
    else
      std::memcpy(to, &v, 4 * size_t(lanes));
  }

  // The velocity of the fluid in the cells of a band.
  void measure(const Lattice& l, const Band& band) {
    for (int x = band.from; x < band.to; x++) {
      const float* from = l.populations + x * l.row;
      each_vector(l, x, [&](size_t at, int lanes) __attribute__((always_inline)) {
        const size_t y = at - size_t(x) * l.wide;
        Vec f[9];
        for (int i = 0; i < 9; i++) f[i] = load(from + i * l.plane + y);
        const Vec across = f[5] - f[6], along = f[7] - f[8];
        Vec jx = (f[1] - f[2]) + (across + along), jy = (f[3] - f[4]) + (across - along);
        // Half a step of the surroundings' force has acted; see `moments`.
        if (l.drive == UNIFORM) jx = jx + 0.5f * l.push_x, jy = jy + 0.5f * l.push_y;
        if (l.drive == VARIED)
          jx = jx + 0.5f * load(l.pushes_x + x * l.row + y),
          jy = jy + 0.5f * load(l.pushes_y + x * l.row + y);
        const Vec volume =
            1.0f /
            (1.0f + (f[0] + ((f[1] + f[2]) + (f[3] + f[4])) + ((f[5] + f[6]) + (f[7] + f[8]))));
        store_some(along_x_ + at, jx * volume, lanes),
            store_some(along_y_ + at, jy * volume, lanes);
      });
      along_y_[x * l.wide + l.width] = along_y_[x * l.wide];
    }
  }

  // The share of the giver's quanta that the water carries through each face in so many steps, by
  // the mean of the velocities beside it: at most a quarter, so that none gives more than it has.
  void find_shares(const Lattice& l, const Band& band, float length) {
    for (int x = band.from; x < band.to; x++) {
      const ptrdiff_t down = below(l, x);
      each_vector(l, x, [&](size_t at, int lanes) __attribute__((always_inline)) {
        auto share = [&](const Floats& along, ptrdiff_t next) __attribute__((always_inline)) {
          const Vec far = 0.5f * (load(along + at) + load(along + at + next)) * length;
          return least(most(far, all(-0.25f)), all(0.25f));
        };
        store_some(share_x_ + at, share(along_x_, down), lanes);
        store_some(share_y_ + at, share(along_y_, 1), lanes);
      });
    }
  }

  // Move food from cell to cell, carried by the water or from more to less.
  void move(const Lattice& l, const Band& band, const Member& me, bool carries) {
    Flows& f = flows_[me.number];
    const int H = l.height, W = l.width, before = band.from ? band.from - 1 : H - 1;
    me.wait();  // Cells of neighbouring bands are as they were after the last turn.
    flow_down(l, before, carries, f.up);
    flow_down(l, band.to - 1, carries, f.last);
    me.wait();  // Flows between bands are known, and no cell has changed.
    for (int x = band.from; x < band.to; x++) {
      if (x + 1 < band.to) flow_down(l, x, carries, f.down);
      const int32_t *up = f.up, *down = x + 1 < band.to ? f.down : f.last;
      const size_t row = size_t(x) * l.wide;
      // The last cell of a row gives to the first.
      int32_t* along = f.along + BLOCK;
      each_vector(l, x, [&](size_t at, int lanes) __attribute__((always_inline)) {
        store_some(along + (at - row), flow(at, 1, share_y_, carries), lanes);
      });
      if (r_.walled)
        for (int y = 0; y < W; y++)
          if (solid(x, y) || solid(x, y + 1 < W ? y + 1 : 0)) along[y] = 0;
      along[-1] = along[W - 1];
      each_vector(l, x, [&](size_t at, int lanes) __attribute__((always_inline)) {
        const size_t y = at - row;
        const Ints in = load_whole(up + y) + load_whole(along + y - 1);
        const Ints out = load_whole(down + y) + load_whole(along + y);
        store_some(field_ + at, load_whole(field_ + at) + (in - out), lanes);
      });
      std::swap(f.up, f.down);
    }
    continue_rows(l, band);
  }

  // Quanta that flow from the cells of a row to those of the next.
  void flow_down(const Lattice& l, int x, bool carries, int32_t* to) const {
    const ptrdiff_t down = below(l, x);
    const size_t row = size_t(x) * l.wide;
    each_vector(l, x, [&](size_t at, int lanes) __attribute__((always_inline)) {
      store_some(to + (at - row), flow(at, down, share_x_, carries), lanes);
    });
    const int next = x + 1 < l.height ? x + 1 : 0;
    for (int y = 0; y < l.width && r_.walled; y++)  // Nothing passes into or out of walls.
      if (solid(x, y) || solid(next, y)) to[y] = 0;
  }

  static ptrdiff_t below(const Lattice& l, int x) {
    return x + 1 < l.height ? ptrdiff_t(l.wide) : -ptrdiff_t(l.wide) * x;
  }

  // Quanta that flow from cells to the next: at most a quarter of the giver's, also where there are
  // more than float32 tells apart.
  INLINE Ints flow(size_t at, ptrdiff_t next, const Floats& shares, bool carries) const {
    const Ints one = load_whole(field_ + at), other = load_whole(field_ + at + next);
    Vec given;
    if (carries) {
      const Vec share = load(shares + at);
      given = __builtin_convertvector(share > 0.0f ? one : other, Vec) * share;
    } else
      given = __builtin_convertvector(one - other, Vec) * r_.rations[FOOD_DIFFUSION];
    const Ints whole = __builtin_convertvector(given, Ints), mine = one >> 2, its = -(other >> 2);
    const Ints low = whole > its ? whole : its;
    return low < mine ? low : mine;
  }

  // Let food decay and regrow towards the capacity.
  void regrow(const Lattice& l, const Band& band) {
    const float decay = r_.rations[DECAY], regrowth = r_.rations[REGROWTH];
    for (int x = band.from; x < band.to; x++) {
      int32_t* field = field_ + x * l.wide;
      const int32_t* capacity = r_.capacity + size_t(x) * l.width;
      int64_t lost = 0, grown = 0;
      for (int y = 0; y < l.width; y++) {
        // Beyond 2^24 quanta the product may be more than there is.
        const int32_t gone = std::min(int32_t(float(field[y]) * decay), field[y]);
        const int32_t left = field[y] - gone;
        const int32_t gap = capacity[y] - left;
        const int32_t more = int32_t(float(gap > 0 ? gap : 0) * regrowth);
        field[y] = left + more, lost += gone, grown += more;
      }
      lost_[x] += lost, grown_[x] += grown;
    }
  }

  const Rollout& r_;
  bool alone_;                      // There is one member, which needs no atomics.
  Array<int32_t> cell_x_, cell_y_;  // At each node.
  Floats share_;
  Array<int32_t> field_, eaters_;  // Of cells.
  Floats along_x_, along_y_;       // Velocity of the water.
  Floats share_x_, share_y_;       // Of the giver's quanta that flow to the next cell.
  List<int32_t> ate_;              // Of each body in a step.
  List<Flows> flows_;              // Of each member.
  List<int64_t> grown_, lost_;     // In each row.
  int time_ = 0;
};

}  // namespace microcosmos::ISA
