/** Texts of a run of gaits. */

export const text = {
  title: "Displacement against viscosity",
  form: "Coupling",
  sideBySide: "Side by side",
  plot: (form: string) => `Displacement against viscosity, ${form}`,
  marks: "Click a mark to open its creature.",
  doubtful: "warning, or limits active",
  unfinished: "did not finish",
  replay: "Replay of the mark",
  pointAtMark: "Point at a mark, or focus it, to see its swimmer here.",
  simulating: "Simulating …",
  swimming: (name: string | undefined) => `${name}, swimming`,
  openCreature: "Open creature",
  viscosity: "Viscosity (cells²/step)",
  displacement: "Displacement (cells/cycle)",
  limited: (share: string) => `limits active in ${share} of node steps`,
  cellsPerCycle: (cells: string) => `${cells} cells per cycle`,
  reynolds: (value: string) => `Reynolds number ${value}`,
  mark: (swimmer: string, viscosity: string) => `${swimmer} at ν = ${viscosity}`,
  reynoldsOf: (swimmer: string) => `Reynolds number of the ${swimmer}`,
};
