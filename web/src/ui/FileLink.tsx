/** A download that says why where there is no such file. */

import { checkFile } from "../api/files";
import { messageOf } from "../api/problem";
import { showToast } from "../store/toasts";

export function FileLink({ url, name }: { url: string; name: string }) {
  const download = (event: MouseEvent) => {
    event.preventDefault();
    checkFile(url)
      .then(() => save(url))
      .catch((error) => showToast({ kind: "wrong", text: messageOf(error) }));
  };
  return (
    <a class="button" href={url} onClick={download}>
      {name}
    </a>
  );
}

/** As a click on a link would; the server says what the file is called. */
export function save(url: string): void {
  const link = document.createElement("a");
  link.href = url;
  link.download = "";
  link.click();
}
