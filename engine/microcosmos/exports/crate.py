"""A run as a RO-Crate: a folder that is ready for Zenodo."""

import hashlib
import json
from collections.abc import Mapping
from datetime import UTC, datetime
from io import BytesIO
from typing import Any, NamedTuple

from ..archive import export
from ..optional import require
from ..version import VERSION
from . import arrow, births
from .citation import NOBODY, Publication, citation, person
from .dataset import netcdf, of_run
from .environment import environment, requirements
from .readme import ENVIRONMENT, REQUIREMENTS, SPEC, command, readme, summary
from .run_file import RunFile

VERSION_OF_CRATE = "1.1"
METADATA = "ro-crate-metadata.json"
SUMS = "SHA256SUMS"
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
SPDX = "https://spdx.org/licenses/"
KEYWORDS = ("artificial life", "quality-diversity", "evolution", "swimming", "soft robotics")
TYPES = {
    "arrow": "application/vnd.apache.arrow.file",
    "cff": "text/yaml",
    "csv": "text/csv",
    "h5": "application/x-hdf5",
    "json": "application/json",
    "md": "text/markdown",
    "nc": "application/x-netcdf",
    "nwk": "text/plain",
    "parquet": "application/vnd.apache.parquet",
    "pdf": "application/pdf",
    "png": "image/png",
    "txt": "text/plain",
}


class File(NamedTuple):
    """A file of the folder, and a sentence on it."""

    data: bytes
    about: str


Extra = Mapping[str, File]
"""Further files by name, such as the best creature and pictures."""


def crate(
    run: RunFile, publication: Publication | None = None, extra: Extra | None = None
) -> dict[str, bytes]:
    """Return the files of a RO-Crate of a search, by their paths in its folder.

    It holds the run's file, its tables, views and phylogeny, the spec, the environment, the
    command that repeats the run, checksums and a citation. Raises `ValueError` for a run
    without an archive, and `ImportError` without pyarrow, xarray or rocrate.
    """
    run.archive()  # It refuses other runs.
    about = publication or Publication()
    title = about.title or f"Microcosmos: the archive of {run.name} ({run.spec['experiment']})"
    file, found = f"{run.name}.h5", environment()
    files = {
        file: File(run.data, "the archive file of the run, which is also its checkpoint"),
        **_results(run),
        **(extra or {}),
        SPEC: File(_json(run.spec), "the spec: every parameter of the run"),
        ENVIRONMENT: File(_json(found), "Python, machine and packages of this export"),
        REQUIREMENTS: File(requirements(found).encode(), "the packages, for pip"),
        "CITATION.cff": File(citation(title, about, KEYWORDS).encode(), "how to cite it"),
    }
    described = {name: one.about for name, one in files.items()}
    text = readme(run, title, about.licence, file, described)
    files["README.md"] = File(text.encode(), "this description")
    files[METADATA] = File(_metadata(run, title, about, file, files), "the RO-Crate")
    whole = {name: one.data for name, one in files.items()}
    sums = (f"{hashlib.sha256(data).hexdigest()}  {name}\n" for name, data in whole.items())
    return whole | {SUMS: "".join(sums).encode()}


def _results(run: RunFile) -> dict[str, File]:
    files = {
        f"tables/{name}.parquet": File(arrow.parquet(arrow.of_runs([run], name)), text)
        for name, text in {
            "archive": "a row for each elite, with all measures",
            "curves": "a row for each generation",
            "lineage": "a row for each entry into the archive",
            "genomes": "the genes of each elite",
            "poses": "the last two strokes of each elite",
        }.items()
    }
    return files | {
        "archive.nc": File(netcdf(of_run(run)), "the archive for xarray"),
        "archive.csv": File(
            export.csv(run.data).encode(), "the archive in the columns of pyribs"
        ),
        "phylogeny.csv": File(
            births.written(run, "csv"), "the phylogeny, in the ALife data standard"
        ),
        "phylogeny.nwk": File(
            births.written(run, "nwk"), "its trees by first parents, in Newick"
        ),
    }


def _metadata(
    run: RunFile, title: str, about: Publication, main: str, files: Mapping[str, File]
) -> bytes:
    library = require("rocrate.rocrate", arrow.EXTRA)
    made = library.ROCrate(version=VERSION_OF_CRATE)
    add, context = made.add, require("rocrate.model.contextentity", arrow.EXTRA)

    def entity(identifier: str, /, **properties: Any) -> Any:
        return add(context.ContextEntity(made, identifier, properties=properties))

    licence = entity(
        f"{SPDX}{about.licence}", **{"@type": "CreativeWork", "name": about.licence}
    )
    made.name, made.description = title, summary(run)
    made.datePublished, made.keywords = about.published, list(KEYWORDS)
    made.license = licence
    authors = [
        entity(f"#author-{number}", **_schema_person(author))
        for number, author in enumerate(about.authors or NOBODY, 1)
    ]
    made.root_dataset["author"] = authors if len(authors) > 1 else authors[0]
    profile = entity(
        PROFILE,
        **{"@type": "CreativeWork", "name": "Process Run Crate", "version": "0.5"},
    )
    made.root_dataset["conformsTo"] = profile
    added = {
        name: made.add_file(BytesIO(one.data), name, properties=_file(name, one))
        for name, one in files.items()
    }
    made.mainEntity = added[main]
    _add_actions(made, run, entity, added, main)
    return _json(made.metadata.generate())


def _add_actions(
    made: Any, run: RunFile, entity: Any, added: Mapping[str, Any], main: str
) -> None:
    """Say that the software made the run's file from the spec, and the export the others."""

    def software(identifier: str, name: str, version: str) -> Any:
        kind = {"@type": "SoftwareApplication", "name": name}
        return entity(identifier, **kind, version=version)

    def action(identifier: str, name: str, description: str, **links: Any) -> Any:
        one = entity(identifier, **{"@type": "CreateAction", "name": name})
        one["description"] = description
        for link, value in {**links, "agent": made.root_dataset["author"]}.items():
            one[link] = value
        return one

    others = [one for name, one in added.items() if name not in (main, SPEC)]
    evolved = action(
        "#run",
        f"The run {run.name}",
        command(run),
        instrument=software("#microcosmos", "Microcosmos", run.attributes["version"]),
        object=added[SPEC],
        result=added[main],
    )
    exported = action(
        "#exported",
        "The export of this folder",
        "microcosmos export --as ro-crate",
        instrument=software("#export", "Microcosmos, export", VERSION),
        object=added[main],
        result=others,
    )
    exported["endTime"] = datetime.now(UTC).isoformat(timespec="seconds")
    made.root_dataset["mentions"] = [evolved, exported]


def _schema_person(author: str) -> dict[str, str]:
    named = person(author)
    if "name" in named:
        return {"@type": "Organization", "name": named["name"]}
    given, family = named["given-names"], named["family-names"]
    return {
        "@type": "Person",
        "name": f"{given} {family}",
        "givenName": given,
        "familyName": family,
    }


def _file(name: str, one: File) -> dict[str, Any]:
    kind = TYPES.get(name.rpartition(".")[2], "application/octet-stream")
    return {
        "name": name.rpartition("/")[2],
        "description": one.about[:1].upper() + one.about[1:],
        "encodingFormat": kind,
        "contentSize": str(len(one.data)),
        "sha256": hashlib.sha256(one.data).hexdigest(),
    }


def _json(document: Any) -> bytes:
    return json.dumps(document, indent=1, ensure_ascii=False).encode() + b"\n"
