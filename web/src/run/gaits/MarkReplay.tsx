/** The replay of the mark that is pointed at, beside its plot. */

import { useState } from "preact/hooks";
import { useDebounced } from "../../store/timing";
import type { Point } from "../../charts/plot/Plot";
import { ReplayLoop } from "../../replay/Loop";
import { RecordingStatus, useReplays } from "../../replay/recordings";
import { text } from "./text";
import "./gaits.css";

/** A pointer on its way passes marks that nobody wants to see. */
const SETTLE_MS = 120;

/** The last mark that was pointed at for a moment: leaving it keeps its replay. */
export function useLastMark(near: Point | null): Point | null {
  const [last, setLast] = useState<Point | null>(null);
  useDebounced(near?.href ? near : null, SETTLE_MS, setLast);
  return last;
}

export function MarkReplay({ point }: { point: Point | null }) {
  return (
    <aside class="mark-replay" aria-label={text.replay}>
      {point ? <Playing key={point.href} point={point} /> : <p class="quiet small">{text.pointAtMark}</p>}
    </aside>
  );
}

function Playing({ point }: { point: Point }) {
  const rendering = useReplays([shaOf(point.href!)]);
  const replay = rendering.replays?.[0];
  const [name, ...figures] = point.says;
  return (
    <>
      <RecordingStatus {...rendering} what={text.simulating} />
      {replay && <ReplayLoop replay={replay} name={text.swimming(name)} />}
      <p class="small">
        <b>{name}</b>
        <br />
        <span class="quiet">{figures.join(", ")}</span>
        <br />
        <a href={point.href}>{text.openCreature}</a>
      </p>
    </>
  );
}

const shaOf = (href: string) => href.split("/").at(-1)!.split("?")[0]!;
