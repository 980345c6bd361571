/** The log of a run, live. */

import type { LogEntry, Run } from "../api/types";
import { useLog } from "../store/log";
import { setQuery } from "../store/router";
import { Select } from "../ui/Select";
import { count, dateTime } from "../ui/format";
import { Card } from "../ui/Page";
import { copyText } from "../ui/clipboard";
import { text } from "./text";
import "./log.css";

type Level = LogEntry["level"];

/** From the least severe one. */
const LEVELS = Object.keys(text.levels) as Level[];

export function LogCard({ run, query }: { run: Run; query: URLSearchParams }) {
  const { value: entries, error, loadEarlier } = useLog(run);
  const level = LEVELS.find((name) => name === query.get("level")) ?? "info";
  const shown = atLeast(entries ?? [], level);
  const note = shown.length > 0 && text.entries(count(shown.length), loadEarlier !== null);
  const actions = (
    <>
      {loadEarlier && (
        <button class="slim" onClick={loadEarlier}>
          {text.showEarlier}
        </button>
      )}
      <Select
        title={text.show}
        choices={Object.entries(text.levels)}
        value={level}
        onChange={(name) => setQuery({ level: name === "info" ? null : name })}
      />
      {shown.length > 0 && (
        <button class="slim" onClick={() => copyText(textOf(shown), text.logCopied)}>
          {text.copy}
        </button>
      )}
    </>
  );
  return (
    <Card id="log" title={text.log} {...{ note, actions }}>
      {error && <p class="banner wrong">{error}</p>}
      {!entries && !error && <p class="quiet waiting">{text.loadingLog}</p>}
      {entries && shown.length === 0 && (
        <p class="quiet">{text.noEntries[entries.length === 0 ? "info" : level]}</p>
      )}
      {shown.length > 0 && (
        <div class="log-scroll" tabIndex={0} role="group" aria-label={text.logOrder}>
          <ol class="log" reversed>
            {shown.toReversed().map((entry) => (
              <Line key={entry.id} {...entry} />
            ))}
          </ol>
        </div>
      )}
    </Card>
  );
}

/** Entries of a level and of those above it. */
export function atLeast(entries: readonly LogEntry[], level: Level): LogEntry[] {
  const least = LEVELS.indexOf(level);
  return entries.filter((entry) => LEVELS.indexOf(entry.level) >= least);
}

/** Entries as lines of text, oldest first. */
export function textOf(entries: readonly LogEntry[]): string {
  return entries
    .map(({ at, level, attempt, text, details }) => {
      const line = `${at} ${level} [attempt ${attempt}] ${text}`;
      return details ? `${line}\n${details}` : line;
    })
    .join("\n");
}

function Line({ at, level, attempt, text: message, details }: LogEntry) {
  return (
    <li class={`log-${level}`}>
      <time class="quiet" dateTime={at} title={dateTime(at)}>
        {new Date(at).toLocaleTimeString(undefined, { hour12: false })}
      </time>
      <span class="quiet log-attempt">{attempt > 0 ? text.attempt(attempt) : ""}</span>
      <div class="log-text">
        {level !== "info" && <b>{level === "error" ? text.error : text.warning}: </b>}
        {details ? (
          <details>
            <summary>{message}</summary>
            <pre>{details}</pre>
          </details>
        ) : (
          message
        )}
      </div>
    </li>
  );
}
