/** Publishes a creature or an archive: what to call it, whom to name, how long, for whom. */

import { useEffect, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Creature, Share, ShareRequest } from "../api/types";
import { Options } from "../ui/Select";
import { copyText } from "../ui/clipboard";
import "./publish.css";

export interface Props {
  of: { creature: string } | { run: string };
  /** What it is called so far, if anything. */
  title: string;
  file?: Creature;
}

const LICENCES = [
  ["CC-BY-4.0", "CC BY 4.0: name the author"],
  ["CC-BY-SA-4.0", "CC BY-SA 4.0: and share alike"],
  ["CC-BY-NC-4.0", "CC BY-NC 4.0: and not for money"],
  ["CC0-1.0", "CC0: no conditions"],
] as const;
const TERMS = [
  ["never", "Never"],
  ["1", "In a day"],
  ["7", "In a week"],
  ["30", "In a month"],
  ["date", "On a date …"],
] as const;
const DAY_MS = 86_400_000;

/** Opens whenever `opened` grows; what was typed before is still there. */
export function PublishDialog({ opened, ...props }: Props & { opened: number }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [share, setShare] = useState<Share | null>(null);
  useEffect(() => {
    setShare(null);
    dialog.current!.showModal();
  }, [opened]);
  const end = () => dialog.current!.close();
  return (
    <dialog ref={dialog} class="publish card" aria-labelledby="publish-title">
      {share ? (
        <Published share={share} onEnd={end} />
      ) : (
        <PublishForm {...props} onDone={setShare} onEnd={end} />
      )}
    </dialog>
  );
}

interface FormProps extends Props {
  onDone: (share: Share) => void;
  onEnd: () => void;
}

function PublishForm({ of, title, file, onDone, onEnd }: FormProps) {
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<string | null>(null);
  const submit = async (event: SubmitEvent) => {
    event.preventDefault();
    setBusy(true);
    setError(null);
    try {
      onDone(
        await api.publish({ ...of, ...requestOf(new FormData(event.currentTarget as HTMLFormElement)) }),
      );
    } catch (reason) {
      setError(messageOf(reason));
    }
    setBusy(false);
  };
  return (
    <form onSubmit={(event) => void submit(event as unknown as SubmitEvent)}>
      <h2 id="publish-title">Publish</h2>
      <p class="quiet small">
        Whoever has the address sees {"run" in of ? "this archive as it is now" : "this creature"} and its
        ancestry, without a token, and nothing else. You can take it back at any time.
      </p>
      <Fields title={title} file={file} />
      {error && (
        <p class="banner wrong" role="alert">
          {error}
        </p>
      )}
      <p class="links">
        <button class="primary" disabled={busy}>
          {busy ? "Publishing …" : "Publish"}
        </button>
        <button type="button" onClick={onEnd}>
          Cancel
        </button>
      </p>
    </form>
  );
}

function Fields({ title, file }: Pick<Props, "title" | "file">) {
  const [term, setTerm] = useState<string>("never");
  const licences = LICENCES.some(([name]) => name === (file?.licence ?? name))
    ? LICENCES
    : [[file!.licence, `${file!.licence}: as its file says`] as const, ...LICENCES];
  return (
    <>
      <label>
        Title
        <input name="title" maxLength={200} defaultValue={title} placeholder="What it is called" />
      </label>
      <label>
        Credit
        <input name="credit" maxLength={1000} placeholder="Names, with commas between them" />
      </label>
      {file?.credit && file.credit.length > 0 && (
        <p class="quiet small">Its file names {file.credit.join(", ")} already, who stay named.</p>
      )}
      <label>
        Licence
        <select name="licence" defaultValue={file?.licence ?? LICENCES[0][0]}>
          <Options of={licences} />
        </select>
      </label>
      <label>
        Expires
        <select name="term" value={term} onChange={(event) => setTerm(event.currentTarget.value)}>
          <Options of={TERMS} />
        </select>
      </label>
      {term === "date" && (
        <label>
          Last moment
          <input name="until" type="datetime-local" required />
        </label>
      )}
      <label class="check">
        <input name="listed" type="checkbox" /> List it in the commons, for everybody to find
      </label>
    </>
  );
}

/** What the form asks for; an empty field is left to the server. */
export function requestOf(form: FormData, now = Date.now()): ShareRequest {
  const text = (name: string) => String(form.get(name) ?? "").trim();
  const credit = text("credit")
    .split(",")
    .map((name) => name.trim());
  return {
    ...(text("title") && { title: text("title") }),
    credit: credit.filter(Boolean),
    licence: text("licence"),
    expires_at: endOf(text("term"), text("until"), now),
    listed: form.get("listed") === "on",
  };
}

function endOf(term: string, until: string, now: number): string | null {
  if (term === "date") return new Date(until).toISOString();
  return term === "never" ? null : new Date(now + Number(term) * DAY_MS).toISOString();
}

function Published({ share, onEnd }: { share: Share; onEnd: () => void }) {
  const address = useRef<HTMLInputElement>(null);
  useEffect(() => address.current!.focus(), []);
  return (
    <div class="published">
      <h2 id="publish-title">Published</h2>
      <label>
        Its address
        <input ref={address} readOnly value={share.url} onFocus={(event) => event.currentTarget.select()} />
      </label>
      <p class="links">
        <button class="primary" onClick={() => void copyText(share.url, "Link copied.")}>
          Copy link
        </button>
        <a class="button" href={`/s/${share.slug}`} target="_blank">
          Look at it
        </a>
        <a class="button" href="/shares">
          All shares
        </a>
        <button onClick={onEnd}>Done</button>
      </p>
    </div>
  );
}
