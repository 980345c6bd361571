/** The kernel and the scripts of web workers within a saved page; see simulate/source.ts. */

import { DATA, unpacked } from "../offline/packing";
import Evaluator from "../simulate/worker?worker&inline";
import Swimmer from "../simulate/swimWorker?worker&inline";

const kernel = document.getElementById(DATA.kernel);

export const isInstalled = kernel !== null;
export const kernelBytes = () => unpacked(kernel!.textContent);
export const evaluator = () => new Evaluator();
export const swimmer = () => new Swimmer();
