// Places of the measures, written by `python -m microcosmos.measures index`.
#pragma once

namespace microcosmos {

enum Measure {
  DISPLACEMENT,
  BENDING_EFFORT,
  STRETCHING_EFFORT,
  PATH_LENGTH,
  STRAIGHTNESS,
  ROTATION,
  ENERGY,
  MACH,
  LIMITED,
  REYNOLDS,
  MEAN_SPEED,
  TURNING,
  CURVATURE_MEAN,
  CURVATURE_SPREAD,
  SYMMETRY,
  POWER,
  EFFICIENCY,
  NODES,
  SPEED,
  STRIDE,
  IMPULSE,
  COST_OF_TRANSPORT,
  BEATS,
  WAVE_NUMBER,
  WAVE_DIRECTION,
  HEADING_ANGLE,
  ASPECT,
  STROUHAL,
  ADVANCE,
  MEASURE_COUNT
};

}  // namespace microcosmos
