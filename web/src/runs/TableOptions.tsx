/** Choices of the list of runs: columns, groups, and views that are kept under a name. */

import { useRef, useState } from "preact/hooks";
import { changeKept, readKept } from "../store/kept";
import { useListener } from "../store/polling";
import { navigate, setQuery } from "../store/router";
import { Dropdown, Check, Select } from "../ui/Select";
import { COLUMNS, GROUPINGS, columnsOf, columnsParameter, groupingOf } from "./columns";
import { text } from "./text";

export function TableOptions({ address }: { address: URLSearchParams }) {
  const shown = columnsOf(address).map(({ id }) => id);
  const toggle = (id: string, on: boolean) => {
    const next = on ? [...shown, id] : shown.filter((other) => other !== id);
    setQuery({ columns: columnsParameter(next) });
  };
  return (
    <>
      <Dropdown title={text.columns} changed={address.has("columns") || address.has("group")}>
        <Select
          title={text.groupBy}
          choices={GROUPINGS}
          value={groupingOf(address)}
          onChange={(group) => setQuery({ group: group || null })}
        />
        <fieldset class="columns">
          <legend class="quiet small">{text.shownColumns}</legend>
          {COLUMNS.map(({ id, title }) => (
            <Check key={id} title={title} on={shown.includes(id)} onChange={(on) => toggle(id, on)} />
          ))}
        </fieldset>
      </Dropdown>
      <Views />
    </>
  );
}

function Views() {
  const { views, save, remove } = useViews();
  const name = useRef<HTMLInputElement>(null);
  const keepView = (event: Event) => {
    event.preventDefault();
    const given = name.current!.value.trim();
    if (given) save({ name: given, query: location.search });
    name.current!.value = "";
  };
  return (
    <Dropdown title={text.views}>
      {views.length === 0 && <p class="quiet small">{text.noViews}</p>}
      <ul class="views">
        {views.map((view) => (
          <li key={view.name} class="row">
            <button class="link" onClick={() => navigate(`/${view.query}`)}>
              {view.name}
            </button>
            <button
              class="plain small-button"
              aria-label={text.removeView(view.name)}
              onClick={() => remove(view.name)}
            >
              ✕
            </button>
          </li>
        ))}
      </ul>
      <form class="row" onSubmit={keepView}>
        <input
          ref={name}
          aria-label={text.viewName}
          placeholder={text.viewName}
          maxLength={MAX_NAME}
          required
        />
        <button class="slim">{text.keepView}</button>
      </form>
    </Dropdown>
  );
}

interface View {
  name: string;
  /** The query of the address. */
  query: string;
}

const STORAGE_KEY = "microcosmos:views";
const MAX_NAME = 60;

/** The views in a kept value; none if it is no list of views. */
export function viewsIn(kept: unknown): View[] {
  return Array.isArray(kept) ? kept.filter(isView) : [];
}

function isView(value: unknown): value is View {
  const { name, query } = (value ?? {}) as Partial<View>;
  return typeof name === "string" && typeof query === "string";
}

/** The views with another one, which replaces one of the same name. */
export const withView = (views: readonly View[], view: View): View[] =>
  [...views.filter(({ name }) => name !== view.name), view].sort((a, b) => a.name.localeCompare(b.name));

function useViews() {
  const [kept, setKept] = useState(() => readKept<unknown>(STORAGE_KEY, []));
  const change = (how: (now: View[]) => View[]) =>
    setKept(changeKept(STORAGE_KEY, kept, (now) => how(viewsIn(now))));
  useListener("storage", () => setKept(readKept(STORAGE_KEY, kept))); // Another tab has changed them.
  return {
    views: viewsIn(kept),
    save: (view: View) => change((now) => withView(now, view)),
    remove: (name: string) => change((now) => now.filter((view) => view.name !== name)),
  };
}
