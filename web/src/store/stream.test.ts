import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

class Source extends EventTarget {
  static readonly CLOSED = 2;
  static made: Source[] = [];
  readyState = 0;
  onopen = () => {};
  onerror = () => {};

  constructor() {
    super();
    Source.made.push(this);
  }

  close() {
    this.readyState = Source.CLOSED;
  }
}

class Page extends EventTarget {
  visibilityState = "visible";

  turn(visibilityState: string) {
    this.visibilityState = visibilityState;
    this.dispatchEvent(new Event("visibilitychange"));
  }
}

let page: Page;
let live: typeof import("./store");

beforeEach(async () => {
  vi.useFakeTimers();
  vi.resetModules();
  Source.made = [];
  page = new Page();
  vi.stubGlobal("EventSource", Source);
  vi.stubGlobal("document", page);
  live = await import("./store");
  (await import("./stream")).connect();
  Source.made[0]!.onopen();
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const open = () => Source.made.filter(({ readyState }) => readyState !== Source.CLOSED).length;

describe("the stream", () => {
  it("reports a run that was purged", () => {
    const data = JSON.stringify({ run: "a" });
    Source.made[0]!.dispatchEvent(Object.assign(new Event("purge"), { data }));
    expect(live.currentState().epochs.get("a")).toBe(1);
  });

  it("is closed in a tab that stays hidden, and everything is fetched again after that", () => {
    const { epoch } = live.currentState();
    page.turn("hidden");
    vi.advanceTimersByTime(60_000);
    expect(open()).toBe(0);
    page.turn("visible");
    expect([Source.made.length, open()]).toEqual([2, 1]);
    Source.made[1]!.onopen();
    expect(live.currentState()).toMatchObject({ connection: "live", epoch: epoch + 1 });
  });

  it("stays open in a tab that is hidden for a short time", () => {
    page.turn("hidden");
    vi.advanceTimersByTime(2000);
    page.turn("visible");
    vi.advanceTimersByTime(60_000);
    expect([Source.made.length, open()]).toEqual([1, 1]);
  });

  it("resumes without a reset, and is opened again after it gave up", () => {
    const { epoch } = live.currentState();
    Source.made[0]!.onerror();
    Source.made[0]!.onopen();
    expect(live.currentState().epoch).toBe(epoch);
    Source.made[0]!.close();
    Source.made[0]!.onerror();
    vi.advanceTimersByTime(60_000);
    expect([Source.made.length, open()]).toEqual([2, 1]);
  });

  it("is not opened again in a hidden tab after it gave up", () => {
    page.turn("hidden");
    vi.advanceTimersByTime(9000);
    Source.made[0]!.close();
    Source.made[0]!.onerror();
    vi.advanceTimersByTime(60_000);
    expect(open()).toBe(0);
  });
});
