/** A creature as one HTML file. */

import { afterEach, describe, expect, it, vi } from "vitest";
import * as api from "../api/client";
import { type AboutCreature, filled, forScript, pageOf } from "./page";
import { packed, unpacked } from "./packing";

vi.mock("../api/client", () => ({
  readMotion: vi.fn(() => Promise.resolve(null)),
  readEvaluation: vi.fn(() => Promise.resolve(null)),
}));
afterEach(() => void vi.unstubAllGlobals());

describe("the page", () => {
  it("carries bytes", async () => {
    const bytes = Uint8Array.from({ length: 70_000 }, (_, i) => (i * i) % 251);
    expect(new Uint8Array(await unpacked(await packed(bytes)))).toEqual(bytes);
  });

  it("holds texts that cannot end their element", () => {
    const hostile = "</script><b>$&</b>";
    const html = filled("<title><!--title--></title><body><!--data--></body>", hostile, {
      about: forScript({ title: hostile }),
    });
    expect(html).toContain("<title>&lt;/script>&lt;b>$&amp;&lt;/b></title>");
    expect(html.match(/<\/script>/g)).toHaveLength(1);
    const [, json] = /id="about">(.*)<\/script>/.exec(html)!;
    expect(JSON.parse(json!)).toEqual({ title: hostile });
  });

  it("needs a template with both places", () => {
    expect(() => filled("<!--title-->", "Eel", {})).toThrow("one place for data");
  });
});

describe("a page that is left while its replay is rendered", () => {
  it("asks no more", async () => {
    vi.useFakeTimers();
    vi.stubGlobal("fetch", () => Promise.resolve(new Response("")));
    const leaving = new AbortController();
    const about = { title: "Eel", address: null, creature: { sha256: "ab" } } as AboutCreature;
    const page = expect(pageOf(about, leaving.signal)).rejects.toThrow("aborted");
    await vi.advanceTimersByTimeAsync(2500);
    const asked = vi.mocked(api.readMotion).mock.calls.length;
    expect(asked).toBe(3);
    leaving.abort();
    await page;
    await vi.advanceTimersByTimeAsync(5000);
    expect(vi.mocked(api.readMotion).mock.calls.length).toBe(asked);
    expect(vi.mocked(api.readEvaluation).mock.calls.length).toBe(asked);
    vi.useRealTimers();
  });
});
