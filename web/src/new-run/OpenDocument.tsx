/** Documents that are pasted, dropped or opened. */

import { useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import type { Experiment } from "../api/types";
import { useListener } from "../store/polling";
import { showToast } from "../store/toasts";
import { FileButton, useFileDrop } from "../ui/DropTarget";
import type { CreatureFile } from "./BaseBar";
import type { DraftState } from "./draftState";
import { readText, completeSpec, baseOfDocument } from "./sources";
import { text } from "./text";

/** Start from a document; return what is wrong with it, or null. */
export type OpenDocument = (text: string, name: string, typed?: boolean) => string | null;

/** Start from documents; JSON typed in the editor changes the spec and keeps its source. */
export function useDocument(
  draft: DraftState,
  experiments: Experiment[],
  selected: Experiment,
  current: Experiment | undefined,
): { openDocument: OpenDocument; file: CreatureFile | null } {
  const [file, setFile] = useState<CreatureFile | null>(null);
  const openDocument: OpenDocument = (text, name, typed = false) => {
    try {
      const read = readText(text, selected.experiment === "refinement");
      const same = typed && read.kind === "spec" && read.spec.experiment === current?.experiment;
      if (same) {
        const spec = completeSpec(read.spec, experiments);
        draft.change(() => spec);
      } else {
        draft.startFrom(baseOfDocument(read, name, experiments));
        setFile(read.kind === "creature" ? { sha: read.creature.sha256, text } : null);
      }
      return null;
    } catch (error) {
      return messageOf(error);
    }
  };
  useDocumentDrop(openDocument);
  return { openDocument, file };
}

/** Handle text pasted outside fields, and dropped files. */
function useDocumentDrop(openDocument: OpenDocument): void {
  useFileDrop(text.dropDocument, (file) => void readFile(openDocument, file));
  useListener("paste", (event: ClipboardEvent) => {
    if ((event.target as Element).closest?.("input, textarea, select")) return;
    const pasted = event.clipboardData?.getData("text") ?? "";
    if (!pasted.trim()) return;
    event.preventDefault();
    showProblem(openDocument(pasted, ""), text.pasted);
  });
}

async function readFile(openDocument: OpenDocument, file: File): Promise<void> {
  showProblem(openDocument(await file.text(), file.name), file.name);
}

function showProblem(problem: string | null, what: string): void {
  if (problem) showToast({ kind: "wrong", text: `${what}: ${problem}` });
}

export function OpenFileButton({ openDocument }: { openDocument: OpenDocument }) {
  return (
    <FileButton name={text.documentFile} onFile={(file) => void readFile(openDocument, file)}>
      {text.openFile}
    </FileButton>
  );
}
