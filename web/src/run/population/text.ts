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
  generation: (generation: number | undefined) => `generation ${generation}`,
};
