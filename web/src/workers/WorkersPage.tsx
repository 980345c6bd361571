/** Who computes, how busy they are, and what waits for them. */

import type { Queue, Worker } from "../api/types";
import { useStore } from "../store/store";
import { useWorkers } from "../store/refresh";
import { bytes, count, duration, labelOf, number, percent, short } from "../ui/format";
import "./workers.css";

export function WorkersPage() {
  const { value, error } = useWorkers();
  return (
    <main>
      <header class="page-head">
        <h1>Workers</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!value && !error && <p class="quiet loading">Loading workers …</p>}
      {value?.workers.length === 0 && <NoWorkers />}
      {value && value.workers.length > 0 && (
        <ul class="workers" aria-label="Workers">
          {value.workers.map((worker) => (
            <li key={worker.name} class="card">
              <WorkerCard worker={worker} />
            </li>
          ))}
        </ul>
      )}
      {value && <QueueCard queue={value.queue} />}
    </main>
  );
}

function NoWorkers() {
  return (
    <section class="empty card">
      <h2>No worker is alive</h2>
      <p>
        Runs wait until somebody computes them. Start a worker with <code>make run</code>, or beside a running
        server with <code>python -m worker.supervisor</code>.
      </p>
    </section>
  );
}

function WorkerCard({ worker }: { worker: Worker }) {
  const { name, device, kind, status, load, since } = worker;
  const [used, memory] = [worker.memory_used_bytes, worker.memory_bytes];
  const busy = kind === "gpu" ? percent(load) : `${number(load, 2)} per core`;
  const room = used === null ? bytes(memory) : `${bytes(used)} of ${bytes(memory)}`;
  return (
    <>
      <header class="card-head">
        <h2>{name}</h2>
        <span class="spring" />
        <span class={`badge ${status === "busy" ? "running" : ""}`}>{status}</span>
      </header>
      <p class="quiet small">{device}</p>
      <Meter title={kind === "gpu" ? "GPU" : "Load"} share={load} text={busy} />
      <Meter
        title={kind === "gpu" ? "GPU memory" : "Memory"}
        share={used === null ? null : used / memory}
        text={room}
      />
      <CurrentRun worker={worker} />
      <PluginList worker={worker} />
      <p class="quiet small">
        {status === "busy" ? "Busy" : "Idle"} for {duration(secondsSince(since))}
      </p>
    </>
  );
}

const secondsSince = (iso: string) => Math.max(1, (Date.now() - Date.parse(iso)) / 1000);

function Meter({ title, share, text }: { title: string; share: number | null; text: string }) {
  const part = Math.min(1, Math.max(0, share ?? 0));
  return (
    <div class="meter">
      <span>{title}</span>
      <span>{text}</span>
      {share !== null && (
        <div
          class={`meter-bar ${part > 0.9 ? "full" : ""}`}
          role="meter"
          aria-label={title}
          aria-valuemin={0}
          aria-valuemax={100}
          aria-valuenow={Math.round(100 * part)}
          aria-valuetext={text}
        >
          <div style={{ width: `${100 * part}%` }} />
        </div>
      )}
    </div>
  );
}

/** What it has of users' own, and what it could not load. */
function PluginList({ worker: { plugins, unloaded } }: { worker: Worker }) {
  return (
    <>
      {plugins.length > 0 && (
        <details class="plugins">
          <summary>{count(plugins.length)} of users’ own</summary>
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
          {module} is not loaded: {reason}
        </p>
      ))}
    </>
  );
}

/** Events tell of a run's progress sooner than the next look at its worker. */
function CurrentRun({ worker: { current_run, status } }: { worker: Worker }) {
  const live = useStore((state) => (current_run ? state.runs.get(current_run.id) : undefined));
  if (!current_run) {
    return <p class="quiet">{status === "busy" ? "Getting ready for a run." : "Waits for a run."}</p>;
  }
  const run = { ...current_run, ...(live && { generation: live.generation, progress: live.progress }) };
  const share = Math.round(1000 * run.progress) / 10;
  const attempt = run.attempt > 1 ? `, attempt ${run.attempt}` : "";
  return (
    <div>
      <a class="run-name" href={`/runs/${run.id}`}>
        {labelOf(run)} <code>{short(run.id)}</code>
      </a>
      <div
        class="progress running"
        role="progressbar"
        aria-label={`Progress of ${labelOf(run)} ${short(run.id)}`}
        aria-valuemin={0}
        aria-valuemax={100}
        aria-valuenow={share}
      >
        <div style={{ width: `${share}%` }} />
      </div>
      <span class="quiet small">
        Generation {count(run.generation)} of {count(run.generations)}
        {attempt}
      </span>
    </div>
  );
}

function QueueCard({ queue: { total, items } }: { queue: Queue }) {
  return (
    <section class="card queue" aria-labelledby="queue-title">
      <h2 id="queue-title">Queue</h2>
      {total === 0 && <p class="quiet">No run waits.</p>}
      {total > 0 && (
        <ol>
          {items.map((run) => (
            <li key={run.id}>
              <a class="run-name" href={`/runs/${run.id}`}>
                {labelOf(run)} <code>{short(run.id)}</code>
              </a>
              <span class="quiet small">
                {run.memory_bytes !== null && `${bytes(run.memory_bytes)}, `}
                waits for {duration(secondsSince(run.queued_at))}
              </span>
              <span class="reason">{run.waiting_reason}</span>
            </li>
          ))}
        </ol>
      )}
      {total > items.length && <p class="quiet small">And {count(total - items.length)} more.</p>}
    </section>
  );
}
