/** Texts of publishing. */

export const text = {
  publish: "Publish",
  /** Texts that a publisher may give; the page of the share shows those that are no heading. */
  fields: [
    { name: "title", label: "Title", hint: "Title of the shared page", longest: 200, heading: true },
  ] as const,
  licences: {
    "CC-BY-4.0": "CC BY 4.0: attribution",
    "CC-BY-SA-4.0": "CC BY-SA 4.0: attribution, share alike",
    "CC-BY-NC-4.0": "CC BY-NC 4.0: attribution, non-commercial",
    "CC0-1.0": "CC0: no conditions",
  },
  /** By days, or by another way to give the end. */
  terms: [
    ["never", "Never"],
    ["1", "In a day"],
    ["7", "In a week"],
    ["30", "In a month"],
    ["date", "On a date …"],
  ] as const,
  licenceOfAll: "Licence of its creatures",
  licenceOfFile: (licence: string) => `${licence}: from the file`,
  about: (run: boolean) =>
    `Anyone with the link can see ${run ? "the current state of this archive" : "this creature"} and its ancestors without a token, and nothing else. You can revoke the link at any time.`,
  credit: "Credit",
  creditHint: "Names, separated by commas",
  creditOfFile: (names: string) => `The file already credits ${names}; this credit is kept.`,
  licence: "Licence",
  expires: "Expires",
  expiryDate: "Expiry date",
  list: "List in the commons, where everyone can find it",
  publishing: "Publishing …",
  cancel: "Cancel",
  published: "Published",
  link: "Link",
  linkCopied: "Link copied.",
  copyLink: "Copy link",
  open: "Open",
  allShares: "All shares",
  done: "Done",
  unreachable: "Nobody else can open a link to this machine. Start the server where others reach it, with",
  unreachableHow: " set to its address, such as https://swim.example.org.",
};
