/**
 * Builds the page of a creature or a motion that needs no server: script and styles in one file, without
 * its data. The page fills in dist/saved.html, the Python library its copy, widget.html.
 */

import { createHash } from "node:crypto";
import { writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const path = (name) => fileURLToPath(new URL(name, import.meta.url));
const hash = (content) => `'sha256-${createHash("sha256").update(content).digest("base64")}'`;

/** Nothing but the file's own script and styles runs, and nothing is requested. */
const policy = (script, style) =>
  [
    "default-src 'none'",
    `script-src ${hash(script)} 'wasm-unsafe-eval'`,
    `style-src ${hash(style)}`,
    "worker-src blob:",
    "img-src data:",
    "base-uri 'none'",
    "form-action 'none'",
  ].join("; ");

const template = (script, style) => `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${policy(script, style)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title><!--title--></title>
<style>${style}</style>
</head>
<body>
<div id="app"></div>
<!--data-->
<script>${script}</script>
</body>
</html>
`;

/** Put the only chunk and the only styles into the page. */
const inOneFile = {
  name: "in-one-file",
  enforce: "post",
  generateBundle(_, bundle) {
    let [script, style] = ["", ""];
    for (const [name, part] of Object.entries(bundle)) {
      if (part.type === "chunk") script += part.code;
      else if (name.endsWith(".css")) style += part.source;
      else throw new Error(`A saved page must hold everything, but ${name} stands beside it.`);
      delete bundle[name];
    }
    const source = template(script.replaceAll("</script", "<\\/script"), style);
    this.emitFile({ type: "asset", fileName: "saved.html", source });
    writeFileSync(path("../engine/microcosmos/widgets/widget.html"), source); // Outside of outDir.
  },
};

export default defineConfig({
  publicDir: false,
  resolve: { alias: [{ find: /^\.\.?\/(simulate\/)?source$/, replacement: path("src/saved/source.ts") }] },
  plugins: [inOneFile],
  build: {
    target: "es2022",
    emptyOutDir: false,
    cssCodeSplit: false,
    modulePreload: false,
    rolldownOptions: { input: path("src/saved/main.tsx"), output: { format: "iife" } },
  },
});
