/** What is said of tokens. */

import type { Token } from "../api/types";

export const day = (iso: string) =>
  new Date(iso).toLocaleDateString("en-GB", { day: "numeric", month: "short", year: "numeric" });

/** How a token stands. */
export function tokenStatus(token: Token, now = Date.now()): string {
  const { revoked_at, expires_at } = token;
  if (expires_at && Date.parse(expires_at) <= now) return `Expired ${day(expires_at)}`;
  if (revoked_at) return `Revoked ${day(revoked_at)}`;
  return expires_at ? `Until ${day(expires_at)}` : "No end";
}

export const isExpired = (token: Token, now = Date.now()) =>
  token.revoked_at !== null || (token.expires_at !== null && Date.parse(token.expires_at) <= now);

export const TERMS = [
  ["A week", 7],
  ["A month", 30],
  ["Three months", 90],
  ["A year", 365],
  ["For ever", 0],
] as const;

/** The moment so many days from now; null where there is no end. */
export const endOf = (days: number, now = Date.now()) =>
  days > 0 ? new Date(now + days * 86_400_000).toISOString() : null;
