import { describe, expect, it } from "vitest";
import { inOrder } from "./fetch";

type Answer = Parameters<Parameters<typeof inOrder<string>>[0]>[0];

/** Requests that are answered by hand, and all answers that were shown. */
function requests() {
  const shown: Answer[] = [];
  const send = inOrder<string>((answer) => shown.push(answer));
  const request = () => {
    let answer: { resolve: (value: string) => void; reject: (reason: Error) => void };
    send(new Promise((resolve, reject) => (answer = { resolve, reject })));
    return answer!;
  };
  return { shown, request };
}

const settled = () => new Promise((resolve) => setTimeout(resolve));

describe("answers to repeated requests", () => {
  it("are shown though the next request is sent before each of them", async () => {
    const { shown, request } = requests();
    const [first, second, third] = [request(), request(), request()];
    first.resolve("first");
    await settled();
    expect(shown).toEqual([{ value: "first", error: null }]);
    second.resolve("second");
    third.resolve("third");
    await settled();
    expect(shown.map(({ value }) => value)).toEqual(["first", "second", "third"]);
  });

  it("are dropped once a later one is shown, be it an error", async () => {
    const { shown, request } = requests();
    const [first, second, third, fourth] = [request(), request(), request(), request()];
    second.resolve("second");
    await settled();
    first.resolve("first");
    fourth.reject(new Error("No such sweep."));
    await settled();
    third.resolve("third");
    await settled();
    expect(shown).toEqual([{ value: "second", error: null }, { error: "No such sweep." }]);
  });
});
