/** Texts of the comparison of runs, and of creatures side by side. */

export const text = {
  runs: "Runs",
  compare: "Compare",
  bySpec: "Each line style is one spec: runs that differ only in the seed share it.",
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
  sideBySide: "Side by side",
  creatures: "Creatures",
  tooManyCreatures: (limit: number, requested: number) =>
    `At most ${limit} creatures swim side by side. The first ${limit} of ${requested} are shown.`,
  recording: (count: number) =>
    count === 1
      ? "The motion of one of them is being recorded …"
      : `The motion of ${count} is being recorded …`,
  lane: (name: string, lengths: string) => `${name}   ${lengths} body lengths`,
  race: (count: number) =>
    count === 1
      ? "A creature that swims to the right"
      : `${count} creatures that swim to the right, in lanes`,
  raceAbout:
    "All start together on one line, at the same scale. Each repeats its last two recorded strokes; later motion is not simulated. The grid lines are one length of the longest body apart.",
  play: "Play",
  pause: "Pause",
  restart: "From the start",
  pace: "Pace",
  picture: "Picture (PNG)",
  gif: "GIF",
  drawing: (frames: number) => `Frame ${frames} …`,
  film: "Film",
  filming: "Recording …",
  fileName: "creatures",
  fact: "Fact",
  facts: "Facts of the creatures",
  factDifferences: "Differences",
  allFacts: "Show all",
  onlyDifferences: "Show differences",
  commonGenes: "Connections shared with the first",
  of: (some: number, all: number) => `${some} of ${all}`,
  tableOf: (corner: string) => `${corner}s of the runs`,
};
