/** A title with the definition of its term in the glossary as a tooltip. */

import { define } from "./glossary";

/** Plurals and units in a title are ignored: “Evaluations/s” is explained as “evaluation”. */
export function Term({ name }: { name: string }) {
  const about = define(name) ?? define(name.replace(/s?(\/s)?$/, ""));
  if (!about) return <>{name}</>;
  return (
    <span class="term" title={about}>
      {name}
    </span>
  );
}
