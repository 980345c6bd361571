/** Player of one replay or several side by side: play, pause, step, scrub, speed. */

import type { ComponentChildren, RefObject } from "preact";
import { useMemo, useRef } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { Select } from "../ui/Select";
import { type Theme, useTheme } from "../ui/canvas";
import { CanvasStage } from "./CanvasStage";
import { useClock, useKeys } from "./clock";
import { type Field, fieldOf, fieldsOf } from "./fields";
import { FluidPainter } from "./fluid";
import { type ReplayView, FieldLegend, SPEEDS, ViewOptions, changeView, replayViewOf } from "./replayView";
import { type Playhead, usePlayhead } from "./playhead";
import { drawScene, sceneOf } from "./scene";
import { Tracers } from "./tracers";
import { IconButton, StepRange } from "./timeControls";
import { text } from "./text";
import "./replay.css";

/** Simulated steps per second at speed 1. */
const STEPS_PER_SECOND = 40;

const SPEED_CHOICES = SPEEDS.map((speed) => [String(speed), `${speed} ×`] as const);

/** One replay of the player, with a name if there are several. */
interface Panel {
  replay: Replay;
  name?: ComponentChildren;
}

interface Props {
  panels: Panel[];
  playhead: Playhead;
  /** Of the address, which holds the view. */
  query: URLSearchParams;
}

/** The panels have the same length, and share a clock and a colour scale. */
export function ReplayPlayer({ panels, playhead, query }: Props) {
  const theme = useTheme();
  const view = replayViewOf(query);
  const replays = useMemo(() => panels.map(({ replay }) => replay), [panels]);
  const names = useMemo(() => fieldsOf(replays), [replays]);
  const name = names.includes(view.field!) ? view.field! : names[0]!;
  const field = useMemo(() => fieldOf(name, replays, theme), [replays, name, theme]);
  const player = useRef<HTMLDivElement>(null);
  const playback = usePlayback(replays[0]!, view.speed, playhead, player);
  return (
    <div ref={player} class="player" role="group" aria-label={text.player} tabIndex={-1}>
      <div class="stages">
        {panels.map(({ replay, name }, i) => (
          <figure key={i}>
            <Stage {...{ replay, theme, field, view }} time={playhead.time} onClick={playback.toggle} />
            {name && <figcaption>{name}</figcaption>}
          </figure>
        ))}
      </div>
      <div class="row">
        <Transport {...playback} header={replays[0]!.header} />
        <Select
          title={text.speed}
          choices={SPEED_CHOICES}
          value={String(view.speed)}
          onChange={(speed) => changeView({ speed: Number(speed) })}
        />
      </div>
      <ViewOptions {...{ names, name, view }} />
      {field && <FieldLegend field={field} />}
    </div>
  );
}

type Playback = ReturnType<typeof usePlayback>;

/** Move the playhead by the clock and by keys. */
function usePlayback(
  { header: { frames, every } }: Replay,
  speed: number,
  playhead: Playhead,
  player: RefObject<HTMLElement | null>,
) {
  const last = frames - 1;
  usePlayhead(playhead);
  useClock(playhead.playing, (seconds) => {
    playhead.move((playhead.time + (seconds * speed * STEPS_PER_SECOND) / every) % Math.max(1, last));
  });
  const toggle = () => playhead.play(!playhead.playing);
  const step = (by: 1 | -1) => playhead.step(by, last);
  useKeys(player, {
    " ": toggle,
    ",": () => step(-1),
    ".": () => step(1),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => playhead.scrub(0),
    End: () => playhead.scrub(last),
  });
  return { playhead, toggle, step };
}

function Transport({ playhead, toggle, step, header }: Playback & { header: Replay["header"] }) {
  const { frames, every, steps } = header;
  const { playing, time } = playhead;
  return (
    <>
      <IconButton icon="back" label={text.frameBack} keys=", ArrowLeft" onClick={() => step(-1)} />
      <IconButton
        icon={playing ? "pause" : "play"}
        label={playing ? text.pause : text.play}
        keys="Space"
        onClick={toggle}
      />
      <IconButton icon="forward" label={text.frameForward} keys=". ArrowRight" onClick={() => step(1)} />
      <StepRange
        {...{ time, every, steps }}
        last={frames - 1}
        keys="Home End"
        title={text.homeEnd}
        onScrub={(time) => playhead.scrub(time)}
      />
    </>
  );
}

interface StageProps {
  replay: Replay;
  theme: Theme;
  field: Field | null;
  view: ReplayView;
  time: number;
  onClick: () => void;
}

function Stage({ replay, theme, field, view, time, onClick }: StageProps) {
  const { follow, tracers: tracing } = view;
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
      fits
      draw={(canvas, size) => drawScene(canvas, size, { ...scene, tracers }, time)}
      inputs={[scene, tracers, time]}
      onClick={onClick}
    />
  );
}
