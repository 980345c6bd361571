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
): { open: OpenDocument; file: CreatureFile | null } {
  const [file, setFile] = useState<CreatureFile | null>(null);
  const open: OpenDocument = (text, name, typed = false) => {
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
  useDocumentDrop(open);
  return { open, file };
}

/** Handle text pasted outside fields, and dropped files. */
function useDocumentDrop(open: OpenDocument): void {
  useFileDrop(text.dropDocument, (file) => void readFile(open, file));
  useListener("paste", (event: ClipboardEvent) => {
    if ((event.target as Element).closest?.("input, textarea, select")) return;
    const pasted = event.clipboardData?.getData("text") ?? "";
    if (!pasted.trim()) return;
    event.preventDefault();
    showProblem(open(pasted, ""), text.pasted);
  });
}

async function readFile(open: OpenDocument, file: File): Promise<void> {
  showProblem(open(await file.text(), file.name), file.name);
}

function showProblem(problem: string | null, what: string): void {
  if (problem) showToast({ kind: "wrong", text: `${what}: ${problem}` });
}

export function OpenFileButton({ open }: { open: OpenDocument }) {
  return (
    <FileButton name={text.documentFile} onFile={(file) => void readFile(open, file)}>
      {text.openFile}
    </FileButton>
  );
}
