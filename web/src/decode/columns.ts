/** Columns of archives as bytes: a JSON header, then one little-endian array after another. */

import { readHeader } from "./header";

export const COLUMNS = "application/vnd.microcosmos.columns";

type Kind = "uint8" | "int8" | "int32" | "float64";

interface Column {
  name: string;
  type: Kind;
  shape: number[];
}

interface Header {
  columns: Column[];
}

type Values = Uint8Array | Int8Array | Int32Array | Float64Array;

/** Arrays in the byte order of the machine, which is little-endian wherever browsers run. */
const ARRAYS = { uint8: Uint8Array, int8: Int8Array, int32: Int32Array, float64: Float64Array };
const ALIGNMENT = 8;
const MEASURE = "measures.";
const VERDICTS: (boolean | null)[] = [false, true];
const HEX = Array.from({ length: 256 }, (_, byte) => byte.toString(16).padStart(2, "0"));

/** The header and the arrays, which are views of the bytes. */
export function readColumns(buffer: ArrayBuffer) {
  const { header, start } = readHeader<Header>(buffer, "columns", "microcosmos-columns/1");
  let at = start;
  const columns = header.columns.map(({ name, type, shape }) => {
    const count = shape.reduce((product, size) => product * size, 1);
    const values: Values = new ARRAYS[type](buffer, at, count);
    at += Math.ceil(values.byteLength / ALIGNMENT) * ALIGNMENT;
    return { name, values, shape };
  });
  return { header: header as Header & Record<string, unknown>, columns };
}

/** The document that JSON has in place of these bytes. */
export function decodeColumns<T>(buffer: ArrayBuffer): T {
  const { header, columns } = readColumns(buffer);
  const found: Record<string, unknown> = { ...header };
  delete found.format;
  delete found.columns;
  const measures: Record<string, (number | null)[]> = {};
  for (const { name, values, shape } of columns) {
    if (name.startsWith(MEASURE)) measures[name.slice(MEASURE.length)] = numbers(values);
    else found[name] = decoded(name, values, shape);
  }
  return { ...found, measures } as T;
}

function decoded(name: string, values: Values, [length = 0, width]: number[]): unknown {
  if (name === "creature") return rows(values, length, width!).map(hexadecimal);
  if (name === "trusted") return Array.from(values, (value) => VERDICTS[value] ?? null);
  return width === undefined ? Array.from(values) : rows(values, length, width).map((row) => Array.from(row));
}

/** Not a number stands for an unknown value. */
const numbers = (values: Values) => Array.from(values, (value) => (Number.isNaN(value) ? null : value));

const rows = (values: Values, length: number, width: number) =>
  Array.from({ length }, (_, i) => values.subarray(i * width, (i + 1) * width));

export function hexadecimal(bytes: Values): string {
  let text = "";
  for (const byte of bytes) text += HEX[byte];
  return text;
}
