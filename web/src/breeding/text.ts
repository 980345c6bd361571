/** Texts of breeding by eye. */

export const text = {
  breed: (creatures: number) => `Breed from ${creatures === 1 ? "this" : "these"}`,
  breedAbout: "Let a part of the next generations descend from the chosen",
  tooMany: (most: number) => `Choose at most ${most} creatures for one generation.`,
  chosen: "Chosen to breed",
  about: (share: string, halfLife: string) =>
    `${share} of the next generation descends from the chosen. This share halves every ${halfLife} generations.`,
  now: (children: number, batch: string) =>
    `${children} of the last ${batch} offspring ${children === 1 ? "descends" : "descend"} from them.`,
  next: "From the next generation on",
  from: (generation: string) => `From generation ${generation} on`,
  takeBack: "Take back",
  takeBackChoice: "Take back the choice",
  takeBackAll: (creatures: number) =>
    creatures === 1 ? "Take back the chosen creature" : `Take back the ${creatures} chosen creatures`,
  creature: (name: string) => `Creature ${name}`,
};
