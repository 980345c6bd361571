/** The player of a replay: a stage, a playhead that the clock moves, and controls of its time. */

import { useMemo } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { type Theme, prefersReducedMotion, useTheme } from "../ui/canvas";
import { CanvasStage } from "./CanvasStage";
import { type Playhead, newPlayhead, usePlayhead, STEPS_PER_SECOND, useClock } from "./clock";
import { type Field, FluidPainter, fieldOf, fieldsOf } from "./fields";
import { drawScene, sceneOf } from "./scene";
import { text } from "./text";
import { IconButton, StepRange } from "./timeControls";
import { Tracers } from "./tracers";

/** Let the clock move a playhead through a replay, with a rest of some seconds at its end. */
export function usePlayback(
  { header: { frames, every } }: Replay,
  playhead: Playhead,
  stepsPerSecond = STEPS_PER_SECOND,
  rest = 0,
) {
  const last = frames - 1;
  usePlayhead(playhead);
  useClock(playhead.playing, (seconds) => {
    // The last frame gives way to the first: a stroke ends where the next one begins.
    const speed = stepsPerSecond / every;
    playhead.move((playhead.time + seconds * speed) % Math.max(1, last + rest * speed));
  });
  const toggle = () => playhead.play(!playhead.playing);
  const step = (by: 1 | -1) => playhead.step(by, last);
  return { playhead, last, toggle, step };
}

interface StageProps {
  replay: Replay;
  /** Null for no field. */
  field: Field | null;
  theme: Theme;
  time: number;
  follow?: boolean;
  tracing?: boolean;
  /** A name in place of a description of what is shown. */
  label?: string;
  /** Keep the stage lower than the window. */
  fits?: boolean;
  onClick?: () => void;
}

/** A replay at one time. */
export function Stage({ replay, field, theme, time, follow = true, tracing = false, ...rest }: StageProps) {
  const tracers = useMemo(() => (tracing ? new Tracers(replay) : null), [replay, tracing]);
  const scene = useMemo(() => {
    const painter = field && new FluidPainter(replay, field);
    return sceneOf(replay, { painter, follow, theme: field?.background ?? theme });
  }, [replay, theme, field, follow]);
  return (
    <CanvasStage
      size={replay.header.size}
      label={text.stage(field?.title ?? null, tracing)}
      blank={!field}
      draw={(canvas, size) => drawScene(canvas, size, { ...scene, tracers }, time)}
      inputs={[scene, tracers, time]}
      {...rest}
    />
  );
}

interface LoopProps {
  replay: Replay;
  /** A name, for a stage without controls. */
  bare?: string;
  /** Keep the stage lower than the window. */
  fits?: boolean;
}

/** A replay that repeats, with its first field: in other pages, notebooks, files, and small cards. */
export function LoopPlayer({ replay, bare, fits = true }: LoopProps) {
  const theme = useTheme();
  const playback = usePlayback(replay, useMemo(newPlayhead, []));
  const field = useMemo(() => fieldOf(fieldsOf([replay])[0]!, [replay], theme), [replay, theme]);
  const { playhead, last, toggle } = playback;
  const { time, playing } = playhead;
  if (bare !== undefined) {
    // A still picture without controls shows the end.
    const shown = prefersReducedMotion() ? last : time;
    return <Stage {...{ replay, field, theme }} time={shown} label={bare} />;
  }
  const { every, steps } = replay.header;
  return (
    <div class="player" role="group" aria-label={text.player}>
      <Stage {...{ replay, field, theme, time, fits }} onClick={toggle} />
      <div class="row">
        <PlayButton {...{ playing, toggle }} />
        <StepRange {...{ time, every, steps, last }} onScrub={(at) => playhead.scrub(at)} />
      </div>
    </div>
  );
}

interface PlayProps {
  playing: boolean;
  toggle: () => void;
  keys?: string;
}

export function PlayButton({ playing, toggle, keys }: PlayProps) {
  const icon = playing ? "pause" : "play";
  return <IconButton {...{ icon, keys }} label={text[icon]} onClick={toggle} />;
}
