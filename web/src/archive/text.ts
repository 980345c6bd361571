/** Texts of the archive: map, gallery, slider and tour. */

const keyHelp = (select: boolean) =>
  `Enter opens one${select ? ", Space selects it, Shift with arrows selects several, Escape clears the selection." : "."}`;

const CONTAINERS: Record<string, string> = {
  fronts: "Pareto fronts",
  "dominated-novelty": "dominated novelty",
  learned: "learned axes",
};

/** The title of a container, by its name in the spec. */
export const containerText = (kind: string) => CONTAINERS[kind] ?? kind;

export const text = {
  forkCreature: "Start a new run from this creature",
  archive: "Archive",
  elites: (count: string) => `${count} elites`,
  explain: "Explain",
  map: "Map",
  gallery: "Gallery",
  view: "View of the archive",
  mapLabel: (select: boolean) => `Archive map. Arrow keys move between elites, ${keyHelp(select)}`,
  across: "Across",
  up: "Up",
  voronoi: (cells: string, axes: number) => `${cells} Voronoi cells over ${axes} descriptors`,
  grid: (cells: string, axes: number) =>
    `${cells} cells over ${axes} ${axes === 1 ? "descriptor" : "descriptors"}`,
  places: (places: string, container: string) => `${places} places, ${container}`,
  binElites: "Elites at this position",
  creaturesShown: "Creatures",
  verdict: "Audit",
  anyVerdict: "any verdict",
  presentElites: "Present elites",
  allEntered: "All that ever entered",
  component: (number: string, share: string | null) =>
    `Principal component ${number}${share === null ? "" : ` (${share} of the variance)`}`,
  filled: (elites: string, cells: string, coverage: string, score: string) =>
    `${elites} of ${cells} cells (${coverage}), QD score ${score}`,
  reprojected: (creatures: string, all: string, present: string) =>
    `All ${creatures} creatures that ever entered fill ${all}. The present elites alone fill ${present}.`,
  tooManyNamed: (most: string) => `Select at most ${most} creatures to start a new run from them.`,
  legend: (label: string, low: unknown, high: unknown) => `${label} from ${low} to ${high}`,
  colour: "Colour",
  palette: "Palette",
  more: "More",
  simulating: "Simulating …",
  inset: "The elite of this cell, swimming",
  fitness: "Fitness",
  generation: "Generation",
  open: "Open",
  bestOf: "best of",
  oneOf: "one of",
  here: "at this position",
  tileSize: "Tile size",
  galleryLabel: (select: boolean) => `Gallery. Arrow keys move between creatures, ${keyHelp(select)}`,
  galleryHint: "Point at a creature to read its measures. Click it to open it.",
  select: "Select",
  creatures: (count: string, generation: string | null) =>
    `${count} ${count === "1" ? "creature" : "creatures"}${generation === null ? "" : ` of generation ${generation}`}`,
  selected: (creatures: string) => `${creatures} selected`,
  fork: (creatures: number) =>
    `Start a new run from ${creatures === 1 ? "this creature" : "these creatures"}`,
  sideBySide: "Side by side",
  clearSelection: "Clear selection",
  sliceFrom: (axis: string) => `${axis}, from`,
  sliceTo: (axis: string) => `${axis}, to`,
  wholeRange: "full range",
  range: (low: string, high: string, unit: string) => `${low} to ${high} ${unit}`,
  age: "Age",
  mapHint: (select: boolean) =>
    `Point at a cell to see its creature swim. Click it to open it.${select ? " Drag across cells, or around them, to select them." : ""}`,
};
