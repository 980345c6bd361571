/** A first visit: the way to an archive that explains itself. */

import { hasArchive } from "../store/fetch";
import { useStore } from "../store/store";
import { wasGuided } from "../archive/guide";

export function Welcome() {
  const first = useStore((state) => {
    const searches = [...state.runs.values()].filter(hasArchive);
    return searches.find((run) => run.demonstration) ?? searches[0];
  });
  if (wasGuided() || !first) return null;
  return (
    <p class="banner welcome">
      New here? {first.demonstration ? "The demonstration" : "A run"} fills an archive with the best swimmer
      of every kind. <a href={`/runs/${first.id}`}>Let it explain itself in a minute.</a>
    </p>
  );
}
