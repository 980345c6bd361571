// What a rollout of one world takes and returns: plain arrays, the same for every caller.
#pragma once
#include <cstdint>

namespace microcosmos {

enum Projection { NOTHING, FORCE, FORCE_AND_TORQUE };
enum Delta { PESKIN, ROMA, HAT };

// Parts of a step whose time can be taken.
enum Part {
  WINDOWS,
  MOMENTS,
  INTERPOLATION,
  CONSTRAINTS,
  FORCING,
  SPREADING,
  MEASURES,
  FLUID,
  PART_COUNT
};

struct Rollout {
  // The world, (height, width) cells; nodes, edges and joints of all bodies.
  int32_t height, width, steps, nodes, edges, joints, bodies;
  int32_t iterations, sweeps, layers;
  Projection projection;
  Delta delta;
  bool matched;  // Shape matching; otherwise sweeps.
  bool timed;    // Take the time of each part.
  float force_factor, theta_feedback;

  // Relaxation rates (even, odd), limits of displacement and force, step lengths of the forcing.
  const float* parameters;
  const float* populations[9];  // (height, width) each
  const float* positions;       // (node, 2)
  const float* angles;          // (edge)
  const float* rest_angle;      // (step, joint)
  const float* rest_length;     // (step, edge)

  const int32_t* ends;     // (edge, 2) nodes
  const int32_t* pairs;    // (joint, 2) edges
  const int32_t* member;   // (node) body
  const int32_t* piece;    // (node) connected piece, from 0
  const int32_t* present;  // (node) 1, or 0 for nodes that have not grown
  // Layout of the unchanged body, for shape matching.
  const float* layout_angle;       // (edge)
  const float* layout_rest_angle;  // (joint)
  const float* turned;             // (edge, joint)
  const float* placed;             // (node, edge)
  // For sweeps: the colour of each constraint, and stiffnesses, 0 to 1.
  const int32_t *edge_colour, *joint_colour;
  const float *stretch, *shear, *bend;

  // The end; the planes may be those of the start.
  float* end_populations[9];
  float *end_positions, *end_angles;
  // Observed in each step, see `world.Measures`.
  float* centre;      // (step, 2)
  float* path;        // (step, node, 2)
  float* speed;       // (step)
  float* node_speed;  // (step)
  float* held;        // (step)
  float* heading;     // (step)
  float* curvature;   // (step, joint)
  float* power;       // (step)
  float* force;       // (step, body, 2)

  float* seconds;  // (PART_COUNT) time spent, if `timed`
};

}  // namespace microcosmos
