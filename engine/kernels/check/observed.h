// What a rollout observed, for its summary.
#pragma once
#include <algorithm>

#include "../src/rollout.h"
#include "../src/summary.h"

// All but the clock, the scales and the results.
inline microcosmos::Observed observed(const microcosmos::Rollout& r) {
  microcosmos::Observed o = {};
  o.height = r.height, o.width = r.width, o.steps = r.steps, o.nodes = r.nodes;
  o.edges = r.edges, o.joints = r.joints, o.bodies = r.bodies, o.energetic = r.energetic;
  std::copy(r.end_populations, r.end_populations + 9, o.populations);
  o.driven = r.driven, o.varied = r.varied, o.walled = r.walled, o.walls = r.walls;
  o.uniform_force = r.uniform_force, o.force_x = r.force_x, o.force_y = r.force_y;
  o.positions = r.positions, o.angles = r.angles, o.ends = r.ends, o.pairs = r.pairs;
  o.member = r.member, o.present = r.present, o.boxes = r.boxes, o.collected = r.end_collected;
  const bool closed = r.commands != microcosmos::GIVEN;
  o.rest_angle = closed ? r.rest_angle : r.given_angle;
  o.rest_length = closed ? r.rest_length : r.given_length;
  o.centre = r.centre, o.path = r.path, o.speed = r.speed, o.node_speed = r.node_speed;
  o.held = r.held, o.heading = r.heading, o.power = r.power, o.curvature = r.curvature;
  o.force = r.force, o.box = r.box;
  return o;
}
