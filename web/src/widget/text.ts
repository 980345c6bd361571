/** Texts of the widgets for notebooks. */

export const text = {
  across: "Across",
  up: "Up",
  colour: "Colour",
  hint: "Point at a cell to see its creature swim. Click it to select it; drag across cells, or around them, to select several.",
  run: "notebook",
  strokes: "The last strokes of a creature",
  selected: (cells: number) => `${cells} ${cells === 1 ? "cell" : "cells"} selected`,
};
