/** The archive of a run: as a map or as a wall of creatures, now or in the past. */

import { useCallback, useEffect, useRef, useState } from "preact/hooks";
import { pageUrl } from "../api/address";
import type { Archive, Run } from "../api/types";
import type { Elite, Elites } from "../store/elites";
import { navigate, setQuery } from "../store/router";
import { ArchiveMap, type HoveredElite } from "./ArchiveMap";
import { AxisSelect } from "./AxisSelect";
import { ColourSelect } from "./ColourSelect";
import { Slices } from "./Slices";
import { TimeSlider } from "./TimeSlider";
import { count } from "../ui/format";
import { Guide } from "../ui/Guide";
import { ForkLink } from "../ui/ForkLink";
import { SelectToggle, SelectionBar, useSelection } from "./SelectionBar";
import { bestOf, stepsOf, useGuide } from "./guide";
import { ElitePreview } from "./ElitePreview";
import { setSlice, useArchiveView } from "./archiveView";
import { ArchiveGallery } from "./ArchiveGallery";
import { text } from "./text";
import "./map.css";
import "./archive.css";

interface Props {
  run: Run;
  archive: Archive;
  elites: Elites;
  query: URLSearchParams;
}

export function ArchiveCard({ run, archive, elites, query }: Props) {
  const [at, setAt] = useMoment(query, run.generation);
  const view = useArchiveView(run, archive, elites, query, at);
  const [looking, setLooking] = useState<HoveredElite | null>(null);
  const guide = useGuide();
  const [about, setAbout] = useState<string | null>(null);
  const gallery = query.get("view") === "gallery";
  const cell = query.get("cell");
  const choosing = useSelection(query, view.elites);
  const projection = gallery ? view.grid : view.map;
  const common = {
    axes: view.axes,
    colouring: view.colouring,
    marked: cell === null ? null : Number(cell),
    onMark: useCallback((marked: number) => setQuery({ cell: String(marked) }), []),
    ...choosing,
    projection,
    actions: ({ creature }: Elite, cell: number) => (
      <>
        <ForkLink run={run.id} creature={creature} title={text.forkCreature} inline />
        <SelectToggle {...{ cell, projection }} {...choosing} />
      </>
    ),
    onOpen: (chosen: number) => {
      setQuery({ cell: String(chosen) });
      navigate(pageUrl(`/creatures/${view.elites.get(chosen)!.creature}?run=${run.id}`));
    },
  };
  const names: [string, string] = [view.axes[0].name, view.axes[1].name];
  return (
    <div data-guide={about}>
      <div class="card-head archive-head">
        <h2 id="archive-title">{text.archive}</h2>
        <span class="quiet">{text.elites(count(view.elites.size))}</span>
        <span class="spring" />
        <button class="plain small-button" onClick={guide.begin}>
          {text.explain}
        </button>
        <ViewSwitch gallery={gallery} />
      </div>
      <div class="archive-choices">
        <AxisSelect archive={archive} names={names} onChoose={([x, y]) => setQuery({ x, y })} />
        <ColourSelect
          archive={archive}
          colour={view.colour}
          palette={view.palette}
          onColour={(colour) => setQuery({ colour: colour === "fitness" ? null : colour })}
          onPalette={(palette) => setQuery({ palette: palette === "viridis" ? null : palette })}
        />
      </div>
      <Slices slices={view.slices} onChange={setSlice} />
      {gallery ? (
        <ArchiveGallery key={names.join(" ")} {...common} query={query} />
      ) : (
        <ArchiveMap
          key={names.join(" ")}
          {...common}
          elites={view.elites}
          onLook={setLooking}
          inset={looking && <ElitePreview sha={looking.elite.creature} />}
        />
      )}
      {view.error && <p class="banner wrong">{view.error}</p>}
      <TimeSlider last={run.generation} at={at} ready={view.ready} onMove={setAt} />
      <SelectionBar {...{ run, at }} elites={view.elites} {...choosing} />
      {guide.open && (
        <Guide
          steps={stepsOf(run, archive, view)}
          asked={guide.asked}
          onStep={({ about }) => {
            setAbout(about);
            const best = bestOf(view);
            if (about === "legend" && best && cell === null) common.onMark(best.cell);
          }}
          onEnd={() => {
            setAbout(null);
            guide.end();
          }}
        />
      )}
    </div>
  );
}

const SETTLED_MS = 300;

/** The generation that is shown, null for the newest; the address follows once it rests. */
function useMoment(query: URLSearchParams, last: number) {
  const moment = query.get("at");
  const asked = moment !== null && /^\d+$/.test(moment) ? Number(moment) : null;
  const [at, setAt] = useState(asked);
  const written = useRef(asked);
  useEffect(() => {
    // Back and forward move it too; what was written here may be passed already.
    if (asked !== written.current) setAt(asked);
    written.current = asked;
  }, [asked]);
  useEffect(() => {
    if (at === asked) return;
    const timer = setTimeout(() => {
      written.current = at;
      setQuery({ at: at === null ? null : String(at) });
    }, SETTLED_MS);
    return () => clearTimeout(timer);
  }, [at]);
  // After a rewind there are fewer generations than were asked for.
  return [at !== null && at >= last ? null : at, setAt] as const;
}

function ViewSwitch({ gallery }: { gallery: boolean }) {
  const views = [
    [text.map, null],
    [text.gallery, "gallery"],
  ] as const;
  return (
    <div class="choices" role="group" aria-label={text.view}>
      {views.map(([title, view]) => (
        <button
          key={title}
          type="button"
          aria-pressed={gallery === (view !== null)}
          onClick={() => setQuery({ view })}
        >
          {title}
        </button>
      ))}
    </div>
  );
}
