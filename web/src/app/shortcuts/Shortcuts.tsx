/** The keys of the page, in a dialogue that “?” opens. */

import { useEffect, useRef } from "preact/hooks";
import { text } from "./text";
import "./shortcuts.css";

export function Shortcuts({ onClose }: { onClose: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => dialog.current?.showModal(), []);
  return (
    <dialog ref={dialog} class="shortcuts" aria-labelledby="shortcuts-title" onClose={onClose}>
      <header class="card-head">
        <h2 id="shortcuts-title">{text.shortcuts}</h2>
        <span class="spring" />
        <button class="plain" aria-label={text.close} onClick={() => dialog.current?.close()}>
          ✕
        </button>
      </header>
      <div class="shortcut-lists">
        {Object.entries(text.keys).map(([where, keys]) => (
          <section key={where}>
            <h3>{where}</h3>
            <dl>
              {Object.entries(keys).map(([key, does]) => (
                <div key={key}>
                  <dt>
                    {key.split(" ").map((each) => (
                      <kbd key={each}>{each}</kbd>
                    ))}
                  </dt>
                  <dd>{does}</dd>
                </div>
              ))}
            </dl>
          </section>
        ))}
      </div>
    </dialog>
  );
}
