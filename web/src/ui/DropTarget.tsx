/** Open creature files that are dropped or selected; a page may handle dropped files itself. */

import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { importCreature } from "../api/client";
import { importPage } from "../api/address";
import { messageOf } from "../api/problem";
import { showToast } from "../store/toasts";
import { useListener } from "../store/polling";
import { navigate } from "../store/router";
import { text } from "./text";

export async function openCreature(file: File): Promise<void> {
  try {
    const { creature } = await importCreature(file);
    navigate(`/creatures/${creature}`);
  } catch (error) {
    showToast({ kind: "wrong", text: [file.name, messageOf(error)].filter(Boolean).join(": ") });
  }
}

interface DropHandler {
  prompt: string;
  onFile: (file: File) => void;
}

const OPEN_CREATURE: DropHandler = {
  prompt: text.dropCreature,
  onFile: (file) => void openCreature(file),
};

let handler = OPEN_CREATURE;

/** Handle dropped files while a component is shown. */
export function useFileDrop(prompt: string, onFile: DropHandler["onFile"]): void {
  useEffect(() => {
    handler = { prompt, onFile };
    return () => {
      handler = OPEN_CREATURE;
    };
  });
}

export function OpenButton() {
  return (
    <FileButton kind="plain" name={text.creatureFile} onFile={OPEN_CREATURE.onFile}>
      {text.openCreature}
      <span class="wide-only"> {text.file}</span>
    </FileButton>
  );
}

interface ButtonProps {
  kind?: string;
  name: string;
  onFile: DropHandler["onFile"];
  children: ComponentChildren;
}

/** A button that asks for a creature file or another JSON file. */
export function FileButton({ kind = "", name, onFile, children }: ButtonProps) {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button type="button" class={kind} onClick={() => input.current!.click()}>
        {children}
      </button>
      <input
        ref={input}
        type="file"
        class="unseen"
        tabIndex={-1}
        aria-label={name}
        accept="application/json,.json,.h5"
        onChange={({ currentTarget }) => {
          const file = currentTarget.files?.[0];
          if (file) onFile(file);
          currentTarget.value = "";
        }}
      />
    </>
  );
}

/** Elements that take pasted text themselves. */
const FIELDS = "input, textarea, select, [contenteditable]";

/** Open the page that imports, if the address of a share is pasted. */
function openPasted(event: ClipboardEvent): void {
  if ((event.target as Element).closest?.(FIELDS)) return;
  const page = importPage(event.clipboardData?.getData("text") ?? "");
  if (page) location.assign(page); // A new request: the policy of that page permits the file.
}

export function DropTarget() {
  const [over, setOver] = useState(false);
  useListener("paste", openPasted);
  useListener("dragover", (event: DragEvent) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    setOver(true);
  });
  useListener("dragleave", (event: DragEvent) => event.relatedTarget === null && setOver(false));
  useListener("drop", (event: DragEvent) => {
    event.preventDefault();
    setOver(false);
    const file = event.dataTransfer?.files[0];
    if (file) handler.onFile(file);
  });
  return over ? (
    <div class="drop-target" aria-hidden="true">
      <p>{handler.prompt}</p>
    </div>
  ) : null;
}
