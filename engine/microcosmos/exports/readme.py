"""README of a published run: its content, and the command that repeats it."""

from collections.abc import Mapping, Sequence
from shlex import quote
from typing import Any

from ..spec import breeding_refusal
from .run_file import RunFile

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


def readme(run: RunFile, title: str, licence: str, file: str, about: Mapping[str, str]) -> str:
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

Licence: {licence}. `CITATION.cff` says how to cite this data set.
"""


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
