/** An invitation to the tour, shown on the first visit. */

import { useStore } from "../store/store";
import { wasGuided } from "../archive/guide";
import { text } from "./text";

export function Welcome() {
  const demonstration = useStore((state) => [...state.runs.values()].find((run) => run.demonstration));
  if (wasGuided() || !demonstration) return null;
  return (
    <p class="banner welcome">
      {text.welcome(true)} <a href={`/runs/${demonstration.id}`}>{text.tour}</a>
    </p>
  );
}
