/** Texts of the list of keys. */

export const text = {
  shortcuts: "Keyboard shortcuts",
  close: "Close",
  /** The action of each key, by part of the page. */
  keys: {
    Everywhere: {
      "?": "Show or hide this list",
      "/": "Search",
      n: "Start a new run",
      "Ctrl Z": "Undo the last action while its note is shown",
      Esc: "Close what is open",
    },
    Tank: { "← → ↑ ↓": "Point at the previous or next creature", Enter: "Open it" },
    "Map and gallery of an archive": {
      "← → ↑ ↓": "Go to the next creature in this direction",
      Enter: "Open it",
      Space: "Select or deselect it",
      "Shift ← → ↑ ↓": "Extend the selection",
      Esc: "Clear the selection",
    },
    Replay: {
      Space: "Play or pause",
      "← →": "Previous or next frame",
      "Home End": "To the first or last frame",
    },
    "Tree of life": {
      "←": "To the parent",
      "→": "To the first child",
      "↑ ↓": "To the creature beside",
      "+ − 0": "Zoom in, out, show all",
      Enter: "Open it",
    },
  },
};
