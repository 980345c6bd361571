/** The button below which the formats of exports open. */

import { useState } from "preact/hooks";
import type { Run } from "../../api/types";
import { lazy } from "../../ui/lazy";
import { text } from "../text";
import "./exports.css";

const ExportFormats = lazy(async () => (await import("./ExportFormats")).ExportFormats, "section");

export function ExportMenu({ run }: { run: Run }) {
  const [opened, setOpened] = useState(false);
  return (
    <details class="exports" onToggle={() => setOpened(true)}>
      <summary class="button">{text.export}</summary>
      {opened && <ExportFormats run={run} />}
    </details>
  );
}
