/** Texts of notes about completed actions, and of refusals. */

export const text = {
  undo: "Undo",
  cancelled: (title: string) => `${title} is cancelled.`,
  tagRemoved: (tag: string) => `Removed the tag ${tag}.`,
  noteRemoved: "Removed the note.",
  inBin: (title: string) => `${title} is in the bin.`,
  chosen: (creatures: number) =>
    `${creatures === 1 ? "1 creature" : `${creatures} creatures`} chosen. The next generations descend from ${creatures === 1 ? "it" : "them"}, too.`,
  readOnly: "Your token is read-only.",
  ownerOnly: (owner: string | null) => `Only ${owner ? `${owner} or an admin` : "an admin"} can change it.`,
  outcomes: { pause: "will pause", resume: "queued again", cancel: "will be cancelled" },
  deleted: "moved to the bin",
  runs: (count: number) => `${count} ${count === 1 ? "run" : "runs"}`,
  outcome: (changed: string, done: string, left: string | null) =>
    `${changed} ${done}${left ? `; ${left} not changed` : ""}.`,
};
