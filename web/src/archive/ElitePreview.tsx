/** The replay of an elite, shown once the pointer rests on it. */

import { useLayoutEffect, useState } from "preact/hooks";
import { ReplayLoop } from "../replay/ReplayLoop";
import { useReplays } from "../replay/replays";
import { text } from "./text";

/** Delay of a request, so that a moving pointer requests no replays. */
const HOVER_MS = 12;

export function ElitePreview({ sha }: { sha: string }) {
  const [requested, setRequested] = useState<string | null>(null);
  // A layout effect saves the wait for the next frame.
  useLayoutEffect(() => {
    const timer = setTimeout(() => setRequested(sha), HOVER_MS);
    return () => clearTimeout(timer);
  }, [sha]);
  const { replays, error } = useReplays(requested === sha ? [sha] : []);
  const replay = replays?.[0];
  return (
    <div class="inset" data-inset>
      {replay ? (
        <ReplayLoop key={sha} replay={replay} name={text.inset} onFirst={markInset} />
      ) : (
        <p>{error ?? text.simulating}</p>
      )}
    </div>
  );
}

/** Read by the benchmark of the page. */
function markInset(): void {
  performance.clearMarks("inset");
  performance.mark("inset");
}
