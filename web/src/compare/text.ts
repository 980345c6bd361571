/** Texts of the comparison of runs. */

export const text = {
  runs: "Runs",
  compare: "Compare",
  tooMany: (limit: number, requested: number) =>
    `At most ${limit} runs can be compared. The first ${limit} of ${requested} are shown.`,
  nothingSelected: "No runs selected",
  nothingSelectedHint: "Select two or more runs in the list of runs, then press Compare.",
  showRuns: "Show all runs",
  curves: "Curves",
  remove: (name: string) => `Remove ${name}`,
  generations: "Generations",
  evaluations: "Evaluations",
  infeasible: "Infeasible",
  evaluationsPerSecond: "Evaluations/s",
  time: "Time",
  left: (duration: string) => `${duration} left`,
  device: "Device",
  figures: "Figures",
  figure: "Figure",
  differences: "Differences of the specs",
  noDifferences: "All specs are the same.",
  field: "Field",
  tableOf: (corner: string) => `${corner}s of the runs`,
};
