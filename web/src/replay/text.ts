/** Texts of replays. */

export const text = {
  speed: "Speed",
  fields: { vorticity: "Vorticity", speed: "Speed", energy: "Energy", none: "None" },
  field: "Field",
  tracers: "Tracers",
  follow: "Follow",
  legend: (title: string, low: unknown, high: unknown, unit: string) =>
    `${title} from ${low} to ${high} ${unit}`,
  player: "Replay player",
  frameBack: "Previous frame",
  pause: "Pause",
  play: "Play",
  frameForward: "Next frame",
  homeEnd: "Home and End go to the first and the last frame",
  stage: (field: string | null, tracing: boolean) =>
    `The swimming creature; ${field ? `colours show the ${field.toLowerCase()} of the fluid` : "no field is shown"}${tracing ? ", tracers show its flow" : ""}.`,
  moment: "Time in the replay",
  step: (step: number, steps: number) => `step ${step} of ${steps}`,
  retrying: (note: string) => `${note} Trying again …`,
  firstReplay: "The first replay takes longest.",
  density: "density",
  history: {
    play: "Play the history",
    pause: "Pause the history",
    shown: "Generation shown",
    newestOf: (shown: number) => `newest, ${shown}`,
    generationOf: (shown: number, last: number) => `${shown} of ${last}`,
    loading: "Loading …",
    moment: (generation: string) => `generation ${generation}`,
    newest: "Newest",
  },
  addCreature: "Name or address of a creature",
  addCreatureHint: "Paste a creature's name or address",
  add: "Add",
  addNamed: (name: string, fitness: string) => `Add ${name}, fitness ${fitness}`,
  suggested: "Add one of the latest runs",
};
