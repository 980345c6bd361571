/** A share within a page of another site: its motion, title and licence. */

import * as api from "../api/client";
import type { Share } from "../api/types";
import { LoopPlayer } from "../replay/LoopPlayer";
import { SwimmingBody } from "../replay/SwimmingBody";
import { ReplayStatus, useReplays } from "../replay/replays";
import { useFetched } from "../store/fetch";
import { usePoseStream } from "../store/poses";
import { text } from "./text";
import "./shares.css";

interface Props {
  slug: string;
  /** `creature` is one of a shared archive; by default its best is shown. */
  query: URLSearchParams;
}

export function EmbedPage({ slug, query }: Props) {
  const { value: share, error } = useFetched(() => api.readShare(slug), [slug]);
  if (error) return <p class="banner wrong">{error}</p>;
  return share && <Embedded share={share} sha={query.get("creature") ?? share.cover} />;
}

function Embedded({ share, sha }: { share: Share; sha: string }) {
  const { title, url, credit, licence } = share;
  const rendering = useReplays([sha]);
  const replay = rendering.replays?.[0];
  const { stream } = usePoseStream(replay ? null : sha);
  return (
    <main class="embedded">
      <ReplayStatus {...rendering} what={text.recording}>
        {stream && <SwimmingBody stream={stream} label={title} path />}
      </ReplayStatus>
      {replay && <LoopPlayer replay={replay} />}
      <header class="small">
        <h1>
          <a href={url} target="_blank" rel="noopener">
            {title}
          </a>
        </h1>
        <span class="quiet">{[...credit, licence.slice(0, 40), "Microcosmos"].join(" · ")}</span>
      </header>
    </main>
  );
}
