/** A list of names with their values. */

import type { ComponentChildren } from "preact";
import { Term } from "./Term";

export type Fact = readonly [name: string, value: ComponentChildren];

/** `kind` is a CSS class; entries that are null or false are left out. */
export function Facts({ kind = "facts", of }: { kind?: string; of: readonly (Fact | null | false)[] }) {
  const facts = of.filter((fact): fact is Fact => Boolean(fact));
  return (
    <dl class={kind}>
      {facts.map(([name, value]) => (
        <div key={name}>
          <dt>
            <Term name={name} />
          </dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
  );
}
