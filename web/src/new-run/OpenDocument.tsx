/** Documents that come from outside: pasted anywhere on the page, dropped, or opened. */

import { useEffect, useRef } from "preact/hooks";
import { tell } from "../store/toasts";
import { FileButton, useDropTaker } from "../ui/DropTarget";

type Take = (text: string, file: string) => string | null;

/** Passes on what is pasted outside of fields, and what is dropped. */
export function useTaking(take: Take): void {
  const latest = useRef(take);
  latest.current = take;
  useDropTaker("Drop a spec, a run or a creature file to begin from it", (file) => {
    void takeFile(latest.current, file);
  });
  useEffect(() => {
    const paste = (event: ClipboardEvent) => {
      if ((event.target as Element).closest?.("input, textarea, select")) return;
      const text = event.clipboardData?.getData("text") ?? "";
      if (!text.trim()) return;
      event.preventDefault();
      complain(latest.current(text, ""), "Pasted");
    };
    document.addEventListener("paste", paste);
    return () => document.removeEventListener("paste", paste);
  }, []);
}

async function takeFile(take: Take, file: File): Promise<void> {
  complain(take(await file.text(), file.name), file.name);
}

function complain(problem: string | null, what: string): void {
  if (problem) tell({ kind: "wrong", text: `${what}: ${problem}` });
}

export function OpenFile({ take }: { take: Take }) {
  return (
    <FileButton name="Spec, run or creature file" take={(file) => void takeFile(take, file)}>
      Open a file
    </FileButton>
  );
}
