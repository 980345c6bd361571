import { afterEach, describe, expect, it, vi } from "vitest";
import type { Token } from "../api/types";
import { endOf, isExpired, limitsOf, tokenStatus } from "./Tokens";

const NOW = Date.parse("2026-06-15T12:00:00Z");

const token = (changes: Partial<Token>): Token => ({
  id: "0",
  name: "alice",
  prefix: "mc_abcdef",
  scope: "write",
  created_at: "2026-01-01T12:00:00Z",
  expires_at: null,
  revoked_at: null,
  last_used_at: null,
  used_hours: 0,
  ...changes,
});

describe("a token", () => {
  it.each([
    [{}, "No expiry", false],
    [{ expires_at: "2026-07-01T12:00:00Z" }, "Until 1 Jul 2026", false],
    [{ expires_at: "2026-06-15T11:59:00Z" }, "Expired on 15 Jun 2026", true],
    [{ revoked_at: "2026-05-02T12:00:00Z" }, "Revoked on 2 May 2026", true],
  ])("with %o has its status", (changes, status, expired) => {
    expect(tokenStatus(token(changes), NOW)).toBe(status);
    expect(isExpired(token(changes), NOW)).toBe(expired);
  });

  it.each([
    [{}, "0 h used"],
    [{ max_running: 2, used_hours: 1.25 }, "2 at a time, 1.3 h used"],
    [
      { max_running: 0, max_queued: 9, device_hours: 40, used_hours: 12 },
      "0 at a time, 9 queued, 12 of 40 h",
    ],
  ])("with %o has its limits", (changes, limits) => {
    expect(limitsOf(token(changes))).toBe(limits);
  });

  it("is valid for the selected number of days, or without limit", () => {
    expect(endOf(7, NOW)).toBe("2026-06-22T12:00:00.000Z");
    expect(endOf(0, NOW)).toBeNull();
  });
});

describe("the event of a missing sign-in", () => {
  afterEach(() => vi.unstubAllGlobals());

  it("is dispatched once", async () => {
    vi.resetModules();
    const dispatched = vi.fn();
    vi.stubGlobal("dispatchEvent", dispatched);
    const { isSignedOut, noteStatus } = await import("../api/http");
    noteStatus(403);
    expect([isSignedOut(), dispatched.mock.calls.length]).toEqual([false, 0]);
    noteStatus(401);
    noteStatus(401);
    expect([isSignedOut(), dispatched.mock.calls.length]).toEqual([true, 1]);
  });
});
