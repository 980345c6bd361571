"""Loading of plug-in modules, from files and from installed packages."""

import importlib.util
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
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
        reason = "" if file.exists() else ", which is not there"
        raise ValueError(f"a module must be a Python file (.py), got {path}{reason}")
    # Read once, so that the hash is that of the code that runs.
    source = file.read_bytes()
    name = f"microcosmos_plugin_{file.stem}"
    before = sys.modules.get(name)
    try:
        module = _run(name, file, source)
        return _register(module, file.stem, sha256(source).hexdigest())
    except BaseException:
        # A module that fails must leave the version before it in place.
        if before is None:
            sys.modules.pop(name, None)
        else:
            sys.modules[name] = before
        raise


def _run(name: str, file: Path, source: bytes) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # Annotations of its classes are looked up there.
    with _naming(str(file)):
        exec(compile(source, file, "exec", dont_inherit=True), vars(module))
    return module


@contextmanager
def _naming(file: str) -> Iterator[None]:
    """Turn whatever a module's own code raises into a `ValueError` with its place."""
    try:
        yield
    except (Exception, SystemExit) as error:
        where = registry.line_suffix(error, file)
        raise ValueError(f"{file}{where} fails with {registry.told(error)}") from error


def _register(module: ModuleType, namespace: str, source: str) -> tuple[Declaration, ...]:
    if not re.fullmatch(NAME, namespace):
        raise ValueError(f"a module's name must be of a-z, 0-9 and _, got {namespace!r}")
    file = str(module.__file__)
    other = registry.location_of(namespace)
    if other not in (None, file):
        raise ValueError(f"two modules are called {namespace!r}: {other} and {file}")
    with _naming(file):  # Settings and their defaults are its own code too.
        plugins = [_plugin(*one, f"{namespace}.", source, file) for one in _declared(module)]
    if not plugins:
        raise ValueError(f"{file} declares nothing: it needs a @plugins.fitness or another")
    names = [one.declaration.name for one in plugins]
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"{file} declares {twice[0]!r} more than once")
    registry.replace(namespace, plugins)
    return tuple(one.declaration for one in plugins)


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
            ours = type(error) is ValueError
            failed.append(FailedModule(module, str(error) if ours else registry.told(error)))
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
    marked = [
        one for one in vars(module).values() if isinstance(getattr(one, MARK, None), Draft)
    ]
    # A module may import the plug-ins of another, which has them already.
    once = {id(one): one for one in marked}.values()  # Not all can be hashed.
    defined = [one for one in once if one.__module__ == module.__name__]
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
