/** Filaments over their target pictures, with a player; the pictures alone until the run has finished. */

import * as api from "../../api/client";
import type { ResultRow, Run, Target } from "../../api/types";
import { useFetched } from "../../store/fetch";
import { nameOf } from "../../store/figureNames";
import { useStore } from "../../store/store";
import { setQuery } from "../../store/router";
import { number, shortId } from "../../ui/format";
import { Card } from "../../ui/Page";
import { Picture, pictureOf } from "../../ui/Picture";
import { ReplayStatus, useReplays } from "../../replay/replays";
import { type ResultsProps, hrefOf } from "../results/ResultsTable";
import { text } from "./text";
import "./folds.css";
import { useMemo, useState } from "preact/hooks";
import type { Replay } from "../../decode/replay";
import { CanvasStage } from "../../replay/CanvasStage";
import { PlayButton, usePlayback } from "../../replay/LoopPlayer";
import { StepRange } from "../../replay/timeControls";
import { type Point, BODY_INK, chainsOf, positionsAt } from "../../replay/motion";
import { newPlayhead } from "../../replay/clock";
import { type Size, prepare, useTheme } from "../../ui/canvas";
import { Slider } from "../../ui/Select";

export function FoldsCard({ run, query, rows }: ResultsProps & { rows: ResultRow[] }) {
  const { value: targets, error } = useFetched(() => api.readTargets(run.id), [run.id]);
  const selected = targets?.find(({ name }) => name === query.get("picture")) ?? targets?.[0];
  const row = rows.find(({ picture }) => picture === selected?.name);
  return (
    <Card id="folds" kind="folds" title={rows.length > 0 ? text.filaments : text.pictures}>
      {error && <p class="wrong-text small">{error}</p>}
      {targets && <Pictures {...{ run, targets, rows, selected: selected!.name }} />}
      {row?.creature && <Fold key={row.creature} {...{ run, row }} target={selected!} />}
      {targets && rows.length === 0 && <p class="quiet small">{text.noFilaments}</p>}
    </Card>
  );
}

interface PicturesProps {
  run: Run;
  targets: Target[];
  rows: ResultRow[];
  selected: string;
}

function Pictures({ run, targets, rows, selected }: PicturesProps) {
  const summary = useStore((state) => state.runs.get(run.id))?.summary;
  const lossOf = (name: string) => {
    const loss = rows.find(({ picture }) => picture === name)?.least ?? summary?.[nameOf("loss.*", name)];
    return typeof loss === "number" ? text.loss(number(loss)) : text.noLoss;
  };
  return (
    <div class="fold-choice row" role="group" aria-label={text.pictures}>
      {targets.map((target) => (
        <button
          key={target.name}
          aria-pressed={rows.length > 0 ? target.name === selected : undefined}
          disabled={rows.length === 0}
          onClick={() => setQuery({ picture: target.name })}
        >
          <Picture of={target} rgb={GREY} />
          <span class="small">
            <b>{target.name}</b> {lossOf(target.name)}
          </span>
        </button>
      ))}
    </div>
  );
}

const GREY = [128, 140, 148];

function Fold({ run, row, target }: { run: Run; row: ResultRow; target: Target }) {
  const rendering = useReplays([row.creature!]);
  const replay = rendering.replays?.[0];
  return (
    <>
      <ReplayStatus {...rendering} what={text.recordingFold} />
      {replay && <FoldPlayer replay={replay} target={target} />}
      <p class="quiet small">
        {text.losses(number(Number(row.first)), number(Number(row.least)), number(Number(row.empty)))}{" "}
        <a href={hrefOf(run)(row.creature!)}>
          {text.openCreature} <code>{shortId(row.creature!)}</code>
        </a>
      </p>
    </>
  );
}

/** Seconds of playback, and of rest at the end. */
const [PLAY_SECONDS, PAUSE_SECONDS] = [4, 1.5];
/** Shares of the simulation that are shown as pictures. */
const MOMENTS = [0, 0.1, 0.4, 1];

const INK = {
  light: { body: BODY_INK.light, halo: "rgb(255 255 255 / 0.7)", picture: [214, 106, 42] },
  dark: { body: BODY_INK.dark, halo: "rgb(4 10 14 / 0.6)", picture: [226, 132, 66] },
};

function FoldPlayer({ replay, target }: { replay: Replay; target: Target }) {
  const { frames, every, steps } = replay.header;
  const theme = useTheme();
  const [opacity, setOpacity] = useState(0.6);
  const playhead = useMemo(() => newPlayhead(frames - 1), []);
  const speed = (every * (frames - 1)) / PLAY_SECONDS;
  const { last, toggle } = usePlayback(replay, playhead, speed, PAUSE_SECONDS);
  const { playing } = playhead;
  const fold = useMemo((): Folding => {
    const { picture, ...ink } = INK[theme];
    const chains = chainsOf(replay.header.edges);
    return { replay, target, chains, picture: pictureOf(target, picture), opacity, ink };
  }, [replay, target, theme, opacity]);
  const moment = Math.min(last, playhead.time);
  const scrub = (value: number) => playhead.scrub(value);
  return (
    <div class="fold-player">
      <MomentPicture fold={fold} time={moment} name={text.filamentFor(target.name)} />
      <div class="row">
        <PlayButton {...{ playing, toggle }} />
        <StepRange time={moment} {...{ last, every, steps }} onScrub={scrub} />
        <Slider
          {...{ title: text.picture, min: 0, max: 1, step: 0.05 }}
          value={opacity}
          onChange={setOpacity}
        />
      </div>
      <Moments fold={fold} onSelect={(share) => scrub(share * last)} />
    </div>
  );
}

function Moments({ fold, onSelect }: { fold: Folding; onSelect: (share: number) => void }) {
  const { frames, steps } = fold.replay.header;
  return (
    <ol class="fold-moments" aria-label={text.moments}>
      {MOMENTS.map((share) => (
        <li key={share}>
          <button class="plain" onClick={() => onSelect(share)}>
            <MomentPicture
              fold={fold}
              time={share * (frames - 1)}
              name={text.afterSteps(Math.round(share * steps))}
            />
            <span class="small quiet">{text.step(Math.round(share * steps))}</span>
          </button>
        </li>
      ))}
    </ol>
  );
}

function MomentPicture({ fold, time, name }: { fold: Folding; time: number; name: string }) {
  return (
    <CanvasStage
      size={fold.replay.header.size}
      label={name}
      draw={(canvas, size) => drawFold(canvas, size, fold, time)}
      inputs={[fold, time]}
    />
  );
}

interface Folding {
  replay: Replay;
  picture: OffscreenCanvas;
  target: Target;
  chains: number[][];
  /** Opacity of the picture, from 0 to 1. */
  opacity: number;
  ink: { body: string; halo: string };
}

/** Place of a picture on the lattice: left, top (upwards), width and height, in cells. */
export function pictureBox(target: Target, world: readonly [number, number]) {
  const scale = target.size / Math.max(target.width, target.height);
  const [width, height] = [Math.round(scale * target.width), Math.round(scale * target.height)];
  const [left, bottom] = [Math.floor((world[0] - width) / 2), Math.floor((world[1] - height) / 2)];
  // The centre of a cell is a whole coordinate.
  return { left: left - 0.5, top: bottom + height - 0.5, width, height };
}

function drawFold(canvas: HTMLCanvasElement, size: Size, fold: Folding, time: number): void {
  const context = prepare(canvas, size);
  const world = fold.replay.header.size;
  const scale = size.width / world[0];
  const screen = ([x, y]: Point): Point => [(x + 0.5) * scale, (world[1] - 0.5 - y) * scale];
  const { left, top, width, height } = pictureBox(fold.target, world);
  context.globalAlpha = fold.opacity;
  context.imageSmoothingQuality = "high";
  context.drawImage(fold.picture, ...screen([left, top]), width * scale, height * scale);
  context.globalAlpha = 1;
  const points = positionsAt(fold.replay, time).map(screen);
  context.lineCap = context.lineJoin = "round";
  for (const [colour, lineWidth] of [
    [fold.ink.halo, Math.max(2.6, 0.9 * scale)],
    [fold.ink.body, Math.max(1.1, 0.45 * scale)],
  ] as const) {
    context.beginPath();
    for (const chain of fold.chains) {
      chain.forEach((node, i) => context[i === 0 ? "moveTo" : "lineTo"](...points[node]!));
    }
    context.strokeStyle = colour;
    context.lineWidth = lineWidth;
    context.stroke();
  }
}
