/** The log of a run, live. */

import type { Run } from "../api/types";
import { useLog } from "../store/log";
import { setQuery } from "../store/router";
import { Select } from "../ui/Select";
import { count } from "../ui/format";
import { LEVELS, LogList, atLeast, textOf } from "./LogList";
import { Card } from "../ui/Page";
import { copyText } from "../ui/clipboard";
import { text } from "./text";
import "./log.css";

export function LogCard({ run, query }: { run: Run; query: URLSearchParams }) {
  const { value: entries, error, earlier } = useLog(run);
  const level = LEVELS.find((name) => name === query.get("level")) ?? "info";
  const shown = atLeast(entries ?? [], level);
  const head = (
    <>
      {shown.length > 0 && <span class="quiet">{text.entries(count(shown.length), earlier !== null)}</span>}
      {earlier && (
        <button class="slim" onClick={earlier}>
          {text.showEarlier}
        </button>
      )}
      <span class="spring" />
      <Select
        title={text.show}
        choices={LEVELS.map((name) => [name, text.levels[name]])}
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
    <Card id="log" title={text.log} head={head}>
      {error && <p class="banner wrong">{error}</p>}
      {!entries && !error && <p class="quiet waiting">{text.loadingLog}</p>}
      {entries && shown.length === 0 && (
        <p class="quiet">{entries.length === 0 ? text.logEmpty : text.noEntries[level]}</p>
      )}
      {shown.length > 0 && (
        <div class="log-scroll" tabIndex={0} role="group" aria-label={text.logOrder}>
          <LogList entries={shown} />
        </div>
      )}
    </Card>
  );
}
