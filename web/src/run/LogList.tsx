/** Log entries, newest first. */

import type { LogEntry } from "../api/types";
import { moment } from "../ui/format";
import { text } from "./text";

export const LEVELS = ["info", "warning", "error"] as const;
export type Level = (typeof LEVELS)[number];

/** Entries of a level and of those above it. */
export function atLeast(entries: readonly LogEntry[], level: Level): LogEntry[] {
  const least = LEVELS.indexOf(level);
  return entries.filter((entry) => LEVELS.indexOf(entry.level) >= least);
}

/** Entries as lines of text, oldest first. */
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

function Line({ at, level, attempt, text: message }: LogEntry) {
  const [first, ...more] = summaryOf(message);
  return (
    <li class={`log-${level}`}>
      <time dateTime={at} title={moment(at)}>
        {new Date(at).toLocaleTimeString(undefined, { hour12: false })}
      </time>
      <span class="quiet log-attempt">{attempt > 0 ? text.attempt(attempt) : ""}</span>
      <div class="log-text">
        {level !== "info" && <b>{level === "error" ? text.error : text.warning}: </b>}
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

/** The last line of a traceback as its summary, then all lines. */
export function summaryOf(message: string): [string, ...string[]] {
  const lines = message.trim().split("\n");
  if (lines.length === 1) return [lines[0]!];
  const [begin] = lines[0]!.split(":");
  return [`${begin}: ${lines.at(-1)}`, ...lines];
}
