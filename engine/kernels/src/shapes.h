// Constraints: shape matching of stiff bodies, coloured Gauss-Seidel sweeps of soft ones.
//
// Shape matching: Mueller et al., ACM Trans. Graph. 24, 471 (2005). Sweeps: Mueller et al.,
// J. Vis. Commun. Image R. 18, 109 (2007); Umetani, Schmidt and Stam, SCA 2014.
#pragma once
#include "bodies.h"

namespace microcosmos::ISA {

// The nodes and edges of all bodies, by slots.
struct Nodes {
  Floats x, y;          // Positions at the start of the step.
  Floats new_x, new_y;  // Where constraints move them.
  Floats here;          // 1 for nodes that have grown.
  Floats angle;         // Of edges.

  explicit Nodes(const Bodies& b) {
    for (Floats* one : {&x, &y, &new_x, &new_y, &here}) *one = Floats(b.node_slots + 2 * BLOCK);
    angle = Floats(b.edge_slots + 2 * BLOCK);
  }
};

// Move edge angles to those of the geometry, on the nearest branch, by the share `feedback`.
inline void follow_geometry(const Bodies& b, Nodes& n, float feedback) {
  each(0, b.edge_slots, [&](int i, int) __attribute__((always_inline)) {
    const bool adjacent = b.edges.adjacent[i / BLOCK];
    const int32_t *one = &b.edges.first[i], *other = &b.edges.second[i];
    const Vec vx = gather(n.new_x, other, adjacent) - gather(n.new_x, one, adjacent);
    const Vec vy = gather(n.new_y, other, adjacent) - gather(n.new_y, one, adjacent);
    const Vec angle = load(n.angle + i);
    const Vec followed = angle + wrapped(arctangent(vy, vx) - angle);
    store(n.angle + i, feedback == 1 ? followed : angle + feedback * (followed - angle));
  });
}

// Rest shapes of stiff bodies, fitted to where the fluid carried their nodes.
class Matching {
 public:
  Matching(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    direction_ = Floats(b.edge_slots + BLOCK), along_x_ = Floats(b.edge_slots + BLOCK);
    along_y_ = Floats(b.edge_slots + BLOCK);
    goal_x_ = Floats(b.node_slots + BLOCK), goal_y_ = Floats(b.node_slots + BLOCK);
    if (!r.matched) return;  // There is no layout to read.
    size_t room = 0;
    for (const Piece& p : b.pieces)
      if (!p.chain) {
        starts_.push_back(room);
        room += p.joint_of.size() * (p.edges.to - p.edges.from) +
                p.edge_of.size() * (p.nodes.to - p.nodes.from);
      } else
        starts_.push_back(0);
    factors_ = Floats(room);
    for (size_t p = 0; p < b.pieces.size(); p++)
      if (!b.pieces[p].chain) transpose(b.pieces[p], factors_ + starts_[p]);
  }

  // Replace new positions by the rest shapes, moved and turned to be nearest to them.
  void apply(Nodes& n, const float* rest_angle, const float* rest_length) {
    for (size_t p = 0; p < b_.pieces.size(); p++) {
      const Piece& piece = b_.pieces[p];
      if (piece.chain)
        chain(piece, rest_angle, rest_length);
      else
        graph(piece, factors_ + starts_[p], rest_angle, rest_length);
      fit(piece, n);
    }
  }

 private:
  // The rows of both factors of a piece, one for each joint and edge, by slots.
  void transpose(const Piece& p, float* out) {
    const int edges = p.edges.to - p.edges.from, nodes = p.nodes.to - p.nodes.from;
    for (int j : p.joint_of) {
      for (int e : p.edge_of)
        out[b_.edge_slot[e] - p.edges.from] = r_.turned[size_t(e) * r_.joints + j];
      out += edges;
    }
    for (int e : p.edge_of) {
      for (int n : p.node_of)
        out[b_.node_slot[n] - p.nodes.from] = r_.placed[size_t(n) * r_.edges + e];
      out += nodes;
    }
  }

  // A filament, from its first edge on.
  void chain(const Piece& p, const float* rest_angle, const float* rest_length) {
    const int count = int(p.edge_of.size());
    float angle = count ? r_.layout_angle[p.edge_of[0]] : 0;
    for (int k = 0; k < count; k++) {
      direction_[b_.edge_slot[p.edge_of[k]]] = angle;
      if (k + 1 < count) angle = angle + rest_angle[p.joint_of[k]];
    }
    measure(p, rest_length);
    float x = 0, y = 0;
    for (int k = 0; k <= count; k++) {
      const int slot = b_.node_slot[p.node_of[k]];
      goal_x_[slot] = x, goal_y_[slot] = y;
      if (k == count) break;
      const int edge = b_.edge_slot[p.edge_of[k]];
      x = x + along_x_[edge], y = y + along_y_[edge];
    }
  }

  // Any graph: by least squares where its branches and loops contradict each other.
  void graph(const Piece& p, const float* factors, const float* rest_angle,
             const float* rest_length) {
    for (int e : p.edge_of) direction_[b_.edge_slot[e]] = r_.layout_angle[e];
    const int edges = p.edges.to - p.edges.from, nodes = p.nodes.to - p.nodes.from;
    for (int j : p.joint_of) {
      const float turn = rest_angle[j] - r_.layout_rest_angle[j];
      for (int i = 0; i < edges; i += LANES) {
        float* d = direction_ + p.edges.from + i;
        store(d, load(d) + turn * load(factors + i));
      }
      factors += edges;
    }
    measure(p, rest_length);
    each(p.nodes.from, p.nodes.to, [&](int i, int) __attribute__((always_inline)) {
      store(goal_x_ + i, Vec{}), store(goal_y_ + i, Vec{});
    });
    for (int e : p.edge_of) {
      const float vx = along_x_[b_.edge_slot[e]], vy = along_y_[b_.edge_slot[e]];
      for (int i = 0; i < nodes; i += LANES) {
        float *x = goal_x_ + p.nodes.from + i, *y = goal_y_ + p.nodes.from + i;
        const Vec factor = load(factors + i);
        store(x, load(x) + vx * factor), store(y, load(y) + vy * factor);
      }
      factors += nodes;
    }
  }

  // The vectors along edges, from their directions.
  void measure(const Piece& p, const float* rest_length) {
    for (int e : p.edge_of) along_x_[b_.edge_slot[e]] = rest_length[e];
    each(p.edges.from, p.edges.to, [&](int i, int) __attribute__((always_inline)) {
      Vec s, c;
      sine_cosine(load(direction_ + i), s, c);
      const Vec length = load(along_x_ + i);
      store(along_x_ + i, c * length), store(along_y_ + i, s * length);
    });
  }

  void fit(const Piece& p, Nodes& n) {
    Sum here, sx, sy, gx, gy;
    each(p.nodes.from, p.nodes.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i);
      here.add(part, h);
      sx.add(part, h * load(n.new_x + i)), sy.add(part, h * load(n.new_y + i));
      gx.add(part, h * load(goal_x_ + i)), gy.add(part, h * load(goal_y_ + i));
    });
    const float count = here.total();
    const float cx = sx.total() / count, cy = sy.total() / count, mx = gx.total() / count,
                my = gy.total() / count;
    Sum cosines, sines;
    each(p.nodes.from, p.nodes.to, [&](int i, int part) __attribute__((always_inline)) {
      const Vec h = load(n.here + i), x = load(goal_x_ + i) - mx, y = load(goal_y_ + i) - my;
      const Vec ax = load(n.new_x + i) - cx, ay = load(n.new_y + i) - cy;
      cosines.add(part, h * (x * ax + y * ay)), sines.add(part, h * (x * ay - y * ax));
    });
    float c = cosines.total(), s = sines.total();
    const float size = root(c * c + s * s + 1e-24f);
    c = c / size, s = s / size;
    each(p.nodes.from, p.nodes.to, [&](int i, int) __attribute__((always_inline)) {
      const Vec x = load(goal_x_ + i) - mx, y = load(goal_y_ + i) - my;
      store(n.new_x + i, cx + (c * x - s * y)), store(n.new_y + i, cy + (s * x + c * y));
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  Floats direction_, along_x_, along_y_, goal_x_, goal_y_, factors_;
  std::vector<size_t> starts_;
};

class Sweeps {
 public:
  Sweeps(const Bodies& b, const Rollout& r) : b_(b), r_(r) {
    for (const auto& tile : b.tiles) {
      size_t room = 0;
      for (const auto& colours : {&tile.edge_colours, &tile.joint_colours})
        for (const Pairs& pairs : *colours) room += 3 * pairs.places();
      values_.push_back(Floats(room));
      float* at = values_.back();
      for (const Pairs& pairs : tile.joint_colours) {
        fill(pairs, r.bend, 0.5f, at + pairs.places());
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
  void apply(Nodes& n, const float* rest_angle, const float* rest_length) {
    for (size_t t = 0; t < b_.tiles.size(); t++) {
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
      scatter(n.angle, other, item, adjacent, b - turn);
      scatter(n.angle, one, item, adjacent, a + turn);
    });
  }

  // Correct lengths along the tangent, and shear to the director.
  void stretch(const Pairs& pairs, const float* values, Nodes& n) {
    const int places = pairs.places();
    const float *rest = values, *share = values + places, *shear = share + places;
    each(0, places, [&](int i, int) __attribute__((always_inline)) {
      const bool adjacent = pairs.adjacent[i / BLOCK];
      const int32_t *one = &pairs.first[i], *other = &pairs.second[i], *item = &pairs.item[i];
      const Vec x1 = gather(n.new_x, one, adjacent), y1 = gather(n.new_y, one, adjacent);
      const Vec x2 = gather(n.new_x, other, adjacent), y2 = gather(n.new_y, other, adjacent);
      Vec s, c;
      sine_cosine(gather(n.angle, &pairs.own[i], adjacent), s, c);
      const Vec vx = x2 - x1, vy = y2 - y1, length = load(rest + i);
      const Vec ratio = length / root(vx * vx + vy * vy + 1e-12f);
      const Vec ax = vx - vx * ratio, ay = vy - vy * ratio;
      const Vec gx = vx - c * length, gy = vy - s * length;
      const Vec k = load(share + i), q = load(shear + i);
      const Vec dx = k * (ax + q * (gx - ax)), dy = k * (ay + q * (gy - ay));
      scatter(n.new_x, other, item, adjacent, x2 - dx),
          scatter(n.new_y, other, item, adjacent, y2 - dy);
      scatter(n.new_x, one, item, adjacent, x1 + dx),
          scatter(n.new_y, one, item, adjacent, y1 + dy);
    });
  }

  const Bodies& b_;
  const Rollout& r_;
  std::vector<Floats> values_;  // Of each tile: rest values and stiffnesses, colour by colour.
};

}  // namespace microcosmos::ISA
