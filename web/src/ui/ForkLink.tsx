/** A link to a new run that starts from creatures. */

import { sharedSlug } from "../api/address";
import { useRefusal } from "../store/principal";
import { forkAddress } from "../store/draft";
import { text } from "./text";

interface Props {
  /** The run with the elites; null if unknown. */
  run: string | null;
  /** One creature, or cells and a generation; by default all current elites. */
  creature?: string;
  cells?: string | null;
  at?: number | null;
  title: string;
  /** Within a line of text. */
  inline?: boolean;
}

export function ForkLink({ run, creature, cells, at = null, title, inline = false }: Props) {
  if (useRefusal() || sharedSlug) return null;
  const which = { creature, cells, at: at === null ? null : String(at) };
  const address = run ? forkAddress(run, which) : [["initial", creature!]];
  return (
    <a
      class={inline ? "" : "button"}
      href={`/new?${new URLSearchParams(address as string[][])}`}
      title={title}
    >
      {text.fork}
    </a>
  );
}
