/** Files as bytes: a JSON header after its length, then one little-endian array after another. */

export const COLUMNS = "application/vnd.microcosmos.columns";

type Kind = "uint8" | "int8" | "int32" | "float32" | "float64";

interface Column {
  name: string;
  type: Kind;
  shape: number[];
}

interface Header {
  columns: Column[];
}

export type Values = Uint8Array | Int8Array | Int32Array | Float32Array | Float64Array;

/** Arrays in the byte order of the machine, which is little-endian wherever browsers run. */
const ARRAYS = {
  uint8: Uint8Array,
  int8: Int8Array,
  int32: Int32Array,
  float32: Float32Array,
  float64: Float64Array,
};
const ALIGNMENT = 8;
const MEASURE = "measures.";
const VERDICTS: (boolean | null)[] = [false, true];
const HEX = Array.from({ length: 256 }, (_, byte) => byte.toString(16).padStart(2, "0"));

/** The header without its format, and the columns in their order. */
export function readColumns<T extends object>(buffer: ArrayBuffer) {
  const { header, start } = readHeader<T & Header>(buffer, "columns", "microcosmos-columns/1");
  const { columns: described, format: _, ...document } = header as T & Header & { format: string };
  let at = start;
  const columns = described.map(({ name, type, shape }) => {
    const count = shape.reduce((product, size) => product * size, 1);
    const values: Values = new ARRAYS[type](buffer, at, count);
    at += Math.ceil(values.byteLength / ALIGNMENT) * ALIGNMENT;
    return { name, shape, values };
  });
  return { document, columns };
}

/** The document that JSON has in place of these bytes. */
export function decodeColumns<T>(buffer: ArrayBuffer): T {
  const { document, columns } = readColumns<object>(buffer);
  const found: Record<string, unknown> = { ...document };
  const measures: Record<string, (number | null)[]> = {};
  for (const { name, shape, values } of columns) {
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

/** NaN stands for an unknown value. */
const numbers = (values: Values) => Array.from(values, (value) => (Number.isNaN(value) ? null : value));

const rows = (values: Values, length: number, width: number) =>
  Array.from({ length }, (_, i) => values.subarray(i * width, (i + 1) * width));

export function hexadecimal(bytes: Values): string {
  let text = "";
  for (const byte of bytes) text += HEX[byte];
  return text;
}

/** The header and the offset after it; `what` names the file in errors. */
export function readHeader<T>(
  buffer: ArrayBuffer,
  what: string,
  format: string,
): { header: T; start: number } {
  const length = new DataView(buffer).getUint32(0, true);
  if (4 + length > buffer.byteLength) {
    throw new Error(`${what}: a header of ${length} bytes does not fit in ${buffer.byteLength}`);
  }
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  if (header.format !== format) throw new Error(`${what}: format must be ${format}, got ${header.format}`);
  return { header, start: 4 + length };
}
