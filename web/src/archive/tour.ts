/** The tour of an archive. */

import { useState } from "preact/hooks";
import type { Archive, Run } from "../api/types";
import { fittest } from "../store/elites";
import { count, number } from "../ui/format";
import type { Step } from "../ui/Tour";
import type { ArchiveView } from "./archiveView";
import { text } from "./text";

const STORAGE_KEY = "microcosmos:tour-taken";

/** True if this browser has shown the tour; false if it forbids storage. */
export function hasTakenTour(): boolean {
  try {
    return localStorage.getItem(STORAGE_KEY) !== null;
  } catch {
    return false;
  }
}

function rememberTour(): void {
  try {
    localStorage.setItem(STORAGE_KEY, "1");
  } catch {
    // The tour is offered again.
  }
}

/** The tour opens by itself over the demonstration only. */
export const opensByItself = (run: Pick<Run, "demonstration">) => run.demonstration && !hasTakenTour();

/** Open on the first visit of the demonstration, and on request. */
export function useTour(run: Run) {
  const [open, setOpen] = useState(() => opensByItself(run));
  const [requested, setRequested] = useState(false);
  const begin = () => {
    setRequested(true);
    setOpen(true);
  };
  const end = () => {
    rememberTour();
    setOpen(false);
  };
  return { open, requested, begin, end };
}

export function stepsOf(run: Run, archive: Archive, { axes, elites, colouring }: ArchiveView): Step[] {
  const best = fittest(elites)?.[1];
  const [x, y] = axes.map(({ title }) => title.toLowerCase());
  const running = run.status === "running" || run.status === "queued";
  return [
    {
      title: text.tourBest,
      text: text.tourBestAbout(count(elites.size), count(archive.cells)),
      about: "map",
      selector: ".map-plot, .gallery-port",
    },
    {
      title: text.tourKind,
      text: text.tourKindAbout(x!, y!),
      about: "axes",
      selector: ".axis-x",
    },
    {
      title: text.tourColour,
      text: best
        ? text.tourColourAbout(colouring.measure.title.toLowerCase(), best.generation, number(best.fitness))
        : text.tourNoColour,
      about: "legend",
      selector: ".legend",
    },
    {
      title: running ? text.tourLive : text.tourHistory,
      text: running ? text.tourLiveAbout : text.tourHistoryAbout(count(run.generation)),
      about: "time",
      selector: ".time-slider",
    },
    {
      title: text.tourOpen,
      text: text.tourOpenAbout,
      about: "views",
      selector: ".archive-head",
    },
  ];
}
