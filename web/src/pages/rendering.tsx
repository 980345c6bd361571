/** Replays that a worker renders when they are asked for. */

import { useEffect, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import { type Replay, decodeReplay } from "../frames/replay";
import { poll } from "../live/polling";

interface State {
  found: Record<string, Replay>;
  note: string | null;
  error: string | null;
}

interface Rendered {
  /** In the order in which they were asked for, once all of them are there. */
  replays: Replay[] | null;
  note: string | null;
  error: string | null;
}

/** Creatures' replays, asked for until they have been rendered. */
export function useReplays(shas: string[]): Rendered {
  const [{ found, note, error }, setState] = useState<State>({ found: {}, note: null, error: null });
  useEffect(() => {
    const change = (part: Partial<State>) => setState((old) => ({ ...old, ...part }));
    const read = (sha: string, bytes: ArrayBuffer) => {
      try {
        const replay = decodeReplay(bytes);
        setState((old) => ({ ...old, found: { ...old.found, [sha]: replay } }));
      } catch (problem) {
        change({ error: messageOf(problem) });
      }
    };
    const ends = shas.map((sha) =>
      poll(() => api.readReplay(sha), {
        value: (bytes) => read(sha, bytes),
        note: (note) => change({ note }),
        error: (error) => change({ error }),
      }),
    );
    return () => ends.forEach((end) => end());
  }, [shas.join()]);
  const there = shas.every((sha) => found[sha]);
  return { replays: there ? shas.map((sha) => found[sha]!) : null, note, error };
}

/** What to see until then. */
export function Rendering({ replays, note, error, what }: Rendered & { what: string }) {
  if (error) return <p class="banner wrong">{error}</p>;
  if (replays) return null;
  return (
    <div class="stage rendering" role="status">
      <p>
        <span class="ripple" aria-hidden="true" />
        <span>{what}</span>
        <span class="small">{note ? `${note} Trying again …` : "The first one takes longest."}</span>
      </p>
    </div>
  );
}
