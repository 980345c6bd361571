/** Texts of the archive: map, gallery, slider and tour. */

const keyHelp = (select: boolean) =>
  `Enter opens one${select ? ", Space selects it, Shift with arrows selects several, Escape clears the selection." : "."}`;

const CONTAINERS: Record<string, string> = {
  fronts: "Pareto fronts",
  "dominated-novelty": "dominated novelty",
  learned: "learned axes",
};

/** What a container keeps, by the spec's word. */
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
  tourBest: "The best of every kind",
  tourBestAbout: (elites: string, cells: string) =>
    `This run does not search for a single champion. It keeps the best swimmer of every kind: ${elites} of ${cells} kinds have one so far.`,
  tourPlacesAbout: (elites: string, container: string) =>
    `This run does not search for a single champion. It keeps many different swimmers (${container}): ${elites} so far.`,
  tourPositions: "Positions are kinds",
  tourPositionsAbout: (x: string, y: string) =>
    `${x} increases to the right, ${y} upwards. A position shows its fittest swimmer; click it to list the others.`,
  tourKind: "Cells are kinds",
  tourKindAbout: (x: string, y: string) =>
    `Each cell is one kind of swimmer: ${x} increases to the right, ${y} upwards. A new swimmer takes a cell only if it is fitter than its current elite.`,
  tourColour: "Colour is fitness",
  tourColourAbout: (measure: string, generation: number, fitness: string) =>
    `The colour shows ${measure}. The fittest swimmer is marked: it appeared in generation ${generation} and has fitness ${fitness}. Point at any other cell to see its swimmer move.`,
  tourNoColour: "The colour will show the fitness of each swimmer. The first swimmers are being simulated.",
  tourLive: "The archive is live",
  tourHistory: "The history",
  tourLiveAbout:
    "A cell flashes when a better swimmer takes it. The slider shows any earlier generation; the button beside it plays the history.",
  tourHistoryAbout: (generations: string) =>
    `The slider shows any of the ${generations} generations; the button beside it plays the history.`,
  tourOpen: "Open a creature",
  tourOpenAbout:
    "Click a cell to open its creature: replay, network and parents. The gallery shows all creatures moving at once.",
  mapHint: (select: boolean) =>
    `Point at a cell to see its creature swim. Click it to open it.${select ? " Drag across cells, or around them, to select them." : ""}`,
};
