import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { currentState } from "./store";
import { delayWithUndo } from "./toasts";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

const undo = () =>
  currentState()
    .toasts.findLast(({ action }) => action)!
    .action!.run();

it("what is delayed twice is done once, and undone at once", () => {
  const act = vi.fn();
  delayWithUndo("run", "Cancelling", act);
  delayWithUndo("run", "Cancelling", act);
  expect(currentState().toasts.length).toBe(1);
  undo();
  vi.advanceTimersByTime(10_000);
  expect(act).not.toHaveBeenCalled();

  delayWithUndo("run", "Cancelling", act);
  delayWithUndo("other run", "Cancelling", act);
  vi.advanceTimersByTime(10_000);
  expect(act).toHaveBeenCalledTimes(2);
  delayWithUndo("run", "Cancelling", act);
  vi.advanceTimersByTime(10_000);
  expect(act).toHaveBeenCalledTimes(3);
});
