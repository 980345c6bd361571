/** The workers page: workers, their load, and the queue. */

import type { Queue, Worker } from "../api/types";
import { useStore } from "../store/store";
import { useWorkers } from "../store/fetch";
import { Card, Empty, Page, Progress } from "../ui/Page";
import { bytes, count, duration, labelOf, number, percent, shortId } from "../ui/format";
import { text } from "./text";
import "./workers.css";

export function WorkersPage() {
  const { value, error } = useWorkers();
  return (
    <Page title={text.workers} error={error} loading={!value}>
      {value?.workers.length === 0 && <NoWorkers />}
      {value && value.workers.length > 0 && (
        <ul class="workers" aria-label={text.workers}>
          {value.workers.map((worker) => (
            <li key={worker.name} class="card">
              <WorkerCard worker={worker} />
            </li>
          ))}
        </ul>
      )}
      {value && <QueueCard queue={value.queue} />}
    </Page>
  );
}

function NoWorkers() {
  return (
    <Empty
      title={text.noWorkers}
      hint={
        <>
          {text.noWorkersHint}
          <code>make run</code>
          {text.orBeside}
          <code>python -m microcosmos_worker.supervisor</code>.
        </>
      }
    />
  );
}

function WorkerCard({ worker }: { worker: Worker }) {
  const { name, device, kind, status, load, since } = worker;
  const [used, memory] = [worker.memory_used_bytes, worker.memory_bytes];
  const busy = kind === "gpu" ? percent(load) : text.perCore(number(load, 2));
  const room = used === null ? bytes(memory) : text.usedOf(bytes(used), bytes(memory));
  return (
    <>
      <header class="card-head">
        <h2>{name}</h2>
        <span class="spring" />
        {worker.problem ? (
          <span class="badge failed">{text.takesNoRun}</span>
        ) : (
          <span class={`badge ${status === "busy" ? "running" : ""}`}>{status}</span>
        )}
      </header>
      <p class="quiet small">{device}</p>
      {worker.labels.length > 0 && <p class="quiet small">{text.labels(worker.labels)}</p>}
      {worker.problem && <p class="banner wrong">{worker.problem}.</p>}
      <Meter title={kind === "gpu" ? text.gpu : text.load} share={load} reading={busy} />
      <Meter
        title={kind === "gpu" ? text.gpuMemory : text.memory}
        share={used === null ? null : used / memory}
        reading={room}
      />
      <CurrentRun worker={worker} />
      <PluginList worker={worker} />
      <p class="quiet small">{text.since(status === "busy", duration(secondsSince(since)))}</p>
    </>
  );
}

const secondsSince = (iso: string) => Math.max(1, (Date.now() - Date.parse(iso)) / 1000);

function Meter({ title, share, reading }: { title: string; share: number | null; reading: string }) {
  const part = Math.min(1, Math.max(0, share ?? 0));
  return (
    <div class="meter">
      <span class="quiet">{title}</span>
      <span>{reading}</span>
      {share !== null && (
        <div
          class={`meter-bar ${part > 0.9 ? "full" : ""}`}
          role="meter"
          aria-label={title}
          aria-valuemin={0}
          aria-valuemax={100}
          aria-valuenow={Math.round(100 * part)}
          aria-valuetext={reading}
        >
          <div style={{ width: `${100 * part}%` }} />
        </div>
      )}
    </div>
  );
}

function PluginList({ worker: { plugins, unloaded } }: { worker: Worker }) {
  return (
    <>
      {plugins.length > 0 && (
        <details class="plugins">
          <summary>{text.plugins(plugins.length)}</summary>
          <ul>
            {plugins.map(({ kind, name, title, source }) => (
              <li key={`${kind} ${name}`}>
                {title} <span class="quiet small">{kind}</span> <code>{name}</code>{" "}
                <code class="quiet">{source.slice(0, 12)}</code>
              </li>
            ))}
          </ul>
        </details>
      )}
      {unloaded.map(({ module, reason }) => (
        <p key={module} class="wrong-text small">
          {text.notLoaded(module, reason)}
        </p>
      ))}
    </>
  );
}

/** The run of a worker; events update its progress before the list of workers does. */
function CurrentRun({ worker: { current_run, status, problem } }: { worker: Worker }) {
  const live = useStore((state) => (current_run ? state.runs.get(current_run.id) : undefined));
  if (!current_run) {
    if (problem) return null;
    return <p class="quiet">{status === "busy" ? text.preparing : text.waiting}</p>;
  }
  const run = { ...current_run, ...(live && { generation: live.generation, progress: live.progress }) };
  const attempt = run.attempt > 1 ? text.attempt(run.attempt) : "";
  return (
    <div>
      <RunLink run={run} />
      <Progress label={text.progressOf(labelOf(run), shortId(run.id))} share={run.progress} kind="running" />
      <span class="quiet small">
        {text.generation(count(run.generation), count(run.generations))}
        {attempt}
      </span>
    </div>
  );
}

function RunLink({ run }: { run: Parameters<typeof labelOf>[0] & { id: string } }) {
  return (
    <a class="run-name" href={`/runs/${run.id}`}>
      {labelOf(run)} <code>{shortId(run.id)}</code>
    </a>
  );
}

function QueueCard({ queue: { total, items, warning } }: { queue: Queue }) {
  return (
    <Card id="queue" kind="queue" title={text.queue}>
      {warning && <p class="banner warning">{warning}.</p>}
      <p class="quiet small">{total === 0 ? text.queueEmpty : text.queueOrder}</p>
      {total > 0 && (
        <ol>
          {items.map((run) => (
            <li key={run.id}>
              <RunLink run={run} />
              <span class="quiet small">
                {run.priority !== "normal" && text.urgency(run.priority)}
                {run.owner && text.ownedBy(run.owner)}
                {run.memory_bytes !== null && `${bytes(run.memory_bytes)}, `}
                {text.waitingFor(duration(secondsSince(run.queued_at)))}
              </span>
              <span class="quiet">{run.waiting_reason}</span>
            </li>
          ))}
        </ol>
      )}
      {total > items.length && <p class="quiet small">{text.more(count(total - items.length))}</p>}
    </Card>
  );
}
