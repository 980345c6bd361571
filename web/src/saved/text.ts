/** Texts of a saved page. */

export const text = {
  motion: "Recorded motion",
  credit: "Credit",
  licence: "Licence",
  fitness: "Fitness",
  source: "Source",
  about: "About this file",
  aboutText:
    "An evolved swimmer of Microcosmos with the vorticity of the fluid around it. The file holds its recorded motion, the inputs of its evaluation and the simulator. It needs no network and sends nothing.",
};
