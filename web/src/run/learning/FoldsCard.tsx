/** Filaments over their target pictures; the pictures alone until the run has finished. */

import { useEffect, useMemo, useRef } from "preact/hooks";
import * as api from "../../api/client";
import type { ResultRow, Run, Target } from "../../api/types";
import { useFetched } from "../../store/fetch";
import { useStore } from "../../store/store";
import { setQuery } from "../../store/router";
import { number, shortId } from "../../ui/format";
import { Card } from "../../ui/Page";
import { FoldPlayer, pictureOf } from "./FoldPlayer";
import { ReplayStatus, useReplays } from "../../replay/replays";
import { type ResultsProps, hrefOf } from "../results/ResultsTable";
import { text } from "./text";
import "./folds.css";

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
    const loss = rows.find(({ picture }) => picture === name)?.least ?? summary?.[`loss of ${name}`];
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
          <Thumb target={target} />
          <span class="small">
            <b>{target.name}</b> {lossOf(target.name)}
          </span>
        </button>
      ))}
    </div>
  );
}

const GREY = [128, 140, 148];

function Thumb({ target }: { target: Target }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const picture = useMemo(() => pictureOf(target, GREY), [target]);
  useEffect(() => {
    canvas.current!.getContext("2d")!.drawImage(picture, 0, 0);
  }, [picture]);
  return <canvas ref={canvas} width={target.width} height={target.height} aria-hidden="true" />;
}

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
