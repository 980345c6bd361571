/** The state of a form while its request is answered. */

import { useState } from "preact/hooks";
import { messageOf } from "../api/problem";

export function useSubmit(send: (form: HTMLFormElement) => Promise<void>) {
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<string | null>(null);
  const submit = async (form: HTMLFormElement) => {
    setBusy(true);
    setError(null);
    await send(form).catch((problem) => setError(messageOf(problem)));
    setBusy(false);
  };
  const onSubmit = (event: Event) => {
    event.preventDefault();
    void submit(event.currentTarget as HTMLFormElement);
  };
  return { busy, error, onSubmit };
}
