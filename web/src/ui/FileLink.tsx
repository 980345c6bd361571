/** A download link that shows an error if the file does not exist. */

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

/** Download a file under the name that the server gives it. */
export function save(url: string): void {
  const link = document.createElement("a");
  link.href = url;
  link.download = "";
  link.click();
}
