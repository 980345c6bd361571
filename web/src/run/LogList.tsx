/** The entries of a journal, the newest first. */

import type { LogEntry } from "../api/types";
import { moment } from "../ui/format";

export const LEVELS = ["info", "warning", "error"] as const;
export type Level = (typeof LEVELS)[number];

/** Entries of a level and of those above it. */
export function atLeast(entries: readonly LogEntry[], level: Level): LogEntry[] {
  const least = LEVELS.indexOf(level);
  return entries.filter((entry) => LEVELS.indexOf(entry.level) >= least);
}

/** As lines of text, in the order in which it happened. */
export function textOf(entries: readonly LogEntry[]): string {
  return entries
    .map(({ at, level, attempt, text }) => `${at} ${level} [attempt ${attempt}] ${text}`)
    .join("\n");
}

export function LogList({ entries }: { entries: readonly LogEntry[] }) {
  return (
    <ol class="log" reversed>
      {[...entries].reverse().map((entry) => (
        <Line key={entry.id} {...entry} />
      ))}
    </ol>
  );
}

function Line({ at, level, attempt, text }: LogEntry) {
  const [first, ...more] = summaryOf(text);
  return (
    <li class={`log-${level}`}>
      <time dateTime={at} title={moment(at)}>
        {new Date(at).toLocaleTimeString(undefined, { hour12: false })}
      </time>
      <span class="quiet log-attempt">{attempt > 0 ? `attempt ${attempt}` : ""}</span>
      <div class="log-text">
        {level !== "info" && <b>{level === "error" ? "Error" : "Warning"}: </b>}
        {more.length === 0 ? (
          first
        ) : (
          <details>
            <summary>{first}</summary>
            <pre>{more.join("\n")}</pre>
          </details>
        )}
      </div>
    </li>
  );
}

/** Of a traceback the last line, which says what went wrong; then the whole. */
export function summaryOf(text: string): [string, ...string[]] {
  const lines = text.trim().split("\n");
  if (lines.length === 1) return [lines[0]!];
  const [begin] = lines[0]!.split(":");
  return [`${begin}: ${lines.at(-1)}`, ...lines];
}
