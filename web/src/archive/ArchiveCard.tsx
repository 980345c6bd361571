/** The archive of a run, as a map or a gallery, at any generation. */

import { useCallback, useEffect, useRef, useState } from "preact/hooks";
import { pageUrl, sharedSlug } from "../api/address";
import type { Archive, Run } from "../api/types";
import type { Elite, Elites } from "../store/elites";
import { navigate, setQuery } from "../store/router";
import { containerOf, measureOf, objectiveOf, FITNESS, type Measure } from "./axes";
import { ArchiveMap } from "./ArchiveMap";
import { MapOptions, kindOf, ReprojectionFigures, Slices } from "./MapOptions";
import { TimeSlider } from "../replay/timeControls";
import { count, number } from "../ui/format";
import { Segments } from "../ui/Select";
import { TrustBadge } from "../ui/TrustBadge";
import { ForkLink } from "../ui/links";
import { SelectToggle, SelectionBar, useSelection } from "./SelectionBar";
import { lazy } from "../ui/lazy";
import { useTour } from "./tour";
import { ElitePreview } from "./ElitePreview";
import { type ArchiveView, useArchiveView } from "./archiveView";
import type { ArchiveViewProps } from "./binFocus";
import { type Projection, elitesIn } from "./projection";
import type { Selection } from "./selection";
import { Gallery } from "./Gallery";
import { text } from "./text";
import "./map.css";
import "./archive.css";

const ArchiveTour = lazy(async () => (await import("./tour/ArchiveTour")).ArchiveTour, null);

interface Props {
  run: Run;
  archive: Archive;
  elites: Elites;
  query: URLSearchParams;
}

export function ArchiveCard({ run, archive, elites, query }: Props) {
  const [at, setAt] = useShownGeneration(query, run.generation);
  const view = useArchiveView(run, archive, elites, query, at);
  const [focused, setFocused] = useState<Elite | null>(null);
  const tour = useTour(run);
  const [tourPart, setTourPart] = useState<string | null>(null);
  const gallery = query.get("view") === "gallery";
  const selection = useSelection(query, view.elites);
  const props = useViewProps(run, view, gallery ? view.grid : view.map, selection, query);
  const owner = view.of === "elites" ? run.id : null;
  // Other creatures or axes are another map, in which no cell has changed.
  const key = [view.axes[0].name, view.axes[1].name, view.of, view.reprojection !== null].join(" ");
  return (
    <div data-tour={tourPart}>
      <Head
        count={view.elites.size}
        kind={owner && kindOf(run, archive)}
        gallery={gallery}
        onTour={tour.begin}
      />
      <MapOptions archive={archive} view={view} />
      {view.reprojection && <ReprojectionFigures archive={view.archive} reprojection={view.reprojection} />}
      <Slices slices={view.slices} />
      {gallery ? (
        <Gallery key={key} {...props} {...{ at, query }} run={owner} />
      ) : (
        <ArchiveMap
          key={key}
          {...props}
          {...{ run: owner, at }}
          elites={view.elites}
          onFocus={setFocused}
          inset={focused && <ElitePreview sha={focused.creature} />}
        />
      )}
      <BinElites {...props} objective={measureOf(objectiveOf(run, archive), archive, view.measures)} />
      {view.error && <p class="banner wrong">{view.error}</p>}
      <TimeSlider last={run.generation} at={at} ready={view.ready} onMove={setAt} />
      <SelectionBar {...{ run, at }} of={view.of} trust={view.trust} elites={view.elites} {...selection} />
      {tour.open && (
        <ArchiveTour
          {...{ run, view, tour }}
          onPart={setTourPart}
          onMark={props.marked === null ? props.onMark : null}
        />
      )}
    </div>
  );
}

/** Props of both map and gallery. */
function useViewProps(
  run: Run,
  view: ArchiveView,
  projection: Projection,
  selection: Selection,
  query: URLSearchParams,
): ArchiveViewProps {
  const cell = query.get("cell");
  const onMark = useCallback((marked: number) => setQuery({ cell: String(marked) }), []);
  return {
    axes: view.axes,
    colouring: view.colouring,
    lists: containerOf(run) !== null,
    marked: cell === null ? null : Number(cell),
    onMark,
    ...selection,
    projection,
    actions: ({ creature, trusted }, cell) => (
      <>
        <TrustBadge
          trusted={trusted}
          href={sharedSlug ? undefined : `/creatures/${creature}?run=${run.id}#audit`}
        />
        <ForkLink run={run.id} creatures={[creature]} title={text.forkCreature} inline />
        <SelectToggle {...{ cell, projection }} {...selection} />
      </>
    ),
    onOpen: (selected) => {
      setQuery({ cell: String(selected) });
      navigate(pageUrl(`/creatures/${view.elites.get(selected)!.creature}?run=${run.id}`));
    },
  };
}

interface HeadProps {
  count: number;
  /** The kind of the archive's places. */
  kind: string | null;
  gallery: boolean;
  onTour: () => void;
}

function Head({ count: elites, kind, gallery, onTour }: HeadProps) {
  return (
    <div class="card-head archive-head">
      <h2 id="archive-title">{text.archive}</h2>
      <span class="quiet">{text.elites(count(elites))}</span>
      {kind && <span class="quiet small">{kind}</span>}
      <span class="spring" />
      <button class="plain small-button" onClick={onTour}>
        {text.explain}
      </button>
      <Segments
        label={text.view}
        choices={VIEWS}
        value={gallery ? "gallery" : "map"}
        onSelect={(view) => setQuery({ view: view === "map" ? null : view })}
      />
    </div>
  );
}

const VIEWS = [
  ["map", text.map],
  ["gallery", text.gallery],
] as const;

const DELAY_MS = 300;

/** The generation shown, null for the newest; the address follows with a delay. */
function useShownGeneration(query: URLSearchParams, last: number) {
  const given = query.get("at");
  const requested = given !== null && /^\d+$/.test(given) ? Number(given) : null;
  const [at, setAt] = useState(requested);
  const written = useRef(requested);
  useEffect(() => {
    // Back and forward change the address too.
    if (requested !== written.current) setAt(requested);
    written.current = requested;
  }, [requested]);
  useEffect(() => {
    if (at === requested) return;
    const timer = setTimeout(() => {
      written.current = at;
      setQuery({ at: at === null ? null : String(at) });
    }, DELAY_MS);
    return () => clearTimeout(timer);
    // The address may follow an earlier value only after the next one was chosen.
  }, [at, requested]);
  // After a rewind, the requested generation may not exist.
  return [at !== null && at >= last ? null : at, setAt] as const;
}

interface BinElitesProps extends ArchiveViewProps {
  /** The second objective of fronts; fitness if there is none. */
  objective: Measure;
}

/** The elites of the marked bin, to step through a front or another bin of a pool. */
function BinElites({ lists, projection, marked, onMark, objective }: BinElitesProps) {
  const bin = marked === null ? undefined : projection.bins.get(marked);
  if (!lists || bin === undefined) return null;
  const elites = elitesIn(projection, bin);
  if (elites.length < 2) return null;
  return (
    <section class="bin-elites" aria-label={text.binElites}>
      <ol>
        {elites.map(([cell, elite]) => (
          <li key={cell}>
            <button class="plain" aria-pressed={cell === marked} onClick={() => onMark(cell)}>
              {text.fitness} <b>{number(elite.fitness)}</b>
              {objective.name !== FITNESS && (
                <>
                  {" "}
                  {objective.title} <b>{number(objective.valueOf(elite))}</b>
                </>
              )}
            </button>
          </li>
        ))}
      </ol>
    </section>
  );
}
