/** The sections of a form, with counts of errors and changes. */

import { countWithin } from "./document";
import type { FormState } from "./Entry";
import type { Section, Union } from "./fields";
import { text } from "./text";

interface Props {
  parts: (Section | Union)[];
  state: FormState;
}

export function Outline({ parts, state }: Props) {
  return (
    <nav class="outline" aria-label={text.sections}>
      {parts.map((part) => {
        const wrong = within(part, state.messages.keys(), parts);
        const changed = within(part, state.changed, parts);
        return (
          <button type="button" key={part.path} class="plain" onClick={() => go(part.path, state)}>
            {part.title}
            {wrong > 0 && <span class="wrong-text">{text.errors(wrong)}</span>}
            {wrong === 0 && changed > 0 && <span class="tally">{text.changed(changed)}</span>}
          </button>
        );
      })}
    </nav>
  );
}

/** Number of paths in a section; paths outside all sections count for the first. */
function within({ path }: Props["parts"][0], paths: Iterable<string>, parts: Props["parts"]): number {
  const all = [...paths];
  if (path) return countWithin(all, path);
  const others = parts.reduce((sum, part) => sum + (part.path ? countWithin(all, part.path) : 0), 0);
  return all.length - others;
}

function go(path: string, state: FormState): void {
  state.close(path, false);
  requestAnimationFrame(() => {
    const section = document.getElementById(`section-${path || "general"}`);
    section?.scrollIntoView({ block: "start" });
    section?.querySelector<HTMLElement>("input, select, textarea")?.focus({ preventScroll: true });
  });
}
