/** Texts of the spec of a run. */

export const text = {
  spec: "Spec",
  compareSpec: "Compare specs",
  copied: "Spec copied.",
  copyJson: "Copy JSON",
  json: "JSON",
  preset: "preset:",
  changes: (count: number, preset: string) =>
    count === 0
      ? `Same as preset ${preset}, apart from the seed.`
      : `${count} ${count === 1 ? "field differs" : "fields differ"} from preset ${preset}; ${count === 1 ? "it is" : "they are"} highlighted below.`,
  difference: "Differences from another run",
  loading: "Loading the other run …",
  noDifference: "No field differs from ",
  differences: (count: number) => `${count} ${count === 1 ? "field differs" : "fields differ"} from `,
  field: "Field",
  thisRun: "This run",
  otherRun: "Other run",
  close: "Close differences",
  run: "Run",
  none: "none",
  yes: "yes",
  no: "no",
};
