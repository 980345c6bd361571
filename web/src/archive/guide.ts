/** What an archive is, told on the one that is shown; and whether somebody was told before. */

import { useState } from "preact/hooks";
import type { Archive, Run } from "../api/types";
import { count, number } from "../ui/format";
import type { Step } from "../ui/Guide";
import type { ArchiveView } from "./archiveView";

const STORAGE_KEY = "microcosmos:guided";

/** Storage may be forbidden: then the guide is offered again. */
export function wasGuided(): boolean {
  try {
    return localStorage.getItem(STORAGE_KEY) !== null;
  } catch {
    return false;
  }
}

function rememberGuided(): void {
  try {
    localStorage.setItem(STORAGE_KEY, "1");
  } catch {
    // It will be offered again.
  }
}

/** Open on a first visit, and whenever it is asked for. */
export function useGuide() {
  const [open, setOpen] = useState(() => !wasGuided());
  const [asked, setAsked] = useState(false);
  const begin = () => {
    setAsked(true);
    setOpen(true);
  };
  const end = () => {
    rememberGuided();
    setOpen(false);
  };
  return { open, asked, begin, end };
}

export function stepsOf(run: Run, archive: Archive, { axes, elites, colouring }: ArchiveView): Step[] {
  const best = bestOf({ elites });
  const [x, y] = axes.map(({ title }) => title.toLowerCase());
  const running = run.status === "running" || run.status === "queued";
  return [
    {
      title: "The best of every kind",
      text:
        "This run does not look for one champion. It keeps the best swimmer of every kind that it " +
        `meets: ${count(elites.size)} of ${count(archive.cells)} kinds have one so far.`,
      about: "map",
    },
    {
      title: "What a kind is",
      text: `Each cell is a kind of swimmer: to the right with more ${x}, upwards with more ${y}. A newcomer takes a cell only if it is fitter than whoever holds it.`,
      about: "axes",
    },
    {
      title: "How good they are",
      text: best
        ? `The colour is ${colouring.measure.title.toLowerCase()}. The fittest swimmer is marked: it came in generation ${best.generation} with fitness ${number(best.fitness)}. Point at any other cell to see its swimmer move.`
        : "The colour will tell how fit a swimmer is. The first ones are being simulated.",
      about: "legend",
    },
    {
      title: running ? "It is alive" : "How it came to be",
      text: running
        ? "Cells flash when a better swimmer takes them. The slider goes back to any generation; the button beside it plays the history."
        : `The slider goes back to any of the ${count(run.generation)} generations; the button beside it plays the history.`,
      about: "time",
    },
    {
      title: "Look closer",
      text: "Click a cell to open its creature: its replay, its network, its parents. The gallery shows all of them moving at once.",
      about: "views",
    },
  ];
}

/** The fittest of all that are shown, and its cell. */
export function bestOf({ elites }: Pick<ArchiveView, "elites">) {
  let best: { cell: number; fitness: number; generation: number } | null = null;
  for (const [cell, { fitness, generation }] of elites) {
    if (best === null || fitness > best.fitness) best = { cell, fitness, generation };
  }
  return best;
}
