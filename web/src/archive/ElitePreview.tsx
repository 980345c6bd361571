/** The replay of an elite, shown once the pointer rests on it. */

import { useLayoutEffect, useState } from "preact/hooks";
import { ReplayInset } from "../replay/Inset";
import { useReplays } from "../replay/recordings";
import { text } from "./text";

/** A moving pointer requests no replays. */
const HOVER_MS = 12;

export function ElitePreview({ sha }: { sha: string }) {
  const [wanted, setWanted] = useState<string | null>(null);
  // Before the next frame, each of which would be waited for.
  useLayoutEffect(() => {
    const timer = setTimeout(() => setWanted(sha), HOVER_MS);
    return () => clearTimeout(timer);
  }, [sha]);
  const { replays, error } = useReplays(wanted === sha ? [sha] : []);
  const replay = replays?.[0] ?? null;
  return <ReplayInset replay={replay} note={error ?? text.simulating} />;
}
