// The nodes and edges of all bodies in a step.
#pragma once
#include "bodies.h"
#include "functions.h"

namespace microcosmos::ISA {

// The nodes and edges of all bodies, by slots.
struct Nodes {
  Floats x, y;          // Positions at the start of the step.
  Floats new_x, new_y;  // Where constraints move them.
  Floats here;          // 1 for nodes that have grown.
  Floats angle;         // Of edges.
  Floats boxes;         // (body, 2) Whole boxes before the one that a body's positions count from.
  List<int> anchor;     // Of each body, the slot of its first node that has grown; -1: none.
  int leader = 0;       // The first body of which a node has grown.

  Nodes(const Bodies& b, const Rollout& r) {
    for (Floats* one : {&x, &y, &new_x, &new_y, &here}) *one = Floats(b.node_slots + 2 * BLOCK);
    angle = Floats(b.edge_slots + 2 * BLOCK);
    for (int n = 0; n < r.nodes; n++) here[b.node_slot[n]] = float(r.present[n]);
    boxes = Floats(2 * size_t(r.bodies)), anchor.assign(std::max(r.bodies, 1), -1);
    for (int n = r.nodes; n-- > 0;)
      if (r.present[n]) anchor[r.member[n]] = b.node_slot[n];
    while (leader + 1 < r.bodies && anchor[leader] < 0) leader++;
    if (anchor[leader] < 0) leader = 0;
  }
};

// The largest whole number that is not above x. Beyond 2^23 all floats are whole.
INLINE float whole(float x) {
  if (!(x < 8388608.0f && x > -8388608.0f)) return x;
  const float cut = float(int32_t(x));
  return cut > x ? cut - 1 : cut;
}

// Put each body into the box that holds its anchor: far from the origin, rounding would swallow
// the steps of its nodes.
inline void put_within_box(const Bodies& b, Nodes& n, const Rollout& r, Range bodies) {
  for (int body = bodies.from; body < bodies.to; body++) {
    if (n.anchor[body] < 0) continue;
    const float x = whole(n.x[n.anchor[body]] / float(r.height));
    const float y = whole(n.y[n.anchor[body]] / float(r.width));
    if (x == 0 && y == 0) continue;
    n.boxes[2 * body] += x, n.boxes[2 * body + 1] += y;
    const float across = x * float(r.height), along = y * float(r.width);
    each(b.bodies[body].from, b.bodies[body].to, [&](int i, int) __attribute__((always_inline)) {
      store(n.x + i, load(n.x + i) - across), store(n.y + i, load(n.y + i) - along);
    });
  }
}

// Move edge angles to those of the geometry, on the nearest branch, by the share `feedback`.
inline void follow_geometry(const Bodies& b, Nodes& n, float feedback, Range edges) {
  each(edges.from, edges.to, [&](int i, int) __attribute__((always_inline)) {
    const bool adjacent = b.edges.adjacent[i / BLOCK];
    const int32_t *one = &b.edges.first[i], *other = &b.edges.second[i];
    const Vec vx = gather(n.new_x, other, adjacent) - gather(n.new_x, one, adjacent);
    const Vec vy = gather(n.new_y, other, adjacent) - gather(n.new_y, one, adjacent);
    const Vec angle = load(n.angle + i);
    const Vec followed = angle + wrapped(arctangent(vy, vx) - angle);
    store(n.angle + i, feedback == 1 ? followed : angle + feedback * (followed - angle));
  });
}

}  // namespace microcosmos::ISA
