/** A random key that also works over plain HTTP, where `randomUUID` does not exist. */
export function newIdempotencyKey(): string {
  const parts = crypto.getRandomValues(new Uint32Array(4));
  return [...parts].map((part) => part.toString(16).padStart(8, "0")).join("");
}
