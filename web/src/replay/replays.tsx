/** Load replays, which workers render on request. */

import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import * as api from "../api/client";
import { type Replay, decodeReplay } from "../decode/replay";
import { setNewest } from "../store/cache";
import { usePolled } from "../store/polling";
import { text } from "./text";
import "./replay.css";

interface Rendered {
  /** In the order of the request; null until all are rendered. */
  replays: Replay[] | null;
  note: string | null;
  error: string | null;
}

const cache = new Map<string, Replay>();

/** Replays of creatures; requests are repeated until they are rendered. */
export function useReplays(shas: string[]): Rendered {
  const requested = shas.join();
  // The cache may drop a large replay before another one is there.
  const loaded = useMemo(() => new Map<string, Replay>(), [requested]);
  const load = async (sha: string) => {
    const bytes = loaded.has(sha) || cache.has(sha) ? null : await api.readReplay(sha);
    const replay = loaded.get(sha) ?? cache.get(sha) ?? (bytes && decodeReplay(bytes));
    if (!replay) return null;
    setNewest(cache, sha, replay);
    loaded.set(sha, replay);
    return replay;
  };
  const ask = async () => {
    const replays = (await Promise.all(shas.map(load))).filter((replay) => replay !== null);
    return replays.length === shas.length ? { requested, replays } : null;
  };
  const { value, note, error } = usePolled(ask, [requested]);
  return { replays: value?.requested === requested ? value.replays : null, note, error };
}

interface StatusProps extends Rendered {
  what: string;
  /** Shown in place of the ripple. */
  children?: ComponentChildren;
}

/** Shown while replays are rendered. */
export function ReplayStatus({ replays, note, error, what, children }: StatusProps) {
  if (error) return <p class="banner wrong">{error}</p>;
  if (replays) return null;
  return (
    <div class="stage rendering" role="status">
      {children}
      <p>
        {!children && <span class="ripple" aria-hidden="true" />}
        <span>{what}</span>
        <span class="small">{note ? text.retrying(note) : text.firstReplay}</span>
      </p>
    </div>
  );
}
