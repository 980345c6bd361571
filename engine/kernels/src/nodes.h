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

  Nodes(const Bodies& b, const Rollout& r) {
    for (Floats* one : {&x, &y, &new_x, &new_y, &here}) *one = Floats(b.node_slots + 2 * BLOCK);
    angle = Floats(b.edge_slots + 2 * BLOCK);
    for (int n = 0; n < r.nodes; n++) here[b.node_slot[n]] = float(r.present[n]);
  }
};

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
