"""A run as a RO-Crate: a folder that is ready for Zenodo, with a README and a citation."""

import hashlib
import json
import platform
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, requires, version
from io import BytesIO
from shlex import quote
from typing import Any, NamedTuple

from packaging.requirements import Requirement

from ..archive import export
from ..invalid import InvalidField
from ..naming import LICENCE
from ..optional import require
from ..spec import breeding_refusal
from ..version import VERSION
from . import arrow, run_file
from .dataset import netcdf, of_run
from .run_file import RunFile

PAPER = {
    "type": "article",
    "title": "Microcosmos: Reimagining Artificial Life for the GPU Era",
    "year": 2026,
    "authors": [
        {"given-names": given, "family-names": family}
        for given, family in (
            ("Mark", "Tensen"),
            ("Ciaran", "Regan"),
            ("Bert Wang-Chak", "Chan"),
            ("Mizuki", "Oka"),
            ("Kenneth O.", "Stanley"),
            ("Grisha", "Szep"),
        )
    ],
}
"""The paper whose model this software implements."""


@dataclass(frozen=True)
class Publication:
    """The title, authors, licence and day of a published run."""

    title: str = ""
    """Empty: that of the run, else made of its name and experiment."""
    authors: Sequence[str] = ()
    """`Family, Given`, or the name of a group."""
    licence: str = ""
    """An SPDX identifier. Empty: that of the archive file, else CC-BY-4.0."""
    day: date | None = None
    """Day of publication; None: today."""

    @property
    def published(self) -> date:
        return self.day or date.today()


def person(author: str) -> dict[str, str]:
    """Return an author as CFF describes one: a person, or an entity without a comma."""
    family, comma, given = (part.strip() for part in author.partition(","))
    if not comma:
        return {"name": family}
    return {"given-names": given, "family-names": family}


def citation(title: str, about: Publication, keywords: Sequence[str]) -> str:
    """Return a citation file in the Citation File Format 1.2."""
    document: dict[str, Any] = {
        "cff-version": "1.2.0",
        "message": "If you use this data set, please cite it, and the software that made it.",
        "type": "dataset",
        "title": title,
        "authors": [person(author) for author in about.authors or NOBODY],
        # CFF takes identifiers alone; a share may have any text.
        **({"license": about.licence} if IDENTIFIER.fullmatch(about.licence) else {}),
        "date-released": about.published.isoformat(),
        "keywords": list(keywords),
        "references": [
            {
                "type": "software",
                "title": "Microcosmos",
                "version": VERSION,
                "license": "Apache-2.0",
                "authors": [{"name": "The Microcosmos authors"}],
            },
            PAPER,
        ],
    }
    return "\n".join(_lines(document)) + "\n"


NOBODY = ("The authors of this data set",)
"""Stands in the files where no author is given; Zenodo asks for names."""


def _lines(document: Mapping[str, Any], indent: str = "") -> list[str]:
    """Return YAML; a text in JSON is one of its texts."""
    lines: list[str] = []
    for name, value in document.items():
        if isinstance(value, list):
            lines.append(f"{indent}{name}:")
            for one in value:
                if isinstance(one, Mapping):
                    first, *rest = _lines(one, f"{indent}    ")
                    lines += [f"{indent}  - {first.strip()}", *rest]
                else:
                    lines.append(f"{indent}  - {_scalar(one)}")
        else:
            lines.append(f"{indent}{name}: {_scalar(value)}")
    return lines


NO_YAML = re.compile(r"[\x7f-\x9f\u2028\u2029\ufeff\ufffe\uffff]")
"""Characters that may stand in a text in JSON, and in one in YAML only as `\\uXXXX`."""


def _scalar(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return NO_YAML.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


VERSION_OF_CRATE = "1.1"
METADATA = "ro-crate-metadata.json"
SUMS = "SHA256SUMS"
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
TERMS = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}
"""Terms beside those of the crate's own context, as Workflow Run RO-Crate defines them."""
SPDX = "https://spdx.org/licenses/"
IDENTIFIER = re.compile(r"[A-Za-z0-9][A-Za-z0-9.+-]*")
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
    without an archive and for an author or a licence that the files cannot have, and
    `ImportError` without pyarrow, xarray or rocrate.
    """
    run.archive()  # It refuses other runs.
    about = _checked(run, publication or Publication())
    made_up = f"Microcosmos: the archive of {run.name} ({run.spec['experiment']})"
    title = _one_line(about.title or run.title or made_up)
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
    text = readme(run, title, terms(run, about.licence), file, described)
    files["README.md"] = File(text.encode(), "this description")
    files[METADATA] = File(_metadata(run, title, about, file, files), "the RO-Crate")
    whole = {name: one.data for name, one in files.items()}
    # Last, over all other files (test_checksums_are_those_of_all_files).
    sums = (f"{hashlib.sha256(data).hexdigest()}  {name}\n" for name, data in whole.items())
    return whole | {SUMS: "".join(sums).encode()}


def _checked(run: RunFile, about: Publication) -> Publication:
    """Return the publication with its licence; raise `ValueError` for what files cannot say."""
    # Lines of `SUMS` and of the README have names of files.
    if run.name.splitlines() != [run.name]:
        raise InvalidField("name", f"of the run must have no line breaks; got {run.name!r}")
    for author in about.authors:
        if not all(person(author).values()):
            raise InvalidField(
                "authors", f"must be `Family, Given` or the name of a group; got {author!r}"
            )
    if about.licence and not IDENTIFIER.fullmatch(about.licence):
        raise InvalidField(
            "licence", f"must be an SPDX identifier, as {LICENCE}; got {about.licence!r}"
        )
    return replace(about, licence=about.licence or run.terms.get("licence", LICENCE))


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
            run_file.written(run, "csv"), "the phylogeny, in the ALife data standard"
        ),
        "phylogeny.nwk": File(
            run_file.written(run, "nwk"), "its trees by first parents, in Newick"
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

    named = IDENTIFIER.fullmatch(about.licence)
    licence = entity(
        f"{SPDX}{about.licence}" if named else "#licence",
        **{"@type": "CreativeWork", "name": about.licence},
    )
    made.metadata.extra_terms.update(TERMS)
    made.name, made.description = title, summary(run)
    made.datePublished, made.keywords = about.published, list(KEYWORDS)
    made.license = licence
    if credit := run.terms.get("credit"):
        made.root_dataset["creditText"] = ", ".join(credit)
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

    @cache
    def software(version: str) -> Any:
        # An absolute name, as the profile asks: a package URL (ECMA-427).
        name = {"@type": "SoftwareApplication", "name": "Microcosmos"}
        return entity(f"pkg:generic/microcosmos@{version}", **name, version=version)

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
        instrument=software(run.attributes["version"]),
        object=added[SPEC],
        result=added[main],
    )
    exported = action(
        "#exported",
        "The export of this folder",
        "microcosmos export --as ro-crate",
        instrument=software(VERSION),
        object=added[main],
        result=others,
    )
    if run.ended:
        evolved["endTime"] = run.ended
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


ROOTS = ("microcosmos", "microcosmos-kernels")


def packages() -> dict[str, str]:
    """Return the versions of this library and of all packages that it needs, as installed."""
    versions: dict[str, str] = {}
    waiting: list[str] = list(ROOTS)
    while waiting:
        name = waiting.pop()
        if name in versions:
            continue
        try:
            versions[name] = version(name)
        # The native kernel and packages for other systems may be absent.
        except PackageNotFoundError:
            continue
        for text in requires(name) or ():
            one = Requirement(text)
            # Without extras: the library runs without them.
            if one.marker is None or one.marker.evaluate({"extra": ""}):
                waiting.append(one.name.lower().replace("_", "-"))
    return dict(sorted(versions.items()))


def environment() -> dict[str, Any]:
    """Return Python, system, machine and packages of this process."""
    return {
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "packages": packages(),
    }


def requirements(environment: dict[str, Any]) -> str:
    """Return the packages as pip reads them."""
    return "".join(f"{name}=={number}\n" for name, number in environment["packages"].items())


SPEC = "spec.json"
ENVIRONMENT = "environment.json"
REQUIREMENTS = "requirements.txt"
CHOICES = "choices.json"


def command(run: RunFile) -> str:
    """Return the command that repeats a run in the folder of its files."""
    parts = ["microcosmos evolve", SPEC, f"--out {out(run)}"]
    if run.spec.get("search", {}).get("initial"):
        parts.append("--from INITIAL")
    if "choices" in run.tree:
        parts.append(f"--choices {CHOICES}")
    if run.plugins:
        parts.append("--module PLUGIN.py")
    return " ".join(parts)


def out(run: RunFile) -> str:
    """Return the file that the command writes, which is not that of the run."""
    return "again.h5" if run.name == "repeated" else "repeated.h5"


def readme(run: RunFile, title: str, terms: str, file: str, about: Mapping[str, str]) -> str:
    """Return the text in Markdown; `about` describes each file."""
    table = "\n".join(f"| `{name}` | {text} |" for name, text in about.items())
    return f"""# {title}

{summary(run)}

## Repeat it

```sh
pip install -r {REQUIREMENTS}
{command(run)}
sha256sum {quote(file)} {out(run)}
```

{_repeated(run)}

## Files

| file | |
|---|---|
{table}

`sha256sum -c SHA256SUMS` checks them all.

```python
import pandas as pd
import xarray as xr

elites = pd.read_parquet("tables/archive.parquet")
archive = xr.open_dataset("archive.nc")
archive["fitness"].plot()
```

{terms} `CITATION.cff` says how to cite this data set.
"""


def terms(run: RunFile, licence: str) -> str:
    """Return sentences on the licence, and on that and the credit of the archive file."""
    parts, shared = [f"Licence: {licence}."], run.terms
    if shared.get("licence", licence) != licence:
        parts.append(f"The archive file is under another one: {shared['licence']}.")
    if shared.get("credit"):
        parts.append(f"Credit: {', '.join(shared['credit'])}.")
    return _one_line(" ".join(parts))


def _one_line(text: str) -> str:
    """Return a text that people wrote for a line of the README, which breaks would end."""
    return " ".join(text.split())


def summary(run: RunFile) -> str:
    """Return a sentence on the run."""
    spec, archive = run.spec, run.archive()
    axes = " × ".join(axis["name"] for axis in spec["archive"]["descriptors"])
    best = (
        f"; the best fitness is {archive['fitness'].max():.4g}" if len(archive["cell"]) else ""
    )
    return (
        f"The archive of a run of {spec['experiment']!r} in Microcosmos "
        f"{run.attributes['version']}, over {axes}: {len(archive['cell']):,} elites after "
        f"{run.generation:,} generations, seed {spec['seed']}, fitness "
        f"{spec['task']['fitness']}{best}."
    )


def _repeated(run: RunFile) -> str:
    devices: Sequence[Any] = run.facts()["device"]
    kinds = "; then on ".join(f"`{device}`" for device in devices)
    parts = [
        f"The run was computed on {kinds}. The same version on the same kind of device gives "
        "the same bytes.",
        f"`{ENVIRONMENT}` and `{REQUIREMENTS}` list the packages of the machine that wrote "
        "this folder, which may be another one than that of the run.",
    ]
    if run.terms:
        parts.append(
            "The file has the attributes `licence` and `credit` of a share, or of initial "
            "creatures. The command writes these two only where the initial creatures have "
            "them: all else is the same."
        )
    planned = run.spec.get("search", {}).get("generations")
    if planned and planned != run.generation:
        parts.append(
            f"The file holds generation {run.generation:,} of {planned:,}: the command "
            "computes all of them."
        )
    if initial := run.spec.get("search", {}).get("initial"):
        parts.append(
            f"The run starts from {len(initial):,} creatures, which `search.initial` names: "
            "give their creature files, or the archive that they come from, as `INITIAL`."
        )
    if "choices" in run.tree and breeding_refusal(run.spec) is None:
        parts.append(
            f"People chose creatures during the run: the command needs `{CHOICES}`, which the "
            "server of the run exports."
        )
    if run.plugins:
        names = ", ".join(f"`{name}`" for name in run.plugins)
        parts.append(
            f"The run uses plug-ins ({names}), whose module is not in this folder. "
            f"`{SPEC}` has the SHA-256 of its source."
        )
    return "\n".join(parts)
