"""`make texts`: print every text that people read, as a Markdown list for review."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

from microcosmos.cli import app

ROOT = Path(__file__).parent.parent
SPEC = ROOT / "engine/microcosmos/spec"
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"|`((?:[^`\\]|\\.)*)`')
WORDS = re.compile(r"(^|\s)[`(]?[A-Za-z][a-z]+[`),.:;]* .*[A-Za-z]{2}", re.S)
CODE = re.compile(
    r"^\s*(SELECT|INSERT|UPDATE|DELETE|CREATE|ALTER|DROP|WITH|PRAGMA|SET)\b"
    r"|^(default-src|attachment;|inline;|public,|bytes |text/)"
)


def page(path: Path) -> Iterator[str]:
    """Yield the strings of one `text.ts`."""
    source = re.sub(r"^import .*?;$|/\*\*.*?\*/", "", path.read_text(), flags=re.M | re.S)
    for quoted, template in LITERAL.findall(source):
        yield quoted or template


def commands(command: Any, name: str) -> Iterator[str]:
    """Yield the help of a command, of its parameters and of its subcommands."""
    yield f"**{name}**: {command.help}"
    for parameter in command.params:
        if text := getattr(parameter, "help", None):
            label = parameter.opts[0]
            yield f"`{name} {label if label.startswith('-') else label.upper()}`: {text}"
    for key, child in sorted(getattr(command, "commands", {}).items()):
        yield from commands(child, f"{name} {key}")


def messages(path: Path) -> Iterator[str]:
    """Yield the strings of a module that have words: errors, log lines, field descriptions."""
    tree = ast.parse(path.read_text())
    within = {
        id(part)
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr)
        for part in node.values
    }
    documented = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if id(node) in within | documented:
            continue
        if isinstance(node, ast.JoinedStr):
            text = "".join(
                part.value
                if isinstance(part, ast.Constant)
                else f"{{{ast.unparse(part.value)}}}"
                for part in node.values
            )
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            text = node.value
        else:
            continue
        if WORDS.search(text) and not CODE.match(text):
            yield text


def hints(path: Path) -> Iterator[str]:
    """Yield the docstrings of classes and fields, which the page's form shows."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ClassDef):
            for field, after in zip(node.body, node.body[1:], strict=False):
                if isinstance(field, ast.AnnAssign) and isinstance(after, ast.Expr):
                    name = f"{node.name}.{ast.unparse(field.target)}"
                    yield f"`{name}`: {ast.literal_eval(after.value)}"


def section(title: str, texts: Iterator[str]) -> None:
    lines = [re.sub(r"\s+", " ", text).strip() for text in dict.fromkeys(texts)]
    if any(lines):
        print(f"\n## {title}\n", *(f"- {line}" for line in lines if line), sep="\n")


if __name__ == "__main__":
    print("# Texts")
    for path in sorted((ROOT / "web/src").rglob("text.ts")):
        section(f"Page: {path.parent.relative_to(ROOT / 'web/src')}", page(path))
    section("Commands", commands(typer.main.get_command(app), "microcosmos"))
    for path in sorted(SPEC.rglob("*.py")):
        section(f"Form: {path.relative_to(SPEC)}", hints(path))
    for path in sorted([*SPEC.rglob("*.py"), *(ROOT / "server").rglob("*.py")]):
        if "tables" in path.parts:  # Constraints.
            continue
        section(f"Messages: {path.relative_to(ROOT)}", messages(path))
