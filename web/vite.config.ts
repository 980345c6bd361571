import { defineConfig } from "vitest/config";

export default defineConfig({
  build: {
    target: "es2022",
    assetsDir: "assets",
    reportCompressedSize: true,
    // One chunk, loaded first: the styles of ui/ stand before those of every page.
    rolldownOptions: { output: { codeSplitting: { groups: [{ name: "ui", test: /\/src\/ui\// }] } } },
  },
  server: {
    host: "127.0.0.1",
    fs: { allow: [".."] }, // docs/glossary.md
    proxy: { "/api": "http://127.0.0.1:8000" },
  },
  test: {
    include: ["src/**/*.test.ts"],
    environment: "node",
    globalSetup: ["scripts/experiments.mjs"],
  },
});
