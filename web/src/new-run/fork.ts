/** A new run that begins from creatures of another. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { ForkRequest } from "../api/types";
import type { ForkSource, Draft } from "../store/draft";
import { mergePatch, withInitial } from "./initialCreatures";
import type { Alternative } from "./submission";

export interface Fork {
  /** Null where there is none to give. */
  name: string | null;
  onName: (name: string) => void;
  /** What is to be sent; null where the spec alone says it all. */
  sent: Alternative | null;
}

export function useFork({ base, spec }: Draft): Fork {
  const [name, onName] = useState("");
  useEffect(() => onName(""), [base]);
  const sent = useMemo(() => forkOf({ base, spec }, name), [base, spec, name]);
  return { name: sent && name, onName, sent };
}

/** The request for a fork, which says only what is to differ. */
export function forkOf({ base, spec }: Draft, name: string): Alternative | null {
  const { run = null, at = null } = base.fork ?? {};
  if (run === null) return null;
  // Typed as JSON the names would be passed over.
  const patch = mergePatch(withInitial(base.spec, []), withInitial(spec, []));
  const then = at === null ? {} : { generation: at };
  return { fork: { run, from: fromOf(base.fork!), ...then, spec: patch, name: name.trim() || null } };
}

function fromOf({ creature, cells }: ForkSource): ForkRequest["from"] {
  if (creature !== null) return { creatures: [creature] };
  return cells === null ? { archive: true } : { cells };
}
