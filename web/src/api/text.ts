/** Texts of failed requests. */

export const text = {
  status: (status: number) => `The server answered with status ${status}.`,
  unreachable: "The server cannot be reached. Check that it is running and try again.",
};
