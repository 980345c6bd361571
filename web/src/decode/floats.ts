/** Numbers in buffers and as base64; they are little-endian, as every machine on which browsers run. */

/** The numbers at an offset, which needs no alignment. */
export const floatsAt = (buffer: ArrayBuffer, start: number, count: number) =>
  new Float32Array(buffer.slice(start, start + 4 * count));

/** Places (place, 2) in cells, which a file holds as int16 units about an origin. */
export function decodePlaces(
  buffer: ArrayBuffer,
  start: number,
  count: number,
  { origin, scale }: { origin: [number, number]; scale: number },
): Float32Array {
  const units = new Int16Array(buffer.slice(start, start + 4 * count));
  return Float32Array.from(units, (unit, i) => origin[i % 2]! + scale * unit);
}

export function decodeFloats(text: string): Float32Array {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  if (bytes.length % 4 !== 0) {
    throw new Error(`base64 floats need a multiple of 4 bytes, got ${bytes.length}`);
  }
  return floatsAt(bytes.buffer, 0, bytes.length / 4);
}
