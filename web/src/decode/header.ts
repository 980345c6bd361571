/** The JSON header of replays and pose streams, which follows its own length. */

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
