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
import { type Moment, useMoment } from "./moment";
import { drawScene, sceneOf } from "./scene";
import { Tracers } from "./tracers";
import { IconButton, StepRange } from "./Transport";
import { text } from "./text";
import "./replay.css";

/** Simulated steps per second at speed 1. */
const STEPS_PER_SECOND = 40;

const SPEED_CHOICES = SPEEDS.map((speed) => [String(speed), `${speed} ×`] as const);

/** A replay, with a name if there are several. */
interface Film {
  replay: Replay;
  name?: ComponentChildren;
}

interface Props {
  films: Film[];
  moment: Moment;
  /** Of the address, which holds the view. */
  query: URLSearchParams;
}

/** The films have the same length, and share a clock and a colour scale. */
export function ReplayPlayer({ films, moment, query }: Props) {
  const theme = useTheme();
  const view = replayViewOf(query);
  const replays = useMemo(() => films.map(({ replay }) => replay), [films]);
  const names = useMemo(() => fieldsOf(replays), [replays]);
  const name = names.includes(view.field!) ? view.field! : names[0]!;
  const field = useMemo(() => fieldOf(name, replays, theme), [replays, name, theme]);
  const player = useRef<HTMLDivElement>(null);
  const playback = usePlayback(replays[0]!, view.speed, moment, player);
  return (
    <div ref={player} class="player" role="group" aria-label={text.player} tabIndex={-1}>
      <div class="stages">
        {films.map(({ replay, name }, i) => (
          <figure key={i}>
            <Stage {...{ replay, theme, field, view }} time={moment.time} onClick={playback.toggle} />
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

/** Move the moment by the clock and by keys. */
function usePlayback(
  { header: { frames, every } }: Replay,
  speed: number,
  moment: Moment,
  player: RefObject<HTMLElement | null>,
) {
  const last = frames - 1;
  useMoment(moment);
  useClock(moment.playing, (seconds) => {
    moment.move((moment.time + (seconds * speed * STEPS_PER_SECOND) / every) % Math.max(1, last));
  });
  const toggle = () => moment.play(!moment.playing);
  const step = (by: 1 | -1) => moment.step(by, last);
  useKeys(player, {
    " ": toggle,
    ",": () => step(-1),
    ".": () => step(1),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => moment.scrub(0),
    End: () => moment.scrub(last),
  });
  return { moment, toggle, step };
}

function Transport({ moment, toggle, step, header }: Playback & { header: Replay["header"] }) {
  const { frames, every, steps } = header;
  const { playing, time } = moment;
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
        onScrub={(time) => moment.scrub(time)}
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
    return sceneOf(replay, { painter, follow, theme: field?.ground ?? theme });
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
