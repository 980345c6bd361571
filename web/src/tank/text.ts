/** Texts of the tank. */

export const text = {
  label: (count: number) =>
    `Tank with ${count} swimming creatures. Arrow keys point at one after another, Enter opens it.`,
  pause: "Pause the creatures",
  play: "Let the creatures swim",
  fitness: (value: string) => `fitness ${value}`,
  born: (generation: number, run: string) => `generation ${generation} of ${run}`,
  example: "an example that comes with Microcosmos",
  examples: "Until then, examples that come with Microcosmos swim here: open one to play with it.",
  evolves: "evolves",
  progress: (generation: number, generations: number) => `generation ${generation} of ${generations}`,
  rate: (rate: string) => `${rate} evaluations/s`,
  left: (time: string) => `${time} left`,
  more: (count: number) => (count === 1 ? "and 1 other run" : `and ${count} other runs`),
  still: (creatures: number, runs: number) =>
    `The best and the most different ${creatures} creatures of ${runs === 1 ? "one run" : `the latest ${runs} runs`}`,
  nothing: [
    "Nothing of yours swims here yet",
    "A run evolves swimmers, and the best of every kind appear here as they evolve.",
  ],
  begun: {
    running: [
      "The first creatures are being evolved",
      "They appear here as soon as the first generation is done.",
    ],
    queued: ["Nothing of yours swims here yet", "A run waits for a worker."],
  },
};
