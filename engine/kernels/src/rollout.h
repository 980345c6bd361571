// The operands and results of a rollout of one world: plain arrays, the same for every caller.
#pragma once
#include <cstdint>

namespace microcosmos {

enum Projection { NOTHING, FORCE, FORCE_AND_TORQUE };
enum Delta { PESKIN, ROMA, HAT };
// Sources of rest shapes: the caller gives them, or a controller commands them.
enum Commands { GIVEN, NETWORK, SERIES };

// Parts of a step whose time can be taken, in the order of `world.native.PARTS`.
enum Part {
  CONTROL,
  REPELLING,
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

// Places of `parameters`; the step lengths of the forcing follow.
// None: an infinite NU_C, an ENERGY_RATE below 0, a DIFFUSION of 0.
enum Parameter {
  VISCOSITY,
  NU_C,
  ENERGY_RATE,
  DIFFUSION,
  DISPLACEMENT_LIMIT,
  FORCE_LIMIT,
  FORCE_FACTOR,
  THETA_FEEDBACK,
  REPULSION,
  REPULSION_LIMIT,
  BARRIER_LIMIT,
  STEP_LENGTHS
};
// Places of `control`; a bound of 0 is none.
enum Bound { ANGLE_SCALE, LENGTH_SCALE, PHASE, MAX_SPEED, LAG_SHARE, MAX_BEND, BOUND_COUNT };
// Places of `rations`.
enum Ration { BITE, REGROWTH, DECAY, FOOD_DIFFUSION, UNIT, FULL, RATION_COUNT };
// The bounds of a slot's creature, with the steps of a stroke and those in which it grows.
enum Actuation { PERIOD = BOUND_COUNT, RAMP, ACTUATION_COUNT };
// What nodes sense, as sums of these; whole evaluations know the energy alone. The order is that
// of `world.senses`.
enum Sense {
  SENSED_ENERGY = 1,
  SENSED_ENERGY_ACROSS = 2,
  SENSED_ENERGY_ALONG = 4,
  SENSED_FLOW_ALONG = 8,
  SENSED_FLOW_ACROSS = 16,
  SENSED_TOUCH = 32,
  SENSED_ACCOUNT = 64
};
constexpr int32_t ALL_SENSES = 127;
inline int count_of(int32_t senses) { return __builtin_popcount(uint32_t(senses)); }

struct Rollout {
  // The world, (height, width) cells; nodes, edges and joints of all bodies.
  int32_t height, width, steps, nodes, edges, joints, bodies;
  int32_t iterations, sweeps, layers;
  int32_t threads;  // At most; results do not depend on them.
  Projection projection;
  Delta delta;
  bool fixed_magic;  // Lambda = 3/16 at every viscosity; otherwise capped.
  bool fluid;        // Without a fluid, only constraints move bodies.
  bool repelled;     // Nodes repel each other.
  bool paired;       // They do so pair by pair where bodies meet; otherwise on the lattice.
  bool energetic;    // There is energy.
  bool driven;       // A uniform force acts on the fluid.
  bool varied;       // A force that differs from cell to cell acts on the fluid.
  bool walled;       // There are walls.
  bool barred;       // Solid cells keep bodies out.
  bool damped;       // There is a sponge.
  bool matched;      // Shape matching; otherwise sweeps.
  bool soft;         // Of matched shapes: joints turn only by the share `bend` of their error.
  bool laid_out;     // There is a layout.
  bool observed;     // Otherwise one rest shape is for all steps, and nothing is recorded of them.
  bool timed;        // Take the time of each part.

  const float* parameters;
  const float* populations[9];  // (height, width) each
  const float* positions;       // (node, 2)
  const float* angles;          // (edge)
  const float* boxes;           // (body, 2) whole boxes before the one that positions count from
  const float* energy;          // (height, width)
  const float* collected;       // (node)

  // Food in quanta, see `fields.food`.
  bool fed, carried;
  int32_t food_every;       // Steps.
  const int32_t* food;      // (height, width)
  const int32_t* capacity;  // (height, width)
  const float* rations;     // (RATION_COUNT)
  const int32_t* time;      // (1) steps since the start
  int32_t *end_food, *end_time;
  int32_t *grown, *lost;  // (height, 2) quanta of each row: 4096 times the first, and the second

  // Weights along each axis that smooth the density of nodes: of smoothing, then of the slope.
  const float* smoothing_x;  // (2, height)
  const float* smoothing_y;  // (2, width)

  // Surroundings of the fluid.
  const float* uniform_force;      // (2)
  const float *force_x, *force_y;  // (height, width)
  const int32_t* walls;            // (height, width) 1 in walls
  const float *away_x, *away_y;    // (height, width) displacement of nodes, away from solid cells
  const float* sponge;             // (height, width) strength
  const float* sponge_velocity;    // (2)

  const int32_t* ends;     // (edge, 2) nodes
  const int32_t* pairs;    // (joint, 2) edges
  const int32_t* member;   // (node) body
  const int32_t* piece;    // (node) connected piece, from 0
  const int32_t* present;  // (node) 1, or 0 for nodes that have not grown
  // Layout of the unchanged body, for shape matching and actuators.
  const float* layout_angle;       // (edge)
  const float* layout_rest_angle;  // (joint)
  const int32_t* bends;            // (joint) 1, or 0 for joints that have not grown
  // For sweeps: the colour of each constraint, and stiffnesses, 0 to 1.
  const int32_t *edge_colour, *joint_colour;
  const float* whole;  // (joint) For sweeps: whole turns around its ring, in rad.
  const float *stretch, *shear, *bend;

  // The controller, see `world.controller`.
  Commands commands;
  bool recurrent, waves, actuated;
  int32_t senses;  // See `Sense`.
  int32_t rows, links, inputs, sites, timers, terms;
  const float* given_angle;        // (step, joint)
  const float* given_length;       // (step, edge)
  const float* control;            // (BOUND_COUNT)
  const int32_t* activation;       // (row) -1: an input, or no node
  const float* bias;               // (row)
  const int32_t *source, *target;  // (link) rows; -1: no link
  const float* weight;             // (link)
  const float* timer;              // (step, timers)
  const float* ramp;               // (step)
  const float* site;               // (sites, node)
  const float* lag;                // (node) rad
  const int32_t* joint_node;       // (joint)
  const float* gain;               // (joint) factor on the angle that a network commands
  const float* body_angle;         // (joint)
  const float* body_length;        // (edge)
  const float* basis;              // (step, terms)
  const float* genes;              // (terms, joint and edge)

  // The end; the planes may be those of the start.
  float* end_populations[9];
  float *end_positions, *end_angles, *end_boxes, *end_energy, *end_collected;
  // Rest shapes, and the controller's time at the end of each step.
  float* rest_angle;   // (step, joint)
  float* rest_length;  // (step, edge)
  float* clock;        // (step)
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
  float* box;         // (step, body, 2)

  float* seconds;  // (PART_COUNT) time spent, if `timed`
  float* memory;   // Bytes of all worlds that the process simulates at the end, if `timed`
};

}  // namespace microcosmos
