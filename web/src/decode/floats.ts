/** Little-endian float32 arrays, in buffers and as base64, on any machine. */

export function floatsAt(buffer: ArrayBuffer, start: number, count: number): Float32Array {
  const view = new DataView(buffer, start, 4 * count);
  const values = new Float32Array(count);
  for (let i = 0; i < count; i++) values[i] = view.getFloat32(4 * i, true);
  return values;
}

export function decodeFloats(text: string): Float32Array {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  if (bytes.length % 4 !== 0) {
    throw new Error(`base64 floats need a multiple of 4 bytes, got ${bytes.length}`);
  }
  return floatsAt(bytes.buffer, 0, bytes.length / 4);
}
