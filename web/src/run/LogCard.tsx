/** What happened to a run: its journal, live. */

import type { Run } from "../api/types";
import { useLog } from "../store/log";
import { setQuery } from "../store/router";
import { Select } from "../ui/Select";
import { count } from "../ui/format";
import { LEVELS, type Level, LogList, atLeast, textOf } from "./LogList";
import { copyText } from "../ui/clipboard";
import "./log.css";

const NAMES: Record<Level, string> = {
  info: "everything",
  warning: "warnings and errors",
  error: "errors only",
};

export function LogCard({ run, query }: { run: Run; query: URLSearchParams }) {
  const { value: entries, error, earlier } = useLog(run);
  const level = LEVELS.find((name) => name === query.get("level")) ?? "info";
  const shown = atLeast(entries ?? [], level);
  return (
    <section class="card log-card" id="log" aria-labelledby="log-title" tabIndex={-1}>
      <div class="card-head wraps">
        <h2 id="log-title">Log</h2>
        {shown.length > 0 && (
          <span class="quiet">
            {earlier && "the last "}
            {count(shown.length)} entries
          </span>
        )}
        {earlier && (
          <button class="slim" onClick={earlier}>
            Show earlier ones
          </button>
        )}
        <span class="spring" />
        <Select
          title="Show"
          choices={LEVELS.map((name) => [name, NAMES[name]])}
          value={level}
          onChange={(name) => setQuery({ level: name === "info" ? null : name })}
        />
        {shown.length > 0 && (
          <button class="slim" onClick={() => copyText(textOf(shown), "Log copied.")}>
            Copy
          </button>
        )}
      </div>
      {error && <p class="banner wrong">{error}</p>}
      {!entries && !error && <p class="quiet waiting">Loading the log …</p>}
      {entries && shown.length === 0 && <p class="quiet">{emptyOf(entries.length, level)}</p>}
      {shown.length > 0 && (
        <div class="log-scroll" tabIndex={0} role="group" aria-label="Entries, the newest first">
          <LogList entries={shown} />
        </div>
      )}
    </section>
  );
}

function emptyOf(all: number, level: Level): string {
  if (all === 0) return "Nothing was written down: the run was submitted before there was a log.";
  return level === "error" ? "No errors." : "No warnings and no errors.";
}
