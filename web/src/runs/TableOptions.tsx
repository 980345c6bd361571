/** Choices of the list of runs: columns, groups, and views that are kept under a name. */

import { useRef } from "preact/hooks";
import { navigate, setQuery } from "../store/router";
import { Dropdown } from "../ui/Dropdown";
import { Check, Select } from "../ui/Select";
import { COLUMNS, GROUPINGS, columnsOf, columnsParameter, groupingOf } from "./columns";
import { MAX_NAME, useViews } from "./views";
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
  const keep = (event: Event) => {
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
      <form class="row" onSubmit={keep}>
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
