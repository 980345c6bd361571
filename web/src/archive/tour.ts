/** The tour of an archive. */

import { useState } from "preact/hooks";
import type { Archive, Run } from "../api/types";
import { fittest } from "../store/elites";
import { count, number } from "../ui/format";
import type { Step } from "../ui/Tour";
import type { ArchiveView } from "./archiveView";
import { containerOf } from "./axes";
import { containerText, text } from "./text";

const STORAGE_KEY = "microcosmos:tour-taken";

/** True if this browser has shown the tour; false if it forbids storage. */
export function hasTakenTour(): boolean {
  try {
    return localStorage.getItem(STORAGE_KEY) !== null;
  } catch {
    return false;
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
    setOpen(false);
    try {
      localStorage.setItem(STORAGE_KEY, "1");
    } catch {
      // The tour is offered again.
    }
  };
  return { open, requested, begin, end };
}

export function stepsOf(run: Run, archive: Archive, { axes, elites, colouring }: ArchiveView): Step[] {
  const best = fittest(elites)?.[1];
  const [x, y] = axes.map(({ title }) => title.toLowerCase());
  const running = run.status === "running" || run.status === "queued";
  const colour = colouring.measure.title.toLowerCase();
  const aboutColour = best && text.tourColourAbout(colour, best.generation, number(best.fitness));
  const aboutTime = running ? text.tourLiveAbout : text.tourHistoryAbout(count(run.generation));
  const found = count(elites.size);
  const pool = archive.kind === "pool";
  const aboutElites = pool
    ? text.tourPlacesAbout(found, containerText(containerOf(run)?.kind ?? ""))
    : text.tourBestAbout(found, count(archive.cells));
  const aboutKinds = pool ? text.tourPositionsAbout : text.tourKindAbout;
  const steps = [
    ["map", ".map-plot, .gallery-port", text.tourBest, aboutElites],
    ["axes", ".axis-x", pool ? text.tourPositions : text.tourKind, aboutKinds(x!, y!)],
    ["legend", ".legend", text.tourColour, aboutColour ?? text.tourNoColour],
    ["time", ".time-slider", running ? text.tourLive : text.tourHistory, aboutTime],
    ["views", ".archive-head", text.tourOpen, text.tourOpenAbout],
  ] as const;
  return steps.map(([part, selector, title, text]) => ({ part, selector, title, text }));
}
