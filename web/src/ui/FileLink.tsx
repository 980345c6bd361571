/** A download link that shows an error if the file does not exist. */

import { checkFile, save } from "../api/files";
import { showFailure } from "../store/toasts";

export function FileLink({ url, name, title }: { url: string; name: string; title?: string }) {
  const download = (event: MouseEvent) => {
    event.preventDefault();
    checkFile(url)
      .then(() => save(url))
      .catch(showFailure);
  };
  return (
    <a class="button" href={url} title={title} onClick={download}>
      {name}
    </a>
  );
}
