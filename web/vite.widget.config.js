/** Builds the module and the styles of the notebook widgets into the Python package. */

import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const path = (name) => fileURLToPath(new URL(name, import.meta.url));

/** Everything in one module, and all styles within the widgets, so that the notebook keeps its own. */
const forNotebooks = {
  name: "for-notebooks",
  enforce: "post",
  generateBundle(_, bundle) {
    const names = Object.keys(bundle).sort();
    if (names.join() !== "widget.css,widget.js") {
      throw new Error(`A widget must be a module and its styles, but there are ${names.join(", ")}.`);
    }
    const styles = bundle["widget.css"];
    styles.source = `.microcosmos{${String(styles.source).replaceAll(":root", ".widget")}}`;
  },
};

export default defineConfig({
  publicDir: false,
  resolve: {
    alias: [
      { find: /^\.\.\/store\/poses$/, replacement: path("src/widget/poses.ts") },
      { find: /^\.\.\/ui\/Term$/, replacement: path("src/widget/Term.tsx") },
      { find: /^\.\/scheme$/, replacement: path("src/widget/scheme.ts") },
    ],
  },
  plugins: [forNotebooks],
  build: {
    target: "es2022",
    outDir: path("../engine/microcosmos/widgets"),
    emptyOutDir: false,
    cssCodeSplit: false,
    cssTarget: "chrome123",
    modulePreload: false,
    rolldownOptions: {
      input: path("src/widget/main.tsx"),
      preserveEntrySignatures: "strict",
      output: {
        format: "es",
        codeSplitting: false,
        entryFileNames: "widget.js",
        assetFileNames: "widget.[ext]",
      },
    },
  },
});
