/** Lint rules: the import order between folders, and the size of functions. */

import { readdirSync } from "node:fs";
import tseslint from "typescript-eslint";

/** A folder imports only from folders in earlier lines; those in one line do not import each other. */
const LAYERS = [
  ["decode"],
  ["api"],
  ["store"],
  ["ui"],
  ["charts"],
  ["replay", "publish", "simulate"],
  ["breeding", "offline", "statistics"],
  ["archive", "creature"],
  ["run"],
  ["sweeps", "tank"],
  ["compare", "new-run", "runs", "saved", "settings", "shares", "tree", "widget", "workers"],
  ["app"],
];

const unlisted = readdirSync(new URL("src", import.meta.url)).filter((name) => !LAYERS.flat().includes(name));
if (unlisted.length > 0) throw new Error(`src/${unlisted[0]} has no place in LAYERS of eslint.config.js.`);

/** Rules of one folder: it may import from earlier layers and from itself; wire types are for all. */
function order(folder, later) {
  const from = later.map((name) => (name === "api" ? "api/(?!types|schema)" : `${name}(/|$)`)).join("|");
  const path = `^(\\.\\./)+(${from})`;
  const message = `${folder}/ must not import from this folder: see LAYERS in eslint.config.js.`;
  return {
    files: [`src/${folder}/**/*.{ts,tsx}`],
    rules: {
      "no-restricted-imports": ["error", { patterns: [{ regex: path, message }] }],
      "no-restricted-syntax": [
        "error",
        { selector: `ImportExpression > Literal[value=/${path.replaceAll("/", "\\/")}/]`, message },
      ],
    },
  };
}

const orders = LAYERS.slice(0, -1).flatMap((layer, i) =>
  layer.map((folder) =>
    order(
      folder,
      LAYERS.slice(i)
        .flat()
        .filter((name) => name !== folder),
    ),
  ),
);

export default tseslint.config(
  { ignores: ["src/api/schema.d.ts", "dist/"] },
  {
    files: ["src/**/*.{ts,tsx}"],
    languageOptions: { parser: tseslint.parser },
  },
  ...orders,
  {
    files: ["src/**/*.{ts,tsx}"],
    ignores: ["src/**/*.test.ts"],
    rules: { "max-lines-per-function": ["error", 50] },
  },
);
