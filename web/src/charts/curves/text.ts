/** Texts of curves. */

export const text = {
  none: "none",
  window: (size: number) => `over ${size}`,
  axis: "X axis",
  smooth: "Smoothing",
  options: "Curve options",
  logScale: "Log scale",
  noneAboveZero: "No value is above zero, so the log scale shows nothing.",
  noValues: "No values yet.",
  reevaluated: "re-evaluated",
  asFound: "as found",
  qdScore: "QD score",
  coverage: "Coverage",
  bestFitness: "Best fitness",
  inserted: "Into empty cells",
  improved: "Improvements",
  hitRate: "Re-evaluations in the same cell",
  deviceSeconds: "Device-seconds",
  diverged: "Diverged so far",
  nonFinite: "A number became infinite or undefined.",
  supersonic: "The fluid exceeded the speed of sound, where the method is invalid.",
};
