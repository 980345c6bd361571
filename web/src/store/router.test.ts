import { describe, expect, it } from "vitest";
import { routeOf } from "./router";

describe("an address", () => {
  it.each([
    ["/", { page: "runs" }],
    ["/new", { page: "new" }],
    ["/runs/abc", { page: "run", id: "abc" }],
    ["/creatures/ff", { page: "creature", id: "ff" }],
    ["/runs/abc/tree", { page: "run-tree", id: "abc" }],
    ["/creatures/ff/tree", { page: "creature-tree", id: "ff" }],
    ["/sweeps/abc/tree", { page: "unknown" }],
    ["/runs/abc/tree/more", { page: "unknown" }],
    ["/runs/abc/more", { page: "unknown" }],
    ["/runs/a%20b", { page: "run", id: "a b" }],
    ["/runs/%E0%A4%A", { page: "unknown" }],
    ["/creatures/%", { page: "unknown" }],
    ["/runs", { page: "unknown" }],
    ["/elsewhere", { page: "unknown" }],
  ])("%s has its route", (path, route) => {
    expect(routeOf(path)).toEqual(route);
  });
});
