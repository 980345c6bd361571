/** Player of one replay or several side by side: play, pause, step, scrub, speed. */

import type { ComponentChildren, RefObject } from "preact";
import { useMemo, useRef, useState } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { type Theme, useTheme } from "../ui/canvas";
import { CanvasStage } from "./CanvasStage";
import { useClock, useKeys } from "./clock";
import { FieldLegend, LookChoice, Speed } from "./Controls";
import { type Field, fieldOf, fieldsOf } from "./fields";
import { FluidPainter } from "./fluid";
import { type ReplayView, DEFAULT_VIEW } from "./replayView";
import { type Moment, newMoment, useMoment } from "./moment";
import { drawScene, sceneOf } from "./scene";
import { Tracers } from "./tracers";
import { IconButton, StepRange } from "./Transport";
import { text } from "./text";
import "./replay.css";

/** Simulated steps per second at speed 1. */
const STEPS_PER_SECOND = 40;

/** A replay, with a name if there are several. */
interface Film {
  replay: Replay;
  name?: ComponentChildren;
}

interface Props {
  films: Film[];
  /** By default, the player keeps its own moment and view. */
  moment?: Moment;
  view?: ReplayView;
  onLook?: (change: Partial<ReplayView>) => void;
}

/** The films have the same length, and share a clock and a colour scale. */
export function ReplayPlayer({ films, ...given }: Props) {
  const theme = useTheme();
  const [own, setOwn] = useState(DEFAULT_VIEW);
  const view = given.view ?? own;
  const change = given.onLook ?? ((part) => setOwn((old) => ({ ...old, ...part })));
  const replays = useMemo(() => films.map(({ replay }) => replay), [films]);
  const names = useMemo(() => fieldsOf(replays), [replays]);
  const name = names.includes(view.field!) ? view.field! : names[0]!;
  const field = useMemo(() => fieldOf(name, replays, theme), [replays, name, theme]);
  const player = useRef<HTMLDivElement>(null);
  const playback = usePlayback(replays[0]!, view.speed, given.moment, player);
  return (
    <div ref={player} class="player" role="group" aria-label={text.player} tabIndex={-1}>
      <div class="stages">
        {films.map(({ replay, name }, i) => (
          <figure key={i}>
            <Stage
              {...{ replay, theme, field }}
              tracing={view.tracers}
              follow={view.follow}
              time={playback.moment.time}
              onClick={playback.toggle}
            />
            {name && <figcaption>{name}</figcaption>}
          </figure>
        ))}
      </div>
      <div class="row">
        <Transport {...playback} header={replays[0]!.header} />
        <Speed value={view.speed} onChange={(speed) => change({ speed })} />
      </div>
      <LookChoice {...{ names, name, view, change }} />
      {field && <FieldLegend field={field} />}
    </div>
  );
}

interface Playback {
  moment: Moment;
  toggle: () => void;
  step: (by: 1 | -1) => void;
}

/** The moment shown, moved by the clock and by keys. */
function usePlayback(
  { header: { frames, every } }: Replay,
  speed: number,
  given: Moment | undefined,
  player: RefObject<HTMLElement | null>,
): Playback {
  const last = frames - 1;
  const moment = useMoment(useMemo(() => given ?? newMoment(), [given]));
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
  tracing: boolean;
  follow: boolean;
  time: number;
  onClick: () => void;
}

function Stage({ replay, theme, field, tracing, follow, time, onClick }: StageProps) {
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
