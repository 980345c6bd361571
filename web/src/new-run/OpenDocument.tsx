/** Documents that are pasted, dropped or opened. */

import { useEffect, useRef } from "preact/hooks";
import { showToast } from "../store/toasts";
import { FileButton, useFileDrop } from "../ui/DropTarget";
import { text } from "./text";

type Take = (text: string, file: string) => string | null;

/** Handle text pasted outside fields, and dropped files. */
export function useDocumentDrop(take: Take): void {
  const latest = useRef(take);
  latest.current = take;
  useFileDrop(text.dropDocument, (file) => {
    void readFile(latest.current, file);
  });
  useEffect(() => {
    const paste = (event: ClipboardEvent) => {
      if ((event.target as Element).closest?.("input, textarea, select")) return;
      const pasted = event.clipboardData?.getData("text") ?? "";
      if (!pasted.trim()) return;
      event.preventDefault();
      showProblem(latest.current(pasted, ""), text.pasted);
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
    <FileButton name={text.documentFile} take={(file) => void readFile(take, file)}>
      {text.openFile}
    </FileButton>
  );
}
