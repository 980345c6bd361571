/** Evaluate creatures with the built page's worker: `node evaluate.mjs ASSETS INPUTS ...` prints its answers. */

import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

const [assets, ...files] = process.argv.slice(2);
const built = (name) =>
  join(
    assets,
    readdirSync(assets).find((file) => name.test(file)),
  );
const module = new WebAssembly.Module(readFileSync(built(/^kernel-.*\.wasm$/)));
const answers = [];
globalThis.self = globalThis;
globalThis.postMessage = (answer) => "share" in answer || answers.push(answer);
await import(built(/^worker-.*\.js$/));
for (const file of files) {
  globalThis.onmessage({
    data: { module, inputs: new Uint8Array(readFileSync(file)).buffer },
  });
}
// JSON writes −0 as 0.
console.log(JSON.stringify(answers, (_, value) => (Object.is(value, -0) ? "-0" : value)));
