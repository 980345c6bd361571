/** The creatures in their lanes, with one clock; pictures and films of them. */

import type { RefObject } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { saveFile } from "../api/files";
import { STEPS_PER_SECOND, useClock, useKeys } from "../replay/clock";
import { showFailure } from "../store/toasts";
import { type Size, prefersReducedMotion, px, useSize } from "../ui/canvas";
import { useLeaving } from "../ui/forms";
import { Select } from "../ui/Select";
import { type Lane, drawRace, isOver } from "./race";
import { gifOf, canFilm, film, savePicture } from "./recording";
import { text } from "./text";

const PACES = ["1", "2", "4"].map((pace) => [pace, `${pace} ×`] as const);
const LANE_HEIGHT = 120;

export function Race({ lanes }: { lanes: Lane[] }) {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const { width } = useSize(box);
  const size = { width, height: LANE_HEIGHT * lanes.length };
  const steps = useRef(0);
  const [playing, setPlaying] = useState(() => !prefersReducedMotion());
  const [pace, setPace] = useState(2);
  const over = () => isOver(lanes, steps.current, size);
  const draw = () => {
    if (canvas.current && width > 0) drawRace(canvas.current, size, lanes, steps.current);
  };
  useClock(playing && width > 0, (seconds) => {
    steps.current += pace * STEPS_PER_SECOND * seconds;
    draw();
    if (over()) setPlaying(false);
  });
  useEffect(draw);
  const restart = () => {
    steps.current = 0;
    setPlaying(true);
  };
  const toggle = () => (over() ? restart() : setPlaying(!playing));
  useKeys(box, { " ": toggle });
  return (
    <>
      <div ref={box} class="race">
        <canvas ref={canvas} style={px(size)} role="img" aria-label={text.race(lanes.length)} />
      </div>
      <div class="row race-controls">
        <button onClick={toggle}>{playing ? text.pause : text.play}</button>
        <button onClick={restart}>{text.restart}</button>
        <Select
          title={text.pace}
          choices={PACES}
          value={String(pace)}
          onChange={(chosen) => setPace(Number(chosen))}
        />
        <span class="spring" />
        <Exports {...{ canvas, lanes, size, pace }} onStart={restart} isOver={over} />
      </div>
      <p class="quiet small race-about">{text.raceAbout}</p>
    </>
  );
}

interface ExportsProps {
  canvas: RefObject<HTMLCanvasElement | null>;
  lanes: Lane[];
  size: Size;
  pace: number;
  /** Starts from the beginning. */
  onStart: () => void;
  isOver: () => boolean;
}

/** A picture of this moment, and a film from the start until the first one has arrived. */
function Exports({ canvas, lanes, size, pace, onStart, isOver }: ExportsProps) {
  const [filming, setFilming] = useState(false);
  const leaving = useLeaving();
  const make = async () => {
    setFilming(true);
    onStart();
    await film(canvas.current!, text.fileName, isOver, leaving).catch(showFailure);
    setFilming(false);
  };
  const [drawn, setDrawn] = useState<number | null>(null);
  const makeGif = async () => {
    setDrawn(0);
    await gifOf(lanes, size, pace * STEPS_PER_SECOND, setDrawn)
      .then((blob) => leaving.aborted || saveFile(blob, `${text.fileName}.gif`))
      .catch(showFailure);
    setDrawn(null);
  };
  return (
    <>
      <button disabled={drawn !== null} onClick={() => void makeGif()}>
        {drawn === null ? text.gif : text.drawing(drawn)}
      </button>
      <button onClick={() => savePicture(canvas.current!, text.fileName)}>{text.picture}</button>
      {canFilm() && (
        <button disabled={filming} onClick={() => void make()}>
          {filming ? text.filming : text.film}
        </button>
      )}
    </>
  );
}
