/** Errors of the server: problem details (RFC 9457), and what a person can read of them. */

import type { FieldError, ProblemDocument } from "./types";

export class Problem extends Error {
  readonly status: number;
  readonly errors: FieldError[];

  constructor(status: number, document: ProblemDocument) {
    super(document.detail || document.title || `The server answered ${status}.`);
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
  if (error instanceof TypeError) return "The server could not be reached.";
  return error instanceof Error ? error.message : String(error);
}

const BUSY = [429, 502, 503, 504];

/** Whether the same request may succeed later: the server was away or busy, not unwilling. */
export function isTransient(error: unknown): boolean {
  return error instanceof TypeError || (error instanceof Problem && BUSY.includes(error.status));
}
