/** The tour of an archive, step by step. */

import type { Run } from "../../api/types";
import { fittest } from "../../store/elites";
import { count, number } from "../../ui/format";
import { type Step, Tour } from "../../ui/Tour";
import type { ArchiveView } from "../archiveView";
import { containerOf } from "../axes";
import { containerText } from "../text";
import type { useTour } from "../tour";
import { text } from "./text";

interface TourProps {
  run: Run;
  view: ArchiveView;
  tour: ReturnType<typeof useTour>;
  onPart: (part: string | null) => void;
  /** Marks a cell; null if one is marked already. */
  onMark: ((cell: number) => void) | null;
}

export function ArchiveTour({ run, view, tour, onPart, onMark }: TourProps) {
  return (
    <Tour
      steps={stepsOf(run, view)}
      requested={tour.requested}
      onStep={({ part }) => {
        onPart(part);
        const best = fittest(view.elites);
        if (part === "legend" && best) onMark?.(best[0]);
      }}
      onEnd={() => {
        onPart(null);
        tour.end();
      }}
    />
  );
}

function stepsOf(run: Run, { archive, axes, elites, colouring }: ArchiveView): Step[] {
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
