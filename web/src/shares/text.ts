/** Texts of shared pages, the commons and the list of shares. */

export const text = {
  commons: "Commons",
  nothingListed: "Nothing is listed yet",
  nothingListedHint: "Publish a creature or the archive of a run, and choose to list it in the commons.",
  showMore: "Show more",
  archive: (generation: number | null) => `Archive, generation ${generation}`,
  creature: "Creature",
  importTitle: "Import into your own Microcosmos",
  commandCopied: "Command copied.",
  copyCommand: "Copy command",
  importHint:
    "Download the JSON file above and drop it on any page of your Microcosmos, or run this command on its machine. Name, ancestors, licence and credit are imported too, and you can measure the creature again.",
  notShared: "Not shared",
  credit: "Credit",
  licence: "Licence",
  shared: "Shared",
  until: "Until",
  filesAbout: (generation: string, version: string, device: string | null) =>
    `State after generation ${generation}. Computed by version ${version}${device ? ` on ${device}` : ""}.`,
  shares: "Shares",
  nothingShared: "Nothing is shared",
  nothingSharedHint: "Publish a creature on its page, or an archive on the page of its run.",
  published: "Published creatures and archives",
  title: "Title",
  content: "Content",
  publishedOn: "Published",
  expires: "Expires",
  visibleTo: "Visible to",
  actions: "Actions",
  archiveOf: (generation: number | null) => `archive, generation ${generation}`,
  creatureLink: "creature",
  never: "never",
  viewers: (state: string, listed: boolean) => {
    if (state !== "live") return `nobody (${state})`;
    return listed ? "everyone" : "people with the link";
  },
  copyLinkOf: (title: string) => `Copy link of ${title}`,
  linkCopied: "Link copied.",
  copyLink: "Copy link",
  revoke: "Revoke",
  revoked: (title: string) => `${title} is no longer shared.`,
};
