/** A badge with the verdict of a creature's audit, explained by the glossary. */

import { Term } from "./Term";
import { text } from "./text";

interface Props {
  /** Null without an audit. */
  trusted: boolean | null;
  /** The address of the audit. */
  href?: string;
}

const LOOKS = {
  true: ["finished", "✓", text.trusted],
  false: ["failed", "✕", text.notTrusted],
  null: ["", "○", text.notAudited],
} as const;

export function TrustBadge({ trusted, href }: Props) {
  const [kind, sign, word] = LOOKS[`${trusted}`];
  const content = { class: `badge signed ${kind}`, children: [<i aria-hidden="true">{sign}</i>, word] };
  return (
    <Term name={text.audit}>
      {href ? <a href={href} {...content} /> : <span tabIndex={0} {...content} />}
    </Term>
  );
}
