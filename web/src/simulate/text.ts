/** Texts of the simulator. */

export const text = {
  noNumber: (name: string) => `The inputs have no number ${name}.`,
  wrongArray: (name: string, needed: number, found: number | undefined) =>
    `The array ${name} needs ${needed} items, got ${found ?? "none"}.`,
  refused: (reason: string) => `The simulator refuses the inputs: ${reason}.`,
  otherBody:
    "Its body takes its rest shapes in another way (matched or by constraints), so both cannot be in one water.",
  noSystem: (name: string) => `The simulator failed in ${name}.`,
};
