"""No file over 300 lines, no function over 50, server packages of 2 to 12 files."""

import ast
from pathlib import Path

import pytest

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[1]
FILES = [
    path
    for folder in ("engine", "server", "worker", "tests", "web/scripts", "examples")
    for path in sorted((ROOT / folder).rglob("*.py"))
    if "node_modules" not in path.parts
]
ASSEMBLY = {"app.py", "main.py", "settings.py", "__init__.py"}


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def test_no_file_has_over_300_lines():
    long = {name(path) for path in FILES if len(path.read_text().splitlines()) > 300}
    assert not long


def test_no_function_has_over_50_lines():
    functions = (ast.FunctionDef, ast.AsyncFunctionDef)
    long = {
        f"{name(path)}:{node.name}"
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, functions) and node.end_lineno - node.lineno >= 50
    }
    assert not long


def test_server_packages_have_2_to_12_files_and_only_assembly_is_flat():
    server = ROOT / "server"
    assert {path.name for path in server.glob("*.py")} <= ASSEMBLY
    counts = {
        path.name: len([one for one in path.glob("*.py") if one.name != "__init__.py"])
        for path in server.iterdir()
        if path.is_dir() and any(path.glob("*.py"))
    }
    assert not {package for package, count in counts.items() if not 2 <= count <= 12}
