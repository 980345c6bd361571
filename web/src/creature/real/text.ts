/** Texts of a real length and period. */

export const text = {
  length: "Body length",
  period: "Stroke",
  wrongLength:
    "Body length must be a number above 0 with a unit, such as 1 mm or 50 µm, between 1e-12 and 1e6 m.",
  wrongPeriod:
    "Stroke must be a number above 0 with a unit, such as 0.5 s or 20 ms, between 1e-12 and 1e6 s.",
  needsLength: "Give the body length too, such as 1 mm.",
  needsPeriod: "Give the period of a stroke too, such as 0.5 s.",
};
