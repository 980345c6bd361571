/** Definitions of terms, read from docs/glossary.md when the page is built. */

import text from "../../../docs/glossary.md?raw";

/** Each `## term` with its paragraph, as plain text. */
export function parse(markdown: string): Map<string, string> {
  const entries = markdown.split(/^## /m).slice(1);
  return new Map(
    entries.map((entry) => {
      const [term, ...lines] = entry.trim().split("\n");
      const plain = lines.join(" ").replace(/`|\[([^\]]*)\]\([^)]*\)/g, "$1");
      return [term!.toLowerCase(), plain.trim()];
    }),
  );
}

const GLOSSARY = parse(text);

/** The definition of a term, ignoring case; undefined for an unknown term. */
export const define = (term: string): string | undefined => GLOSSARY.get(term.toLowerCase());
