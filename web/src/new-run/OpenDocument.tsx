/** Documents that come from outside: pasted anywhere on the page, dropped, or opened. */

import { useEffect, useRef } from "preact/hooks";
import { showToast } from "../store/toasts";
import { FileButton, useFileDrop } from "../ui/DropTarget";

type Take = (text: string, file: string) => string | null;

/** Passes on what is pasted outside of fields, and what is dropped. */
export function useDocumentDrop(take: Take): void {
  const latest = useRef(take);
  latest.current = take;
  useFileDrop("Drop a spec, a run or a creature file to begin from it", (file) => {
    void readFile(latest.current, file);
  });
  useEffect(() => {
    const paste = (event: ClipboardEvent) => {
      if ((event.target as Element).closest?.("input, textarea, select")) return;
      const text = event.clipboardData?.getData("text") ?? "";
      if (!text.trim()) return;
      event.preventDefault();
      showProblem(latest.current(text, ""), "Pasted");
    };
    document.addEventListener("paste", paste);
    return () => document.removeEventListener("paste", paste);
  }, []);
}

async function readFile(take: Take, file: File): Promise<void> {
  showProblem(take(await file.text(), file.name), file.name);
}

function showProblem(problem: string | null, what: string): void {
  if (problem) showToast({ kind: "wrong", text: `${what}: ${problem}` });
}

export function OpenFileButton({ take }: { take: Take }) {
  return (
    <FileButton name="Spec, run or creature file" take={(file) => void readFile(take, file)}>
      Open a file
    </FileButton>
  );
}
