/** Links to files and to new runs that start from creatures. */

import { checkFile, downloadFile } from "../api/files";
import { showFailure } from "../store/toasts";
import { sharedSlug } from "../api/address";
import { useRefusal } from "../store/principal";
import { forkAddress, formatCreatures } from "../store/draft";
import { text } from "./text";

export function FileLink({ url, name, title }: { url: string; name: string; title?: string }) {
  const download = (event: MouseEvent) => {
    event.preventDefault();
    checkFile(url)
      .then(() => downloadFile(url))
      .catch(showFailure);
  };
  return (
    <a class="button" href={url} title={title} onClick={download}>
      {name}
    </a>
  );
}

interface Props {
  /** The run with the elites; null if unknown. */
  run: string | null;
  /** Creatures, or cells and a generation; by default all current elites. */
  creatures?: string[];
  cells?: string | null;
  at?: number | null;
  title: string;
  inline?: boolean;
}

export function ForkLink({ run, creatures, cells, at = null, title, inline = false }: Props) {
  if (useRefusal() || sharedSlug) return null;
  const which = {
    creature: creatures && formatCreatures(creatures),
    cells,
    at: at === null ? null : String(at),
  };
  const address = run ? forkAddress(run, which) : [["initial", creatures![0]!]];
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

/** The most creatures that swim side by side. */
export const MAX_SIDE_BY_SIDE = 6;

/** A link to two or more creatures side by side; nothing if they are too many. */
export function SideBySide({ creatures, title }: { creatures: readonly string[]; title: string }) {
  if (creatures.length < 2 || creatures.length > MAX_SIDE_BY_SIDE) return null;
  return (
    <a class="button" href={`/compare?creatures=${creatures.join()}`}>
      {title}
    </a>
  );
}
