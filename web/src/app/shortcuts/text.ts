/** Texts of the list of keys. */

export const text = {
  shortcuts: "Keyboard shortcuts",
  close: "Close",
  keys: [
    [
      "Everywhere",
      [
        ["?", "Show or hide this list"],
        ["/", "Search"],
        ["n", "Start a new run"],
        ["Ctrl Z", "Undo what a note at the bottom offers to undo"],
        ["Esc", "Close what is open"],
      ],
    ],
    [
      "Tank",
      [
        ["← → ↑ ↓", "Point at the creature before or after"],
        ["Enter", "Open it"],
      ],
    ],
    [
      "Map and gallery of an archive",
      [
        ["← → ↑ ↓", "Go to the next creature in this direction"],
        ["Enter", "Open it"],
        ["Space", "Select it, or no longer"],
        ["Shift ← → ↑ ↓", "Select on the way"],
        ["Esc", "Clear the selection"],
      ],
    ],
    [
      "Replay",
      [
        ["Space", "Play or pause"],
        ["← →", "One frame back or on"],
        ["Home End", "To the first or last frame"],
      ],
    ],
    [
      "Tree of life",
      [
        ["←", "To the parent"],
        ["→", "To the first child"],
        ["↑ ↓", "To the creature beside"],
        ["+ − 0", "Zoom in, out, show all"],
        ["Enter", "Open it"],
      ],
    ],
  ] as [where: string, keys: [key: string, does: string][]][],
};
