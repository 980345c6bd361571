/** Publishing, and public pages. */

import { describe, expect, it } from "vitest";
import { isPublicPage } from "../api/address";
import type { Share } from "../api/types";
import { licencesFor, requestOf } from "../publish/PublishDialog";
import { routeOf } from "../store/router";
import { bibtex, citation } from "./TakeAway";
import { embedCode } from "./TakeAway";
import { headingOf } from "./SharedPage";

const form = (fields: Record<string, string>) => {
  const data = new FormData();
  for (const [name, value] of Object.entries(fields)) data.set(name, value);
  return data;
};

describe("the request of a form", () => {
  const plain = { title: " ", credit: "", licence: "CC0-1.0", term: "never" };

  it("leaves empty fields to the server", () => {
    expect(requestOf(form({ ...plain, licence: "" }))).toEqual({
      credit: [],
      licence: null,
      expires_at: null,
      listed: false,
    });
  });

  it("separates names and counts days from now", () => {
    const now = Date.parse("2026-03-01T00:00:00Z");
    const request = requestOf(
      form({ ...plain, title: "Eel", credit: "Ada, , Bob ", term: "7", listed: "on" }),
      now,
    );
    expect(request).toMatchObject({ title: "Eel", credit: ["Ada", "Bob"], listed: true });
    expect(request.expires_at).toBe("2026-03-08T00:00:00.000Z");
  });

  it("takes a date in local time", () => {
    const request = requestOf(form({ ...plain, term: "date", until: "2026-03-01T12:00" }));
    expect(request.expires_at).toBe(new Date("2026-03-01T12:00").toISOString());
  });
});

describe("the licences to choose from", () => {
  const names = (file?: { licence: string }) => licencesFor(file).map(([name]) => name);
  const usual = ["CC-BY-4.0", "CC-BY-SA-4.0", "CC-BY-NC-4.0", "CC0-1.0"];

  it("have that of the file, known or not", () => {
    expect(names({ licence: "CC-BY-NC-4.0" })).toEqual(usual);
    expect(names({ licence: "MIT" })).toEqual(["MIT", ...usual]);
  });

  it("begin with the server's choice for an archive, which has no file", () => {
    expect(names()).toEqual(["", ...usual]);
  });
});

describe("public pages", () => {
  it("are shares and the commons", () => {
    expect(["/s/abc", "/s/abc/creatures/12", "/commons"].every(isPublicPage)).toBe(true);
    expect(["/", "/s", "/s/", "/shares", "/creatures/12", "/runs/s/abc"].some(isPublicPage)).toBe(false);
  });

  it("show a share, or a creature of a shared archive", () => {
    expect(routeOf("/s/abc")).toEqual({ page: "share", slug: "abc" });
    expect(routeOf("/s/abc/tree")).toEqual({ page: "share-tree", slug: "abc" });
    expect(routeOf("/s/abc/creatures/12/tree")).toEqual({ page: "share-tree", slug: "abc", sha: "12" });
    expect(routeOf("/s/abc/embed")).toEqual({ page: "embed", slug: "abc" });
    expect(routeOf("/s/abc/creatures/12")).toEqual({ page: "share", slug: "abc", sha: "12" });
    for (const path of ["/s", "/s/abc/runs/1", "/s/abc/embed/1", "/s/abc/creatures/1/2"]) {
      expect(routeOf(path)).toEqual({ page: "unknown" });
    }
  });
});

describe("the heading of a share", () => {
  const share = (title: string, run: string | null = null) => ({ title, run }) as Share;

  it.each([
    [share("Creature 0123abcd"), false, ["Creature 0123abcd", null]],
    [share("Eel"), false, ["Eel", "0123abcd"]],
    [share("Archive", "run"), true, ["Creature", "0123abcd"]],
  ])("contains the id once", (shared, inside, heading) => {
    expect(headingOf(shared, "0123abcd".padEnd(64, "0"), inside)).toEqual(heading);
  });
});

describe("the citation of a share", () => {
  const share = {
    title: "An eel & 50 %",
    credit: ["Ada Byron", "Bob_2"],
    url: "https://lab.example/s/slug",
    created_at: "2026-03-01T00:00:00Z",
    generation: null,
  };
  const sha = "0123abcd".padEnd(64, "0");

  it("names people, year, title, creature and address", () => {
    expect(citation({ ...share, sha })).toBe(
      `Ada Byron, Bob_2 (2026). An eel & 50 %. Creature of Microcosmos, SHA-256 ${sha}. https://lab.example/s/slug`,
    );
    expect(citation({ ...share, credit: [], sha: null, generation: 12 })).toBe(
      "Anonymous (2026). An eel & 50 %. Archive of Microcosmos, generation 12. https://lab.example/s/slug",
    );
  });

  it("escapes what BibTeX would read as a command", () => {
    const lines = bibtex({ ...share, sha }).split("\n");
    expect(lines[0]).toBe("@misc{microcosmos-0123abcd,");
    expect(lines[1]).toBe("  author = {{Ada Byron} and {Bob\\_2}},");
    expect(lines[2]).toBe("  title = {{An eel \\& 50 \\%}},");
    expect(lines.at(-1)).toBe("}");
  });
});

describe("the embed code", () => {
  const share = { url: "https://lab.example/s/slug", title: 'An "eel" <b>', run: null } as Share;

  it("cannot be broken by a title", () => {
    expect(embedCode(share, "0123")).toContain(
      'src="https://lab.example/s/slug/embed" title="An &quot;eel&quot; &lt;b>"',
    );
  });

  it("names the creature of an archive", () => {
    expect(embedCode({ ...share, run: "run" }, "0123")).toContain("/embed?creature=0123");
    expect(embedCode({ ...share, run: "run" }, null)).not.toContain("creature");
  });
});
