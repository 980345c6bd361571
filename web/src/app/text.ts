/** Texts of the frame around every page. */

export const text = {
  titles: {
    runs: "Runs",
    new: "New run",
    compare: "Compare",
    workers: "Workers",
    shares: "Shares",
    settings: "Settings",
    import: "Import",
    unknown: "Not found",
  },
  commons: "Commons",
  help: "Help",
  signIn: "Sign in",
  brand: "Microcosmos",
  pages: "Pages",
  noSuchPage: "Page not found",
  noSuchPageAbout: "No page has this address.",
  allRuns: "Show all runs",
  connections: { connecting: "Connecting …", live: "Live", lost: "Connection lost; trying again" },
  dismiss: "Dismiss",
  notShared: "Not shared",
  notSharedAbout: "Nothing is shared at this address.",
};
