/** Player of one replay or several side by side: play, pause, step, scrub, speed. */

import type { ComponentChildren } from "preact";
import { useMemo, useRef } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { Select, Check, Segments } from "../ui/Select";
import { useTheme } from "../ui/canvas";
import { type Playhead, useKeys } from "./clock";
import { type Field, type FieldName, fieldOf, fieldsOf } from "./fields";
import { PlayButton, Stage, usePlayback } from "./LoopPlayer";
import { IconButton, StepRange } from "./timeControls";
import { text } from "./text";
import "./replay.css";
import { setQuery } from "../store/router";
import { ColourBar } from "../ui/ColourBar";
import { css } from "../ui/colours";
import { number } from "../ui/format";

/** Simulated steps per second at speed 1. */
const STEPS_PER_SECOND = 40;

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
const SPEED_CHOICES = SPEEDS.map((speed) => [String(speed), `${speed} ×`] as const);

/** One replay of the player, with a name if there are several. */
interface Panel {
  replay: Replay;
  name?: ComponentChildren;
}

interface Props {
  panels: Panel[];
  playhead: Playhead;
  /** The query of the address, which holds the view. */
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
  const playback = usePlayback(replays[0]!, playhead, view.speed * STEPS_PER_SECOND);
  const { last, toggle, step } = playback;
  useKeys(player, {
    " ": toggle,
    ",": () => step(-1),
    ".": () => step(1),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => playhead.scrub(0),
    End: () => playhead.scrub(last),
  });
  return (
    <div ref={player} class="player" role="group" aria-label={text.player} tabIndex={-1}>
      <div class="stages">
        {panels.map(({ replay, name }, i) => (
          <figure key={i}>
            <Stage
              {...{ replay, field, theme }}
              time={playhead.time}
              follow={view.follow}
              tracing={view.tracers}
              fits
              onClick={toggle}
            />
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

function Transport({ playhead, last, toggle, step, header }: Playback & { header: Replay["header"] }) {
  const { every, steps } = header;
  const { playing, time } = playhead;
  return (
    <>
      <IconButton icon="back" label={text.frameBack} keys=", ArrowLeft" onClick={() => step(-1)} />
      <PlayButton {...{ playing, toggle }} keys="Space" />
      <IconButton icon="forward" label={text.frameForward} keys=". ArrowRight" onClick={() => step(1)} />
      <StepRange
        {...{ time, every, steps, last }}
        keys="Home End"
        title={text.homeEnd}
        onScrub={(time) => playhead.scrub(time)}
      />
    </>
  );
}

interface ReplayView {
  field: FieldName | null;
  tracers: boolean;
  follow: boolean;
  speed: number;
}

const FIELDS = ["vorticity", "speed", "energy", "none"];

export function replayViewOf(query: URLSearchParams): ReplayView {
  const field = query.get("field");
  const speed = Number(query.get("speed"));
  return {
    field: FIELDS.includes(field!) ? (field as FieldName) : null,
    tracers: query.has("tracers"),
    follow: query.get("camera") !== "still",
    speed: SPEEDS.includes(speed) ? speed : 1,
  };
}

/** Changes of the address for changes of the view; defaults have no parameter. */
export function queryOf(change: Partial<ReplayView>): Record<string, string | null> {
  const parameters: Record<string, string | null> = {};
  if (change.field !== undefined) parameters.field = change.field;
  if (change.tracers !== undefined) parameters.tracers = change.tracers ? "" : null;
  if (change.follow !== undefined) parameters.camera = change.follow ? null : "still";
  if (change.speed !== undefined) parameters.speed = change.speed === 1 ? null : String(change.speed);
  return parameters;
}

const changeView = (change: Partial<ReplayView>) => setQuery(queryOf(change));

function ViewOptions({ names, name, view }: { names: FieldName[]; name: FieldName; view: ReplayView }) {
  return (
    <div class="row">
      {names.length > 1 && (
        <Segments
          label={text.field}
          choices={names.map((each) => [each, text.fields[each]] as const)}
          value={name}
          onSelect={(field) => changeView({ field })}
        />
      )}
      {names.includes("speed") && (
        <Check title={text.tracers} on={view.tracers} onChange={(tracers) => changeView({ tracers })} />
      )}
      <Check title={text.follow} on={view.follow} onChange={(follow) => changeView({ follow })} />
    </div>
  );
}

function FieldLegend({ field: { title, unit, range, colour } }: { field: Field }) {
  const [low, high] = range;
  const numbers = [low, (low + high) / 2, high].map((value) => number(value, 2));
  return (
    <ColourBar
      name={`${title} (${unit})`}
      label={text.legend(title, numbers[0], numbers[2], unit)}
      colourAt={(share) => css(colour(share))}
      numbers={numbers}
    />
  );
}
