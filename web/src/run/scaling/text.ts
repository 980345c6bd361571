/** Texts of measurements of wall time. */

export const text = {
  wallTime: "Wall time",
  wallTimePlot: "Wall time of 1,000 steps against the number of nodes",
  seconds: "Seconds for 1,000 steps",
  memory: "Memory",
  memoryPlot: "Memory against the number of nodes",
  allParts: "all parts",
  allPairs: "all-pairs repulsion",
  secondsFor: (seconds: string) => `${seconds} s for 1,000 steps`,
  nodesOf: (count: string) => `${count} nodes`,
  nodes: "Nodes",
};
