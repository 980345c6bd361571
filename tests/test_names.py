"""Old names are gone from modules, public identifiers, tables, columns and the API."""

import ast
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer

from microcosmos.cli import app
from server.tables import Base

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[1]
OLD = {
    *("own", "own_specs", "own_schemas", "own_of", "is_own", "Own", "OwnBody", "OwnControl"),
    *("OwnName", "MaybeOwn", "Told", "Shelf", "origins", "Origin", "born", "kin"),
    *("brood", "Brood", "fates", "FATES", "told", "niches", "again", "telling", "agreement"),
    *("feature", "features", "Feature", "FEATURES", "Said", "played", "answered", "seen"),
    *("Seen", "at_once", "heard", "bands", "planning", "sweeping", "binned"),
    *("purging", "leftovers", "discarded", "needs", "Door", "guard", "caller", "guesses"),
    *("discretion", "readers", "quarantine", "warming", "fence", "Fenced", "pace", "wish"),
    *("device_leave", "forked", "standing", "left", "chance", "reach"),
    *("beginning", "keeping", "following", "most", "KEPT", "AT_ONCE", "DECISIVE"),
}


def sources() -> list[Path]:
    roots = (ROOT / "engine" / "microcosmos", ROOT / "server", ROOT / "worker")
    return [path for root in roots for path in sorted(root.rglob("*.py"))]


def public(path: Path) -> Iterator[str]:
    """Yield the module's name, and its classes, functions, methods, fields and constants."""
    yield path.stem
    tree = ast.parse(path.read_text())
    functions = (ast.FunctionDef, ast.AsyncFunctionDef)
    classes = [node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    for owner in (tree, *classes):
        for node in owner.body:
            if isinstance(node, (*functions, ast.ClassDef)):
                yield node.name
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                yield node.target.id
            elif isinstance(node, ast.Assign):
                yield from (one.id for one in node.targets if isinstance(one, ast.Name))


def test_no_module_or_public_identifier_has_an_old_name():
    found = {
        f"{path.relative_to(ROOT).as_posix()}:{name}"
        for path in sources()
        for name in public(path)
        if name in OLD
    }
    assert not found


def test_no_table_or_column_has_an_old_name():
    tables = Base.metadata.tables
    names = {*tables, *(column.name for table in tables.values() for column in table.columns)}
    assert not names & OLD


def test_no_field_of_the_api_has_an_old_name():
    document = json.loads((ROOT / "web" / "openapi.json").read_text())
    schemas = document["components"]["schemas"].values()
    fields = {name for schema in schemas for name in schema.get("properties", {})}
    assert not fields & OLD


def parameters(command, path: str) -> Iterator[str]:
    """Yield the options and arguments of a command and of those below it."""
    for parameter in command.params:
        yield from (f"{path} {name.lstrip('-')}" for name in (parameter.name, *parameter.opts))
    for name, inner in getattr(command, "commands", {}).items():
        yield f"{path} {name}"
        yield from parameters(inner, f"{path} {name}")


def test_no_command_or_option_has_an_old_name():
    found = set(parameters(typer.main.get_command(app), "microcosmos"))
    assert len(found) > 50
    assert not {name for name in found if name.rpartition(" ")[2].replace("-", "_") in OLD}


def test_routes_are_imported_by_the_application_alone():
    importing = {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "server").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom)
        for name in (*(node.module or "").split("."), *(one.name for one in node.names))
        if name == "routes" or name.endswith("_routes")
    }
    assert importing == {"server/app.py"}
