/** Styles in pixels: Preact adds no unit to a number. */
export const px = (sizes: Record<string, number>) =>
  Object.fromEntries(Object.entries(sizes).map(([name, value]) => [name, `${value}px`]));
