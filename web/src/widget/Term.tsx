/** A title without its definition, in place of ui/Term.tsx: the glossary stays on the page. */

import type { ComponentChildren } from "preact";

interface Props {
  name: string;
  children?: ComponentChildren;
}

export const Term = ({ name, children }: Props) => <>{children ?? name}</>;
