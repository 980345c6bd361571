"""Loading of plug-in modules, from files and from installed packages."""

import importlib.util
import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from . import registry
from .declaration import MARK, NAME, Declaration, Draft
from .registry import Plugin

GROUP = "microcosmos.plugins"
"""Group of the entry points by which installed packages name their modules."""


@dataclass(frozen=True)
class FailedModule:
    """A module that could not be loaded, and the reason."""

    module: str
    reason: str


def load(path: Path | str) -> tuple[Declaration, ...]:
    """Run a module's file and register its plug-ins under the file's name.

    Raises `ValueError` where it is no module, declares nothing or fails.
    """
    file = Path(path).resolve()
    if file.suffix != ".py" or not file.is_file():
        there = "" if file.exists() else ", which is not there"
        raise ValueError(f"a module must be a Python file (.py), got {path}{there}")
    # Read once, so that the hash is that of the code that runs.
    source = file.read_bytes()
    module = _run(path, file, source)
    return _register(module, file.stem, sha256(source).hexdigest())


def _run(path: Path | str, file: Path, source: bytes) -> ModuleType:
    name = f"microcosmos_plugin_{file.stem}"
    found = importlib.util.spec_from_file_location(name, file)
    assert found is not None
    module = importlib.util.module_from_spec(found)
    before = sys.modules.get(name)
    sys.modules[name] = module  # Annotations of its classes are looked up there.
    try:
        exec(compile(source, file, "exec", dont_inherit=True), vars(module))
    except BaseException as error:
        if before is None:
            del sys.modules[name]
        else:
            sys.modules[name] = before
        if isinstance(error, KeyboardInterrupt):
            raise
        where = registry.line_suffix(error, str(file))
        raise ValueError(f"{path}{where} fails with {type(error).__name__}: {error}") from error
    return module


def _register(module: ModuleType, namespace: str, source: str) -> tuple[Declaration, ...]:
    if not re.fullmatch(NAME, namespace):
        raise ValueError(f"a module's name must be of a-z, 0-9 and _, got {namespace!r}")
    file = str(module.__file__)
    other = registry.location_of(namespace)
    if other not in (None, file):
        raise ValueError(f"two modules are called {namespace!r}: {other} and {file}")
    found = [_plugin(*one, f"{namespace}.", source, file) for one in _declared(module)]
    if not found:
        raise ValueError(f"{file} declares nothing: it needs a @plugins.fitness or another")
    names = [one.declaration.name for one in found]
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"{file} declares {twice[0]!r} more than once")
    registry.replace(namespace, found)
    return tuple(one.declaration for one in found)


def load_all(paths: Iterable[Path | str]) -> tuple[FailedModule, ...]:
    """Load files and the modules of installed packages; return those that failed.

    A failing module must not end the process.
    """
    entries = sorted(entry_points(group=GROUP), key=lambda one: one.name)
    loaders: list[tuple[str, Callable[[Any], Any], Any]] = [
        *((str(path), load, path) for path in paths),
        *((f"{entry.name} ({entry.value})", _load_entry, entry) for entry in entries),
    ]
    failed = []
    for module, load_one, source in loaders:
        try:
            load_one(source)
        except (Exception, SystemExit) as error:
            kind = "" if isinstance(error, ValueError) else f"{type(error).__name__}: "
            failed.append(FailedModule(module, f"{kind}{error}"))
    return tuple(failed)


def digest(file: Path) -> str:
    """Return the SHA-256 of a module's source, or of all Python files of a package."""
    if file.name != "__init__.py":
        return sha256(file.read_bytes()).hexdigest()
    whole = sha256()
    for part in sorted(file.parent.rglob("*.py")):
        name = part.relative_to(file.parent).as_posix()
        whole.update(f"{name}\0{sha256(part.read_bytes()).hexdigest()}\n".encode())
    return whole.hexdigest()


def _load_entry(entry: EntryPoint) -> None:
    module = entry.load()
    if not isinstance(module, ModuleType):
        raise ValueError(f"the entry point must name a module, got {type(module).__name__}")
    _register(module, entry.name, digest(Path(str(module.__file__))))


def _declared(module: ModuleType) -> list[tuple[Draft, Any]]:
    found = [
        one for one in vars(module).values() if isinstance(getattr(one, MARK, None), Draft)
    ]
    defined = [one for one in dict.fromkeys(found) if one.__module__ == module.__name__]
    return [(getattr(one, MARK), one) for one in defined]


def _plugin(draft: Draft, function: Any, prefix: str, source: str, location: str) -> Plugin:
    model = draft.settings
    declaration = Declaration(
        **draft.fields | {"name": prefix + draft.fields["name"]},
        source=source,
        about=" ".join((function.__doc__ or "").split("\n\n")[0].split()),
        settings=model.model_json_schema() if model else None,
        defaults=model().model_dump(mode="json") if model else {},
    )
    return Plugin(declaration, function, model, location)
