// Surroundings of the fluid: walls, forces and a sponge, as in `fluid.surroundings`.
#pragma once
#include <algorithm>

#include "fluid.h"
#include "rollout.h"

namespace microcosmos::ISA {

class Surroundings {
 public:
  Surroundings(const Rollout& r, Lattice& l) {
    if (r.driven) l.push_x = r.uniform_force[0], l.push_y = r.uniform_force[1], l.drive = UNIFORM;
    if (r.varied || (r.driven && r.walled)) find_forces(r, l);
    if (r.walled) find_walls(r, l);
    if (r.damped) find_sponge(r, l);
  }

  // Bounce back at walls, then relax the sponge, after the fluid has streamed.
  void act(Lattice& l, const Member& me) const {
    const Range links = me.part(links_.size());
    for (int i = links.from; i < links.to; i++)
      l.populations[links_[i].fluid] = l.populations[links_[i].wall];
    if (!links_.empty()) me.wait();  // A link reads its wall cell before that is emptied.
    const Band& band = l.bands[me.number];
    const Range walls = within(walls_, l, band), blocks = within(blocks_, l, band);
    for (int n = walls.from; n < walls.to; n++)
      for (int i = 0; i < 9; i++) l.populations[i * l.plane + walls_[n]] = 0;
    each(blocks.from * BLOCK, blocks.to * BLOCK,
         [&](int i, int part) __attribute__((always_inline)) {
           const Vec strength = load(strength_ + i);
           float* at = l.populations + blocks_[i / BLOCK] + part * LANES;
           for (int direction = 0; direction < 9; direction++, at += l.plane) {
             const Vec f = load(at);
             store(at, f + strength * (free_[direction] - f));
           }
         });
  }

 private:
  static constexpr int WAYS[9][2] = {{0, 0}, {1, 0},   {-1, 0}, {0, 1}, {0, -1},
                                     {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
  // Populations of a fluid cell and of the wall beside it: what streams into the wall returns as
  // its opposite.
  struct Link {
    size_t fluid, wall;
  };

  // Return the range of those cells, which ascend, that are in a band.
  static Range within(const List<size_t>& cells, const Lattice& l, const Band& band) {
    auto before = [&](int row) {
      return int(std::lower_bound(cells.begin(), cells.end(), row * l.row) - cells.begin());
    };
    return {before(band.from), before(band.to)};
  }

  // Add the uniform force to that of each cell, so that a collision reads one of them. In walls,
  // which are at rest, there is none.
  void find_forces(const Rollout& r, Lattice& l) {
    l.drive = VARIED;
    l.pushes_x = Floats(l.row * l.height), l.pushes_y = Floats(l.row * l.height);
    for (int x = 0; x < r.height; x++)
      for (int y = 0; y < r.width; y++) {
        const size_t given = size_t(x) * r.width + y, cell = x * l.row + y;
        if (r.walled && r.walls[given]) continue;
        l.pushes_x[cell] = l.push_x + (r.varied ? r.force_x[given] : 0);
        l.pushes_y[cell] = l.push_y + (r.varied ? r.force_y[given] : 0);
      }
  }

  void find_walls(const Rollout& r, const Lattice& l) {
    auto solid = [&](int x, int y) { return r.walls[size_t(x) * r.width + y] != 0; };
    for (int x = 0; x < r.height; x++)
      for (int y = 0; y < r.width; y++) {
        const size_t cell = x * l.row + y;
        if (solid(x, y)) {
          walls_.push_back(cell);
          continue;
        }
        for (int i = 1; i < 9; i++) {
          const int from_x = (x - WAYS[i][0] + r.height) % r.height;
          const int from_y = (y - WAYS[i][1] + r.width) % r.width;
          const int opposite = i % 2 ? i + 1 : i - 1;
          if (solid(from_x, from_y))
            links_.push_back({i * l.plane + cell, opposite * l.plane + from_x * l.row + from_y});
        }
      }
  }

  // Find the blocks that the sponge reaches, and the equilibrium of its stream at rest density. A
  // first pass counts the blocks, a second one stores their strengths.
  void find_sponge(const Rollout& r, const Lattice& l) {
    for (int pass = 0; pass < 2; pass++) {
      if (pass) strength_ = Floats(blocks_.size() * BLOCK), blocks_.clear();
      for (int x = 0; x < r.height; x++)
        for (int from = 0; from < r.width; from += BLOCK) {
          const float* given = r.sponge + size_t(x) * r.width + from;
          const int count = std::min(BLOCK, r.width - from);
          if (std::all_of(given, given + count, [](float one) { return one == 0; })) continue;
          if (pass) std::copy(given, given + count, strength_ + blocks_.size() * BLOCK);
          blocks_.push_back(x * l.row + from);
        }
    }
    const float ux = r.sponge_velocity[0], uy = r.sponge_velocity[1];
    const float square = 1.5f * (ux * ux + uy * uy);
    const float along[] = {ux, uy, ux + uy, ux - uy};
    free_[0] = -Rates::REST * square;
    for (int pair = 0; pair < 4; pair++) {
      const float weight = pair < 2 ? Rates::STRAIGHT : Rates::DIAGONAL, cu = along[pair];
      const float even = weight * (4.5f * cu * cu - square), odd = 3 * weight * cu;
      free_[2 * pair + 1] = even + odd, free_[2 * pair + 2] = even - odd;
    }
  }

  List<Link> links_;
  List<size_t> walls_, blocks_;  // Wall cells, and blocks of the sponge, in a plane.
  Floats strength_;
  float free_[9] = {};
};

}  // namespace microcosmos::ISA
