/** Provides the server's experiments to the tests. */

import { execFileSync } from "node:child_process";

const PYTHON = process.env.PYTHON ?? "../.venv/bin/python";

export default function setup(project) {
  const environment = { ...process.env, PYTHONPATH: "../engine:../server" };
  const options = { encoding: "utf8", env: environment, maxBuffer: 1 << 26 };
  const output = execFileSync(PYTHON, ["scripts/experiments.py"], options);
  project.provide("experiments", JSON.parse(output));
}
