import { describe, expect, it } from "vitest";
import { columnsOf, columnsParameter, groupName, groupedBy, groupingOf, USUAL } from "./columns";
import { viewsIn, withView } from "./TableOptions";

const ids = (text: string) => columnsOf(new URLSearchParams(text)).map(({ id }) => id);

describe("the columns of the list of runs", () => {
  it("are the usual ones, or those of the address in their order", () => {
    expect(ids("")).toEqual(USUAL);
    expect(ids("columns=best,state,odd")).toEqual(["state", "best"]);
    expect(ids("columns=")).toEqual([]);
  });

  it("leave the address when they are the usual ones", () => {
    expect(columnsParameter([...USUAL].reverse())).toBeNull();
    expect(columnsParameter([...USUAL, "seed"])).toBe("state,progress,time,rate,result,seed");
    expect(ids(`columns=${columnsParameter([])}`)).toEqual([]);
  });
});

describe("groups", () => {
  it("keep the order of the list", () => {
    expect(groupedBy(["b", "a", "b"])).toEqual([["b", [0, 2]], ["a", [1]]]); // prettier-ignore
  });

  it("have no name for a run that was just removed for good", () => {
    expect(["", "state", "tag", "viscosity"].map((group) => groupName(undefined, group))).toEqual(["", "", "", ""]); // prettier-ignore
  });

  it("are by what the page knows", () => {
    expect(["state", "toString", "odd"].map((group) => groupingOf(new URLSearchParams({ group })))).toEqual(["state", "", ""]); // prettier-ignore
  });
});

describe("views", () => {
  it("replace those of the same name, and are sorted", () => {
    const [a, b] = [{ name: "a", query: "?q=1" }, { name: "b", query: "" }]; // prettier-ignore
    expect(withView([b], a)).toEqual([a, b]);
    expect(withView([a, b], { ...a, query: "?q=2" })).toEqual([{ name: "a", query: "?q=2" }, b]);
  });

  it.each([null, "", {}, 3, [{ name: 1 }, null]])("that %s keeps are none", (kept) => {
    expect(viewsIn(kept)).toEqual([]);
  });
});
