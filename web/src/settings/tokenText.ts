/** Status and validity of tokens. */

import type { Token } from "../api/types";
import { inDays } from "../ui/format";
import { text } from "./text";

export const day = (iso: string) =>
  new Date(iso).toLocaleDateString("en-GB", { day: "numeric", month: "short", year: "numeric" });

export function tokenStatus(token: Token, now = Date.now()): string {
  const { revoked_at, expires_at } = token;
  if (expires_at && Date.parse(expires_at) <= now) return text.expired(day(expires_at));
  if (revoked_at) return text.revokedOn(day(revoked_at));
  return expires_at ? text.until(day(expires_at)) : text.noExpiry;
}

export const isExpired = (token: Token, now = Date.now()) =>
  token.revoked_at !== null || (token.expires_at !== null && Date.parse(token.expires_at) <= now);

/** When a token for this number of days expires; null for no expiry. */
export const endOf = (days: number, now = Date.now()) => (days > 0 ? inDays(days, now) : null);
