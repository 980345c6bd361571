/** Texts of species and of the best network. */

export const text = {
  species: "Species over time",
  noSpeciesYet: "Species appear after the first generation.",
  noSpecies: "This search has no species.",
  bestNetwork: "Best network so far",
  bestOf: (fitness: string, generation: number) => `fitness ${fitness}, generation ${generation},`,
  noBest: "The best network appears after the first generation.",
  noNetwork: "The creature has numeric genes and no network to draw.",
  plot: (summary: string) => `Species over generations: ${summary}. Arrow keys move through the generations.`,
  generation: "Generation",
  members: "Creatures",
  summary: (living: number, generation: number, all: string, size: string) =>
    `${living} ${living === 1 ? "species lives" : "species live"} in generation ${generation}, ${all} in all; a population of ${size}`,
  oneSpecies: (generation: number, species: number, size: string, living: number) =>
    `Generation ${generation}: species ${species}, ${size} members, of ${living} species`,
  sizeOf: (species: number, size: string) => `species ${species} ${size}`,
  allSpecies: (generation: number, living: number, sizes: string) =>
    `Generation ${generation}: ${living} species; largest: ${sizes}`,
};
