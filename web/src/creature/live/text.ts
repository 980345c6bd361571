/** Texts of live water. */

export const text = {
  title: "Live water",
  start: "Swim on",
  stop: "Stop",
  about:
    "The creature swims on in this browser, with its last strokes again and again. Change the viscosity, push the water, pull the body, and let others join.",
  label: "The creature swims in live water; a pressed pointer pushes the water, or pulls the body",
  notCovered: (reason: string) =>
    `The native kernel does not cover ${reason}, so the creature cannot swim on in this browser.`,
  diverged: "The simulation diverged. Start it again with a higher viscosity or weaker pushes.",
  viscosity: (value: string) => `Viscosity ${value}`,
  strokeSpeed: (value: string) => `Stroke ${value} ×`,
  dye: "Dye",
  push: "Push the water",
  pull: "Pull the body",
  others: "Let others join",
  joining: (name: string) => `${name} is prepared …`,
  joined: (name: string) => `${name} swims too.`,
  uncovered: (name: string, reason: string) =>
    `${name} cannot join: the native kernel does not cover ${reason}.`,
  refused: (name: string, reason: string) => `${name} cannot join. ${reason}`,
};
