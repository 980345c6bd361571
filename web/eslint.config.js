/** Lint rules: the import order between folders, no cycles, and the size of files and functions. */

import { readdirSync } from "node:fs";
import { createNodeResolver, importX } from "eslint-plugin-import-x";
import tseslint from "typescript-eslint";

/** A folder imports only from folders in earlier lines; those in one line do not import each other. */
const LAYERS = [
  ["decode"],
  ["api"],
  ["store"],
  ["ui"],
  ["charts"],
  ["replay", "publish"],
  ["archive", "creature"],
  ["run"],
  ["sweeps"],
  ["compare", "new-run", "runs", "settings", "shares", "workers"],
  ["app"],
];

const unlisted = readdirSync(new URL("src", import.meta.url)).filter((name) => !LAYERS.flat().includes(name));
if (unlisted.length > 0) throw new Error(`src/${unlisted[0]} has no place in LAYERS of eslint.config.js.`);

const zones = LAYERS.slice(0, -1).flatMap((layer, i) =>
  layer.map((target) => ({
    target: `./src/${target}`,
    from: LAYERS.slice(i)
      .flat()
      .filter((name) => name !== target)
      .map((name) => `./src/${name}/${name === "api" ? "!(types.ts|schema.d.ts)" : "**/*"}`),
    message: `${target}/ must not import from this folder: see LAYERS in eslint.config.js.`,
  })),
);

export default tseslint.config(
  {
    files: ["src/**/*.{ts,tsx}"],
    ignores: ["src/api/schema.d.ts"],
    languageOptions: { parser: tseslint.parser },
    plugins: { "import-x": importX },
    settings: {
      "import-x/resolver-next": [createNodeResolver({ extensions: [".ts", ".tsx", ".d.ts", ".js", ".css"] })],
      "import-x/parsers": { "@typescript-eslint/parser": [".ts", ".tsx"] },
    },
    rules: {
      "import-x/no-restricted-paths": ["error", { zones }],
      "import-x/no-unresolved": ["error", { ignore: ["^uplot/dist/"] }],
      "import-x/no-cycle": "error",
      "max-lines": ["error", 300],
    },
  },
  {
    files: ["src/**/*.{ts,tsx}"],
    ignores: ["src/**/*.test.ts", "src/api/schema.d.ts"],
    rules: { "max-lines-per-function": ["error", 50] },
  },
);
