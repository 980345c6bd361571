/** Texts of the form that is generated from a schema. */

export const text = {
  plugin: (name: string, about: string, workers: string) => `${name}: ${about} Plug-in of ${workers}.`,
  each: (range: string) => `Each ${range}`,
  auto: "auto",
  none: "none",
  resetTo: (value: string) => `Reset to ${value}`,
  undoChange: "Undo change",
  json: "Spec as JSON",
  jsonAbout:
    "Edit the spec, or replace it with another spec, a run from the API, or a creature file. Missing fields get their defaults.",
  sections: "Sections of the form",
  errors: (count: number) => `${count} ${count === 1 ? "error" : "errors"}`,
  changed: (count: number) => `${count} changed`,
  general: "General",
  toggle: (open: boolean, title: string) => `${open ? "Close" : "Open"} the section ${title}`,
  remove: (title: string) => `Remove ${title}`,
  addTo: (title: string) => `Add to ${title}`,
  needsNumber: "Needs a number.",
  notANumber: (value: string) => `Needs a number, got “${value}”.`,
  notWhole: (value: number) => `Needs a whole number, got ${value}.`,
  tooLow: (open: boolean | undefined, low: string) => `Needs ${open ? "more than" : "at least"} ${low}.`,
  tooHigh: (open: boolean | undefined, high: string) => `Needs ${open ? "less than" : "at most"} ${high}.`,
  needsNested: "Needs a list of lists, such as [[0, 1], [2, 3]].",
  tooFew: (least: number) => `Needs at least ${least} ${least === 1 ? "number" : "numbers"}.`,
  tooManyNumbers: (most: number) => `Needs at most ${most} numbers.`,
  selectMore: (least: number) => `Select at least ${least}.`,
  partner: (choice: string, selected: string, cause: string) =>
    `The ${choice} is now ${selected}: body-graph and grown need each other, and you selected ${cause}.`,
  low: (open: boolean | undefined, low: string) => `${open ? "more than" : "at least"} ${low}`,
  high: (open: boolean | undefined, high: string) => `${open ? "less than" : "at most"} ${high}`,
  range: (low: string, high: string) => `${low} to ${high}`,
};
