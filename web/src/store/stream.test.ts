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

/** Another tab: modules and a document of its own. */
async function tab(visibility = "visible"): Promise<[typeof import("./store"), Page]> {
  vi.resetModules();
  const document = new Page();
  document.visibilityState = visibility;
  vi.stubGlobal("document", document);
  const store = await import("./store");
  void (await import("./stream")).connect();
  return [store, document];
}

beforeEach(async () => {
  vi.useFakeTimers();
  Source.made = [];
  vi.stubGlobal("EventSource", Source);
  vi.stubGlobal("navigator", {});
  [live, page] = await tab();
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

/** Locks and channels of the tabs of one browser, which act at once. */
class Locks {
  private waiting: (() => void)[] = [];
  private isHeld = false;

  request(_: string, { signal }: { signal: AbortSignal }, hold: () => Promise<void>): Promise<void> {
    return new Promise((done, left) => {
      const take = () => {
        this.isHeld = true;
        void hold().then(() => {
          this.isHeld = false;
          this.waiting.shift()?.();
          done();
        });
      };
      signal.addEventListener("abort", () => {
        this.waiting = this.waiting.filter((one) => one !== take);
        left(new Error("aborted"));
      });
      if (this.isHeld) this.waiting.push(take);
      else take();
    });
  }
}

class Channel {
  static all = new Set<Channel>();
  onmessage = (_: unknown) => {};

  constructor() {
    Channel.all.add(this);
  }

  postMessage(data: unknown) {
    for (const other of Channel.all) if (other !== this) other.onmessage({ data });
  }

  close() {
    Channel.all.delete(this);
  }
}

describe("the stream of several tabs", () => {
  beforeEach(() => {
    page.turn("hidden");
    vi.advanceTimersByTime(60_000);
    Source.made = [];
    Channel.all.clear();
    vi.stubGlobal("navigator", { locks: new Locks() });
    vi.stubGlobal("BroadcastChannel", Channel);
  });

  it("is one, whose events reach all of them", async () => {
    const tabs = [await tab(), await tab(), await tab()];
    expect(Source.made.length).toBe(1);
    Source.made[0]!.onopen();
    const data = JSON.stringify({ run: "a" });
    Source.made[0]!.dispatchEvent(Object.assign(new Event("purge"), { data }));
    for (const [store] of tabs) {
      expect(store.currentState()).toMatchObject({ connection: "live", epoch: 1 });
      expect(store.currentState().epochs.get("a")).toBe(1);
    }
    Source.made[0]!.onerror();
    expect(tabs.map(([store]) => store.currentState().connection)).toEqual(["lost", "lost", "lost"]);
  });

  it("is live at once in a tab that comes later, which alone fetches everything", async () => {
    const [first] = await tab();
    Source.made[0]!.onopen();
    const [second] = await tab();
    expect(second.currentState()).toMatchObject({ connection: "live", epoch: 1 });
    expect([first.currentState().epoch, Source.made.length]).toEqual([1, 1]);
  });

  it("is taken over when its tab is hidden, and all fetch everything again", async () => {
    const [, one] = await tab();
    Source.made[0]!.onopen();
    const [second] = await tab();
    vi.stubGlobal("document", one);
    one.turn("hidden");
    await vi.advanceTimersByTimeAsync(60_000);
    expect([Source.made.length, open()]).toEqual([2, 1]);
    Source.made[1]!.onopen();
    expect(second.currentState()).toMatchObject({ connection: "live", epoch: 2 });
  });

  it("is each tab's own where locks are refused, or where the tab that has it is silent", async () => {
    const [, one] = await tab();
    Source.made[0]!.onopen();
    for (const other of Channel.all) other.onmessage = () => {}; // It is suspended.
    const [late] = await tab();
    expect(Source.made.length).toBe(1);
    await vi.advanceTimersByTimeAsync(3000);
    expect(Source.made.length).toBe(2);
    Source.made[1]!.onopen();
    expect(late.currentState().connection).toBe("live");
    expect(one.visibilityState).toBe("visible");

    vi.stubGlobal("navigator", { locks: { request: () => Promise.reject(new Error("SecurityError")) } });
    await tab();
    await vi.advanceTimersByTimeAsync(10);
    expect(Source.made.length).toBe(3);
    vi.stubGlobal(
      "BroadcastChannel",
      class {
        constructor() {
          throw new Error("SecurityError");
        }
      },
    );
    await tab();
    expect(Source.made.length).toBe(4);
  });

  it("is not opened by a tab that begins hidden, until it is shown", async () => {
    const [store, document] = await tab("hidden");
    vi.advanceTimersByTime(60_000);
    expect(Source.made.length).toBe(0);
    document.turn("visible");
    Source.made[0]!.onopen();
    expect(store.currentState().connection).toBe("live");
  });
});
