/** JSON that people wrote. */

import type { Json } from "../api/types";

const TOKENS = /("(?:[^"\\]|\\.)*")(\s*:)?|[{}[\]]/g;

/**
 * The value of a JSON text. Throw a `SyntaxError` for text that is none, or where an object has a name
 * twice: `JSON.parse` would take the last one, and nobody would learn that the first was dropped.
 */
export function parseJson(text: string): Json {
  const value = JSON.parse(text) as Json;
  // The text is valid now, so a string is a name where a colon follows it.
  const names: Set<string>[] = [];
  for (const [token, quoted, colon] of text.matchAll(TOKENS)) {
    if (token === "{" || token === "[") names.push(new Set());
    else if (token === "}" || token === "]") names.pop();
    else if (colon) {
      const name = JSON.parse(quoted!) as string;
      if (names.at(-1)!.has(name)) throw new SyntaxError(`“${name}” is given twice`);
      names.at(-1)!.add(name);
    }
  }
  return value;
}
