/** Opening creature files: dropped anywhere on the page, or chosen. */

import { useEffect, useRef, useState } from "preact/hooks";
import { importCreature } from "../api/client";
import { messageOf } from "../api/problem";
import { tell } from "../live/toasts";
import { navigate } from "../router";

async function open(file: File): Promise<void> {
  try {
    const { creature } = await importCreature(await file.text());
    navigate(`/creatures/${creature}`);
  } catch (error) {
    tell({ kind: "wrong", text: `${file.name}: ${messageOf(error)}` });
  }
}

export function OpenButton() {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button class="plain" onClick={() => input.current!.click()}>
        Open creature<span class="wide-only"> file</span>
      </button>
      <input
        ref={input}
        type="file"
        class="unseen"
        tabIndex={-1}
        aria-label="Creature file"
        accept="application/json,.json"
        onChange={({ currentTarget }) => {
          const file = currentTarget.files?.[0];
          if (file) void open(file);
          currentTarget.value = "";
        }}
      />
    </>
  );
}

export function DropTarget() {
  const [over, setOver] = useState(false);
  useEffect(() => {
    const drag = (event: DragEvent) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      setOver(true);
    };
    const leave = (event: DragEvent) => event.relatedTarget === null && setOver(false);
    const drop = (event: DragEvent) => {
      event.preventDefault();
      setOver(false);
      const file = event.dataTransfer?.files[0];
      if (file) void open(file);
    };
    window.addEventListener("dragover", drag);
    window.addEventListener("dragleave", leave);
    window.addEventListener("drop", drop);
    return () => {
      window.removeEventListener("dragover", drag);
      window.removeEventListener("dragleave", leave);
      window.removeEventListener("drop", drop);
    };
  }, []);
  return over ? (
    <div class="drop-target" aria-hidden="true">
      <p>Drop a creature file to open it</p>
    </div>
  ) : null;
}
