/** The way to a new run that begins from creatures. */

import { sharedSlug } from "../api/address";
import { useRefusal } from "../store/principal";
import { forkAddress } from "../store/draft";

interface Props {
  /** Whose elites; null where no run is known. */
  run: string | null;
  /** One of them, or which cells', after which generation; without: all, as they are. */
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
  const address = run ? forkAddress(run, which) : [["begin", creature!]];
  return (
    <a
      class={inline ? "" : "button"}
      href={`/new?${new URLSearchParams(address as string[][])}`}
      title={title}
    >
      Fork
    </a>
  );
}
