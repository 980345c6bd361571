/** Texts of the simulator. */

export const text = {
  noMemory: (bytes: number) =>
    `The simulation needs more memory than a browser gives: there is no room for another ${(bytes / 2 ** 20).toFixed(0)} MiB.`,
  noNumber: (name: string) => `The inputs have no number ${name}.`,
  wrongArray: (name: string, needed: number, found: number | undefined) =>
    `The array ${name} needs ${needed} items, got ${found ?? "none"}.`,
  refused: (reason: string) => `The simulator refuses the inputs: ${reason}.`,
  noKernel: (status: number) =>
    `The simulator cannot be loaded (HTTP ${status}). Reload the page, then try again.`,
  tooLarge: (needed: number, side: number) =>
    `Its body needs water of at least ${needed} cells along each side; the shortest has ${side}.`,
  diverged: "Its own simulation diverged.",
  noRoom: "Walls and obstacles leave no room for its body.",
  otherBody:
    "Its body takes its rest shapes in another way (matched or by constraints), so both cannot be in one water.",
  noSystem: (name: string) => `The simulator failed in ${name}.`,
};
