/** Texts of failed requests. */

export const text = {
  status: (status: number) => `The server answered with status ${status}.`,
  unreachable: "The server cannot be reached. Check that it is running and try again.",
  tooLarge: (most: number) => `The file is too large: a shared creature has at most ${most} bytes.`,
  noShare: "The server sent no creature of Microcosmos.",
  otherCreature: (found: string, wanted: string) => `The server sent creature ${found} instead of ${wanted}.`,
  wrongHash: (stated: string, found: string) =>
    `The file states the SHA-256 ${stated}, but its creature has ${found}: it was changed, and is not imported.`,
};
