/** All runs, newest first, alive. */

import { useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import type { Experiment, Run } from "../api/types";
import { moreRuns, useExperiments, useRunList } from "../live/fetching";
import { useLive } from "../live/live";
import { tell } from "../live/toasts";
import { freedomOf } from "../view/coupling";
import { DASH, short, titleOf } from "../view/format";
import { NotFree } from "../view/NotFree";
import { keyFigureOf } from "../view/results/figures";
import { Actions, Badge, Progress, rateOf, timeOf } from "../view/RunBits";
import { Sparkline } from "../view/Sparkline";
import { ON } from "./wishes";

export function RunsPage() {
  const { value: fetched, error } = useRunList();
  const runs = useLive((state) => state.runs);
  const listed = useLive((state) => state.listed);
  const next = useLive((state) => state.next);
  const experiments = useExperiments().value ?? [];
  return (
    <main>
      <header class="page-head">
        <h1>Runs</h1>
        <a class="button primary" href="/new">
          New run
        </a>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!fetched && !error && listed.length === 0 && <p class="quiet loading">Loading runs …</p>}
      {fetched && listed.length === 0 && <Empty />}
      {listed.length > 0 && (
        <table class="runs">
          <thead>
            <tr>
              <th scope="col">Run</th>
              <th scope="col">State</th>
              <th scope="col">Progress</th>
              <th scope="col">Time</th>
              <th scope="col">Evaluations/s</th>
              <th scope="col">Result</th>
              <th scope="col">
                <span class="unseen">Actions</span>
              </th>
            </tr>
          </thead>
          <tbody>
            {listed.map((id) => (
              <Row key={id} run={runs.get(id)!} experiments={experiments} />
            ))}
          </tbody>
        </table>
      )}
      {next && <More />}
    </main>
  );
}

function Row({ run, experiments }: { run: Run; experiments: Experiment[] }) {
  const title = titleOf(run, experiments);
  const name = `${title} ${short(run.id)}`;
  const time = timeOf(run);
  const [figureName, figure] = keyFigureOf(run);
  return (
    <tr>
      <th scope="row">
        <a class="run-name" href={`/runs/${run.id}`}>
          {title} <code>{short(run.id)}</code>
        </a>
        {freedomOf(run.spec) === "none" && <NotFree />}
        {run.error && <span class="row-note wrong-text">{lastLine(run.error)}</span>}
        {run.warning && <span class="row-note warning-text">{run.warning}</span>}
      </th>
      <td data-label="State">
        <Badge run={run} />
      </td>
      <td data-label="Progress" class="with-bar">
        <Progress run={run} />
        <span class="quiet">
          {run.generation} / {run.generations}
        </span>
      </td>
      <td data-label={time.label}>
        {time.text}
        {run.status === "running" && time.text !== DASH && <span class="quiet"> left</span>}
      </td>
      <td data-label="Evaluations/s">{rateOf(run)}</td>
      <td data-label="Result" class="with-spark">
        <span>
          {figure} <span class="quiet small">{figureName}</span>
        </span>
        {run.sparkline.length > 1 && (
          <Sparkline values={run.sparkline} label={`QD score of ${name} over time`} />
        )}
      </td>
      <td class="row-actions">
        <Actions run={run} on={ON(title)} name={name} />
      </td>
    </tr>
  );
}

function lastLine(text: string): string {
  return text.trim().split("\n").at(-1) ?? "";
}

function Empty() {
  return (
    <section class="empty card">
      <h2>No runs yet</h2>
      <p>
        A run evolves swimmers: from random bodies that twitch to an archive of the best swimmer of
        every kind. The demo takes minutes on a laptop.
      </p>
      <a class="button primary" href="/new">
        Start the first run
      </a>
    </section>
  );
}

function More() {
  const [busy, setBusy] = useState(false);
  const load = async () => {
    setBusy(true);
    await moreRuns().catch((error) => tell({ kind: "wrong", text: messageOf(error) }));
    setBusy(false);
  };
  return (
    <p class="more">
      <button onClick={load} disabled={busy}>
        {busy ? "Loading …" : "Load more"}
      </button>
    </p>
  );
}
