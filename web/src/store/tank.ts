/** The creatures of the tank, read again as runs go on. */

import { useEffect, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Tank } from "../api/types";
import { SLOW_MS, type Loaded } from "./fetch";
import { useThrottled } from "./polling";
import { useStore } from "./store";

export function useTank(limit: number): Loaded<Tank> {
  // Every event of a run may bring new elites, or a run into or out of the bin.
  const changed = useThrottled(
    useStore((state) => state.eventCount),
    SLOW_MS,
  );
  const [loaded, setLoaded] = useState<Loaded<Tank>>({ value: null, error: null });
  const latest = useRef(0);
  useEffect(() => {
    const number = ++latest.current;
    api.readTank(limit).then(
      (value) => number === latest.current && setLoaded({ value, error: null }),
      (error) => setLoaded((old) => ({ ...old, error: old.value ? null : messageOf(error) })),
    );
  }, [limit, changed]);
  return loaded;
}
