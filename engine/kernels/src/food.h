// Energy in whole numbers, as in `fields.food`: creatures eat quanta from their cells, and the rest
// regrows, decays, spreads and drifts. Every quantum is counted, in any order.
#pragma once
#include "density.h"
#include "points.h"

namespace microcosmos::ISA {

class Food {
 public:
  Food(const Rollout& r, const Lattice& l) : r_(r) {
    if (!r.fed) return;
    const size_t cells = size_t(l.height + 1) * l.wide;
    field_ = Array<int32_t>(cells), next_ = Array<int32_t>(cells), eaters_ = Array<int32_t>(cells);
    if (r.carried) along_x_ = Floats(cells), along_y_ = Floats(cells);
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
    each_eater(b, accounts, me, [&](int, int slot) {
      __atomic_fetch_add(&eaters_[here(n, l, slot)], 1, __ATOMIC_RELAXED);
    });
    me.wait();  // Eaters of all members are counted.
    // What each body ate: its account decides who eats, until all have.
    for (int body = me.share.bodies.from; body < me.share.bodies.to; body++) ate_[body] = 0;
    each_eater(b, accounts, me, [&](int body, int slot) {
      const int at = here(n, l, slot);
      ate_[body] += share(at, __atomic_load_n(&eaters_[at], __ATOMIC_RELAXED));
    });
    me.wait();  // Nobody takes from a cell before all know their shares.
    each_eater(b, accounts, me, [&](int, int slot) {
      const int at = here(n, l, slot);
      const int count = __atomic_exchange_n(&eaters_[at], 0, __ATOMIC_RELAXED);
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
        const float length = float(r_.food_every) / float(turns);
        for (int turn = 0; turn < turns; turn++) {
          drift(l, band, length);
          swap(me);
        }
      }
      if (r_.rations[FOOD_DIFFUSION] > 0) {
        spread_out(l, band);
        swap(me);
      }
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
  static constexpr int32_t FULL_ACCOUNT = 1 << 30;  // With so many quanta nobody eats.

  template <class Work>
  void each_eater(const Bodies& b, const int32_t* accounts, const Member& me, Work work) const {
    for (int p = me.share.pieces.from; p < me.share.pieces.to; p++)
      for (int node : b.pieces[p].node_of)
        if (r_.present[node] && accounts[r_.member[node]] < FULL_ACCOUNT)
          work(r_.member[node], b.node_slot[node]);
  }

  // The cell at a node: the nearest.
  int here(const Nodes& n, const Lattice& l, int slot) const {
    float share;
    const int x = cell(n.x[slot] + 0.5f, l.height, share);
    return int(x * l.wide) + cell(n.y[slot] + 0.5f, l.width, share);
  }

  int32_t share(int at, int count) const {
    const int32_t bite = int32_t(r_.rations[BITE]), part = count ? field_[at] / count : 0;
    return part < bite ? part : bite;
  }

  void take(int at, int32_t quanta, const Lattice& l) {
    field_[at] -= quanta;
    const int y = at % int(l.wide);
    if (y < 3) field_[at + l.width] = field_[at];
  }

  void swap(const Member& me) {
    me.wait();  // Neighbours of a band read the old field.
    if (me.first()) std::swap(field_, next_);
    me.wait();
  }

  // Windows that cross the edge of a row continue beyond it.
  void continue_rows(const Lattice& l, const Band& band) {
    for (int x = band.from; x < band.to; x++)
      for (int i = 0; i < 3; i++) field_[x * l.wide + l.width + i] = field_[x * l.wide + i];
  }

  bool solid(int x, int y) const { return r_.walled && r_.walls[size_t(x) * r_.width + y]; }

  // The velocity of the fluid in the cells of a band.
  void measure(const Lattice& l, const Band& band) {
    for (int x = band.from; x < band.to; x++) {
      const float* f[9];
      for (int i = 0; i < 9; i++) f[i] = l.populations + i * l.plane + x * l.row;
      float *to_x = along_x_ + x * l.wide, *to_y = along_y_ + x * l.wide;
      for (int y = 0; y < l.width; y++) {
        const float across = f[5][y] - f[6][y], along = f[7][y] - f[8][y];
        float jx = (f[1][y] - f[2][y]) + (across + along);
        float jy = (f[3][y] - f[4][y]) + (across - along);
        if (!solid(x, y)) {
          if (r_.driven) jx += 0.5f * r_.uniform_force[0], jy += 0.5f * r_.uniform_force[1];
          if (r_.varied)
            jx += 0.5f * r_.force_x[size_t(x) * l.width + y],
                jy += 0.5f * r_.force_y[size_t(x) * l.width + y];
        }
        const float straight = (f[1][y] + f[2][y]) + (f[3][y] + f[4][y]);
        const float density =
            1.0f + (f[0][y] + straight + ((f[5][y] + f[6][y]) + (f[7][y] + f[8][y])));
        to_x[y] = jx / density, to_y[y] = jy / density;
      }
    }
  }

  // Quanta that the water carries from one cell to the next in so many steps, by the mean of their
  // velocities: at most a quarter of a cell's, so that none gives more than it has.
  INLINE static int32_t carried(int32_t one, int32_t next, float velocity, float length) {
    float share = velocity * length;
    share = share < 0.25f ? share : 0.25f;
    share = share > -0.25f ? share : -0.25f;
    // Beyond 2^24 quanta the product may be more than a quarter.
    const int32_t given = int32_t(float(share > 0 ? one : next) * share);
    return share > 0 ? std::min(given, one / 4) : std::max(given, -(next / 4));
  }

  void drift(const Lattice& l, const Band& band, float length) {
    each_cell(l, band, [&](int x, int y, size_t at, size_t up, size_t down, size_t left,
                           size_t right) __attribute__((always_inline)) {
      auto flow = [&](const Floats& along, size_t one, size_t next) {
        return carried(field_[one], field_[next], 0.5f * (along[one] + along[next]), length);
      };
      int32_t in_x = flow(along_x_, up, at), out_x = flow(along_x_, at, down);
      int32_t in_y = flow(along_y_, left, at), out_y = flow(along_y_, at, right);
      if (r_.walled) keep_out(l, x, y, in_x, out_x, in_y, out_y);
      next_[at] = field_[at] + ((in_x - out_x) + (in_y - out_y));
    });
  }

  void spread_out(const Lattice& l, const Band& band) {
    const float share = r_.rations[FOOD_DIFFUSION];
    each_cell(l, band, [&](int x, int y, size_t at, size_t up, size_t down, size_t left,
                           size_t right) __attribute__((always_inline)) {
      auto flow = [&](size_t one, size_t next) {
        const int32_t given = int32_t(float(field_[one] - field_[next]) * share);
        return std::max(std::min(given, field_[one] / 4), -(field_[next] / 4));
      };
      int32_t in_x = flow(up, at), out_x = flow(at, down);
      int32_t in_y = flow(left, at), out_y = flow(at, right);
      if (r_.walled) keep_out(l, x, y, in_x, out_x, in_y, out_y);
      next_[at] = field_[at] + ((in_x - out_x) + (in_y - out_y));
    });
  }

  // Nothing passes into or out of walls.
  void keep_out(const Lattice& l, int x, int y, int32_t& in_x, int32_t& out_x, int32_t& in_y,
                int32_t& out_y) const {
    const int H = l.height, W = l.width;
    const bool wall = solid(x, y);
    if (wall || solid(x ? x - 1 : H - 1, y)) in_x = 0;
    if (wall || solid(x + 1 < H ? x + 1 : 0, y)) out_x = 0;
    if (wall || solid(x, y ? y - 1 : W - 1)) in_y = 0;
    if (wall || solid(x, y + 1 < W ? y + 1 : 0)) out_y = 0;
  }

  template <class Work>
  INLINE void each_cell(const Lattice& l, const Band& band, Work work) const {
    const int H = l.height, W = l.width;
    for (int x = band.from; x < band.to; x++) {
      const size_t row = size_t(x) * l.wide, up = size_t(x ? x - 1 : H - 1) * l.wide,
                   down = size_t(x + 1 < H ? x + 1 : 0) * l.wide;
      work(x, 0, row, up, down, row + W - 1, row + 1);
      for (int y = 1; y < W - 1; y++)
        work(x, y, row + y, up + y, down + y, row + y - 1, row + y + 1);
      work(x, W - 1, row + W - 1, up + W - 1, down + W - 1, row + W - 2, row);
    }
  }

  // Let food decay and regrow towards the capacity.
  void regrow(const Lattice& l, const Band& band) {
    const float decay = r_.rations[DECAY], regrowth = r_.rations[REGROWTH];
    for (int x = band.from; x < band.to; x++) {
      int32_t* field = field_ + x * l.wide;
      const int32_t* capacity = r_.capacity + size_t(x) * l.width;
      int64_t lost = 0, grown = 0;
      for (int y = 0; y < l.width; y++) {
        const int32_t gone = int32_t(float(field[y]) * decay), left = field[y] - gone;
        const int32_t gap = capacity[y] - left;
        const int32_t more = int32_t(float(gap > 0 ? gap : 0) * regrowth);
        field[y] = left + more, lost += gone, grown += more;
      }
      lost_[x] += lost, grown_[x] += grown;
    }
  }

  const Rollout& r_;
  Array<int32_t> field_, next_, eaters_;
  Floats along_x_, along_y_;
  List<int32_t> ate_;           // Of each body in a step.
  List<int64_t> grown_, lost_;  // In each row.
  int time_ = 0;
};

}  // namespace microcosmos::ISA
