/** The way to a new run that begins from creatures. */

import { share } from "../api/place";

interface Props {
  /** Whose elites; null where no run is known. */
  run: string | null;
  /** One of them; all elites without it. */
  creature?: string;
  title: string;
  /** Within a line of text. */
  inline?: boolean;
}

export function ForkLink({ run, creature, title, inline = false }: Props) {
  if (share) return null;
  const of = run ? `fork=${run}` : `begin=${creature}`;
  const whom = run && creature ? `&creature=${creature}` : "";
  return (
    <a class={inline ? "" : "button"} href={`/new?${of}${whom}`} title={title}>
      Fork
    </a>
  );
}
