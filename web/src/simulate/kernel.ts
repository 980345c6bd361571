/** The native kernel as WebAssembly: its calls, with arrays in its memory. */

import type { Items } from "../decode/evaluation";
import { text } from "./text";

/** An array in the memory of the kernel, of items of four bytes, and for how many there is room. */
export interface Area {
  address: number;
  items: number;
  room: number;
}

/** Results in their order, each under its name. */
export type Results = (Area & { name: string })[];

export type Call = "develop" | "rollout" | "summarise" | "cross";
/** The operand at a place of a call, whose name and number of items the kernel gives. */
export type Operands = (place: number, name: string, items: number) => Area | undefined;

type Exports = Record<Call, () => void> & {
  memory: WebAssembly.Memory;
  allocate: (bytes: number) => number;
  _initialize: () => void;
};

/** The part of a call that the kernel asks for while it runs. */
interface Asked {
  numbers: Record<string, number>;
  operands: Operands;
  results: Results;
  /** Areas that may hold the results. */
  reused: Results;
}

/** An instance with a memory of its own, which is freed with it. */
export class Kernel {
  private readonly exports: Exports;
  private asked: Asked | null = null;

  constructor(module: WebAssembly.Module) {
    const imports = { page: this.page(), ...system(module) };
    this.exports = new WebAssembly.Instance(module, imports).exports as unknown as Exports;
    this.exports._initialize();
  }

  /** Put an array into the memory. */
  put(values: Items): Area {
    const area = this.room(values.length);
    const view = values instanceof Float32Array ? this.floats(area) : this.integers(area);
    view.set(values);
    return area;
  }

  /** A copy of an array of numbers in the memory. */
  read(area: Area): Float32Array {
    return this.floats(area).slice();
  }

  /** An array of numbers itself, until the next call. */
  view(area: Area): Float32Array {
    return this.floats(area);
  }

  /** A copy of an array of integers in the memory. */
  readIntegers(area: Area): Int32Array {
    return this.integers(area).slice();
  }

  /** Carry out a call; its results are in the memory, over those of an earlier call if these are given. */
  call(name: Call, numbers: Record<string, number>, operands: Operands, reused: Results = []): Results {
    const results: Results = [];
    this.asked = { numbers, operands, results, reused };
    this.exports[name]();
    return results;
  }

  private page() {
    return {
      number: (name: number) => {
        const found = this.asked!.numbers[this.word(name)];
        if (found === undefined) throw new Error(text.noNumber(this.word(name)));
        return found;
      },
      operand: (place: number, name: number, items: number) => {
        const found = this.asked!.operands(place, this.word(name), items);
        if (found?.items !== items) throw new Error(text.wrongArray(this.word(name), items, found?.items));
        return found.address;
      },
      result: (place: number, name: number, items: number) => {
        const earlier = this.asked!.reused[place];
        // Nothing is freed: results whose size changes from call to call keep to the room that they have.
        const area = earlier && earlier.room >= items ? earlier : this.room(items);
        this.asked!.results[place] = { ...area, items, name: this.word(name) };
        return area.address;
      },
      refuse: (reason: number) => {
        throw new Error(text.refused(this.word(reason)));
      },
    };
  }

  private room(items: number): Area {
    // JavaScript sees an address beyond 2 GiB as a negative number.
    const address = this.exports.allocate(4 * items) >>> 0;
    if (address === 0) throw new Error(text.noMemory(4 * items));
    return { address, items, room: items };
  }

  // The memory may have grown: a view is made for each use.
  private floats = ({ address, items }: Area) => new Float32Array(this.exports.memory.buffer, address, items);
  private integers = ({ address, items }: Area) => new Int32Array(this.exports.memory.buffer, address, items);

  /** The text at an address, which a zero ends. */
  private word(address: number): string {
    const bytes = new Uint8Array(this.exports.memory.buffer, address);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }
}

/** Functions of an operating system, which the kernel needs only to report that it fails. */
function system(module: WebAssembly.Module): WebAssembly.Imports {
  const found: Record<string, Record<string, () => never>> = {};
  for (const { module: owner, name } of WebAssembly.Module.imports(module)) {
    if (owner === "page") continue;
    (found[owner] ??= {})[name] = () => {
      throw new Error(text.noSystem(name));
    };
  }
  return found;
}
