/** The dialog that publishes a creature or an archive. */

import { useEffect, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import type { Creature, Share, ShareRequest } from "../api/types";
import { inDays } from "../ui/format";
import { Options } from "../ui/Select";
import { useSubmit } from "../ui/forms";
import { copyText } from "../ui/clipboard";
import { FIELDS } from "./fields";
import { Unreachable } from "./Unreachable";
import { text } from "./text";
import "./publish.css";

export interface Props {
  of: { creature: string } | { run: string };
  /** The current title; empty without one. */
  title: string;
  file?: Creature;
}

const LICENCES = Object.entries(text.licences);

/** Open the dialog whenever `opened` increases; typed values are kept. */
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

type FormProps = Props & { onDone: (share: Share) => void; onEnd: () => void };

function PublishForm({ of, title, file, onDone, onEnd }: FormProps) {
  const { busy, error, onSubmit } = useSubmit(async (form) =>
    onDone(await api.publish({ ...of, ...requestOf(new FormData(form)) })),
  );
  return (
    <form onSubmit={onSubmit}>
      <h2 id="publish-title">{text.publish}</h2>
      <p class="quiet small">{text.about("run" in of)}</p>
      <Fields title={title} file={file} />
      {error && (
        <p class="banner wrong" role="alert">
          {error}
        </p>
      )}
      <p class="links">
        <button class="primary" disabled={busy}>
          {busy ? text.publishing : text.publish}
        </button>
        <button type="button" onClick={onEnd}>
          {text.cancel}
        </button>
      </p>
    </form>
  );
}

function Fields({ title, file }: Pick<Props, "title" | "file">) {
  const [term, setTerm] = useState<string>("never");
  const licences = licencesFor(file);
  const [licence, setLicence] = useState(file?.licence ?? licences[0]![0]);
  return (
    <>
      {FIELDS.map(({ name, label, hint, longest, heading }) => (
        <label key={name} class="over">
          {label}
          <input name={name} maxLength={longest} defaultValue={heading ? title : ""} placeholder={hint} />
        </label>
      ))}
      <label class="over">
        {text.credit}
        <input name="credit" maxLength={1000} placeholder={text.creditHint} />
      </label>
      {file?.credit && file.credit.length > 0 && (
        <p class="quiet small">{text.creditOfFile(file.credit.join(", "))}</p>
      )}
      <label class="over">
        {text.licence}
        <select name="licence" value={licence} onChange={(event) => setLicence(event.currentTarget.value)}>
          <Options of={licences} />
        </select>
      </label>
      <label class="over">
        {text.expires}
        <select name="term" value={term} onChange={(event) => setTerm(event.currentTarget.value)}>
          <Options of={text.terms} />
        </select>
      </label>
      {term === "date" && (
        <label class="over">
          {text.expiryDate}
          <input name="until" type="datetime-local" required />
        </label>
      )}
      <label class="check">
        <input name="listed" type="checkbox" /> {text.list}
      </label>
    </>
  );
}

/** The licences to choose from. An archive has none of its own: the server joins those of its creatures. */
export function licencesFor(file?: Pick<Creature, "licence">): [name: string, title: string][] {
  if (!file) return [["", text.licenceOfAll], ...LICENCES];
  if (LICENCES.some(([name]) => name === file.licence)) return LICENCES;
  return [[file.licence, text.licenceOfFile(file.licence)], ...LICENCES];
}

/** The request of the form; empty fields are left out. */
export function requestOf(form: FormData, now = Date.now()): ShareRequest {
  const value = (name: string) => String(form.get(name) ?? "").trim();
  const credit = value("credit")
    .split(",")
    .map((name) => name.trim());
  return {
    ...Object.fromEntries(FIELDS.flatMap(({ name }) => (value(name) ? [[name, value(name)]] : []))),
    credit: credit.filter(Boolean),
    licence: value("licence") || null,
    expires_at: endOf(value("term"), value("until"), now),
    listed: form.get("listed") === "on",
  };
}

function endOf(term: string, until: string, now: number): string | null {
  if (term === "date") return new Date(until).toISOString();
  return term === "never" ? null : inDays(Number(term), now);
}

function Published({ share, onEnd }: { share: Share; onEnd: () => void }) {
  const address = useRef<HTMLInputElement>(null);
  useEffect(() => address.current!.focus(), []);
  return (
    <div class="published">
      <h2 id="publish-title">{text.published}</h2>
      <label class="over">
        {text.link}
        <input ref={address} readOnly value={share.url} onFocus={(event) => event.currentTarget.select()} />
      </label>
      <Unreachable url={share.url} />
      <p class="links">
        <button class="primary" onClick={() => void copyText(share.url, text.linkCopied)}>
          {text.copyLink}
        </button>
        <a class="button" href={`/s/${share.slug}`} target="_blank">
          {text.open}
        </a>
        <a class="button" href="/shares">
          {text.allShares}
        </a>
        <button onClick={onEnd}>{text.done}</button>
      </p>
    </div>
  );
}
