/** An invitation to the tour, shown on the first visit. */

import { hasArchive } from "../store/fetch";
import { useStore } from "../store/store";
import { wasGuided } from "../archive/guide";
import { text } from "./text";

export function Welcome() {
  const first = useStore((state) => {
    const searches = [...state.runs.values()].filter(hasArchive);
    return searches.find((run) => run.demonstration) ?? searches[0];
  });
  if (wasGuided() || !first) return null;
  return (
    <p class="banner welcome">
      {text.welcome(first.demonstration)} <a href={`/runs/${first.id}`}>{text.tour}</a>
    </p>
  );
}
