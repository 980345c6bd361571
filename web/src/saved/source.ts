/** The kernel and the script of its web workers within a saved page; see simulate/source.ts. */

import { DATA, unpacked } from "../offline/packing";
import SimulatorWorker from "../simulate/worker?worker&inline";

const kernel = document.getElementById(DATA.kernel);

export const isInstalled = kernel !== null;
export const kernelBytes = () => unpacked(kernel!.textContent);
export const startWorker = () => new SimulatorWorker();
