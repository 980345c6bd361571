/** Texts of the tour of an archive. */

export const text = {
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
};
