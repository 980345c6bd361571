/** Texts of tables of results. */

export const text = {
  replay: "Replay",
  yes: "yes",
  no: "no",
  ofNodeSteps: "of node steps",
  latticeUnits: "lattice units",
  /** Titles of columns whose names are unclear. */
  titles: {
    impulse: "Net impulse",
    force_free: "Force-free",
    steps: "Timed steps",
    seconds: "Total",
    first: "First loss",
    last: "Last loss",
    least: "Lowest loss",
    empty: "Loss without filament",
    failed: "Failed updates",
    slope: "Gradient norm",
    agreement: "Actual / predicted gain",
    memory_bytes: "Memory",
  },
  missing: {
    queued: "Waiting for a worker.",
    running: "Computing the first results …",
    paused: "Paused before the first results.",
    finished: "No results.",
    failed: "Failed before the first results.",
    cancelled: "Cancelled before the first results.",
  },
  loading: "Loading results …",
  table: "Table",
  rows: (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "row" : "rows"}`,
  download: "Download CSV",
};
