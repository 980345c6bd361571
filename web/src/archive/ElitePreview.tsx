/** An elite, swimming, shown once the pointer rests on it. */

import { useLayoutEffect, useState } from "preact/hooks";
import { SwimmingBody } from "../replay/SwimmingBody";
import { loadedStream, usePoseStream } from "../store/poses";
import { text } from "./text";

/** Delay of a request, so that a moving pointer requests nothing. */
const HOVER_MS = 12;

export function ElitePreview({ sha }: { sha: string }) {
  const [requested, setRequested] = useState<string | null>(null);
  // A layout effect saves the wait for the next frame.
  useLayoutEffect(() => {
    const timer = setTimeout(() => setRequested(sha), HOVER_MS);
    return () => clearTimeout(timer);
  }, [sha]);
  const wanted = requested === sha || loadedStream(sha) ? sha : null;
  const { stream, rendering, error } = usePoseStream(wanted);
  return (
    <div class="inset" data-inset>
      {stream ? (
        <SwimmingBody key={sha} stream={stream} label={text.inset} path onFirst={markInset} />
      ) : (
        <p>{error ?? (rendering && text.simulating)}</p>
      )}
    </div>
  );
}

/** Read by the benchmark of the page. */
function markInset(): void {
  performance.clearMarks("inset");
  performance.mark("inset");
}
