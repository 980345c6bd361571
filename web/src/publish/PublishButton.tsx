/** The button that loads and opens the publishing dialog. */

import { useState } from "preact/hooks";
import { lazy } from "../ui/lazy";
import { useRefusal } from "../store/principal";
import type { Props } from "./PublishDialog";
import { text } from "./text";

const PublishDialog = lazy(async () => (await import("./PublishDialog")).PublishDialog, "section");

export function PublishButton(props: Props) {
  const [opened, setOpened] = useState(0);
  if (useRefusal()) return null;
  return (
    <>
      <button onClick={() => setOpened((times) => times + 1)}>{text.publish}</button>
      {opened > 0 && <PublishDialog {...props} opened={opened} />}
    </>
  );
}
