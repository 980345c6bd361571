/** Errors of the server: problem details (RFC 9457) and readable messages. */

import type { FieldError, ProblemDocument } from "./types";
import { text } from "./text";

export class Problem extends Error {
  readonly status: number;
  readonly errors: FieldError[];

  constructor(status: number, document: ProblemDocument) {
    super(document.detail || document.title || text.status(status));
    this.name = "Problem";
    this.status = status;
    this.errors = document.errors ?? [];
  }
}

export function problemOf(status: number, body: unknown): Problem {
  const document = typeof body === "object" && body !== null ? (body as ProblemDocument) : {};
  return new Problem(status, document);
}

export function messageOf(error: unknown): string {
  if (error instanceof TypeError) return text.unreachable;
  return error instanceof Error ? error.message : String(error);
}

const BUSY = [429, 502, 503, 504];

/** True if the same request may succeed later: the server was unreachable or busy. */
export function isTransient(error: unknown): boolean {
  return error instanceof TypeError || (error instanceof Problem && BUSY.includes(error.status));
}
