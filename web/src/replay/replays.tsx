/** Load replays, which workers render on request. */

import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { type Replay, decodeReplay } from "../decode/replay";
import { setNewest } from "../store/cache";
import { poll } from "../store/polling";
import { text } from "./text";
import "./replay.css";

interface Rendered {
  /** In the order of the request; null until all are rendered. */
  replays: Replay[] | null;
  note: string | null;
  error: string | null;
}

const cache = new Map<string, Replay>();

interface State {
  requested: string;
  loaded: ReadonlyMap<string, Replay>;
  note: string | null;
  error: string | null;
}

const NOTHING: Omit<State, "requested"> = { loaded: new Map(), note: null, error: null };

/** Replays of creatures; requests are repeated until they are rendered. */
export function useReplays(shas: string[]): Rendered {
  const requested = shas.join();
  const [state, setState] = useState<State>({ ...NOTHING, requested });
  useEffect(() => {
    const change = (part: Partial<State>) => setState((old) => ({ ...old, ...part }));
    const add = (sha: string, replay: Replay) => {
      setNewest(cache, sha, replay);
      setState((old) => ({ ...old, loaded: new Map(old.loaded).set(sha, replay) }));
    };
    setState({ ...NOTHING, requested });
    const stops = shas.map((sha) => {
      const known = cache.get(sha);
      if (known) return add(sha, known);
      return poll(async () => decoded(await api.readReplay(sha)), {
        value: (replay) => add(sha, replay),
        note: (note) => change({ note }),
        error: (error) => change({ error }),
      });
    });
    return () => stops.forEach((stop) => stop?.());
  }, [requested]);
  const { loaded, note, error } = state.requested === requested ? state : NOTHING;
  const replays = shas.flatMap((sha) => loaded.get(sha) ?? []);
  return { replays: replays.length === shas.length ? replays : null, note, error };
}

const decoded = (bytes: ArrayBuffer | null) => bytes && decodeReplay(bytes);

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
