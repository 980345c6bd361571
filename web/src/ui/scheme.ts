/** The colour scheme of the system; a notebook has its own, see widget/scheme.ts. */

export const darkScheme = () => window.matchMedia("(prefers-color-scheme: dark)");
