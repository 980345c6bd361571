"""The API reference: one page for each package, from signatures and docstrings.

Griffe reads the sources without importing them, so that building needs no JAX. A page has the
names that its package exports; docstrings are Markdown. The page of `microcosmos.measures` has
the table of all measures too, which needs the standard library alone.
"""

import re
import sys
from pathlib import Path
from typing import Any

import griffe
from sphinx.application import Sphinx

COMMANDS = ("cli", "doctor")
"""Packages for the shell; nobody imports them."""


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write(app: Sphinx) -> None:
    """Write `reference/*.md` beside the other sources."""
    root = griffe.load("microcosmos", search_paths=[app.srcdir.parent / "engine"])
    packages = [one for one in inner(root) if one.path.split(".")[1] not in COMMANDS]
    packages.sort(key=name)
    pages = {name(one): page(one) for one in packages}
    pages["measures"] += "\n" + measures(app.srcdir.parent / "engine")
    write_pages(app.srcdir / "reference", pages | {"index": index(root, packages)})


def measures(engine: Path) -> str:
    """The tables of measures and of their units."""
    sys.path.insert(0, str(engine))
    from microcosmos.measures.derived import table

    return table()


def inner(package: griffe.Module) -> list[griffe.Module]:
    """The packages inside a package, each before its own."""
    found = [one for one in package.modules.values() if one.is_init_module]
    return [each for one in found for each in (one, *inner(one))]


def name(package: griffe.Module) -> str:
    return package.path.removeprefix("microcosmos.")


def write_pages(folder: Path, pages: dict[str, str]) -> None:
    """Write the pages that have changed, because Sphinx reads newer files; remove others."""
    folder.mkdir(exist_ok=True)
    for path in folder.glob("*.md"):
        if path.stem not in pages:
            path.unlink()
    for name, text in pages.items():
        path = folder / f"{name}.md"
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def index(root: griffe.Module, packages: list[griffe.Module]) -> str:
    rows = "\n".join(f"| [`{one.path}`]({name(one)}.md) | {first(one)} |" for one in packages)
    pages = "\n".join(name(one) for one in packages)
    return f"""# Python API

These packages are public, by the names that they export. Shapes stand in the annotations:
`Float[Array, "node 2"]` is an array of floats with a row of two numbers for each node.
`import microcosmos` loads the names below when they are first used.

{lazy(root)}

| package | |
|---|---|
{rows}

```{{toctree}}
:hidden:

{pages}
```
"""


def lazy(root: griffe.Module) -> str:
    """The table of the names that the library itself offers, with their packages."""
    pairs = re.findall(r"'(\w+)': '([\w.]+)'", str(root["_HOME"].value))
    rows = [f"| `microcosmos.{key}` | `microcosmos.{home}` |" for key, home in pairs]
    return "\n".join(["| name | package |", "|---|---|", *rows])


def page(package: griffe.Module) -> str:
    modules = [one for one in package.modules.values() if not one.name.startswith("_")]
    table = "\n".join(f"| `{one.name}` | {first(one)} |" for one in modules)
    parts = [f"# `{package.path}`", doc(package), "| module | |\n|---|---|\n" + table]
    parts += [entry(one, path) for path, one in public(package)]
    return "\n\n".join(part for part in parts if part) + "\n"


def public(package: griffe.Module) -> list[tuple[str, Any]]:
    """The names that a package exports; those of its modules if it exports none."""
    homes = [package] if exported(package) else package.modules.values()
    pairs = [
        (f"{home.path}.{name}", find(home, name))
        for home in homes
        for name in exported(home) or defined(home)
    ]
    return [(path, one) for path, one in pairs if one and not one.is_module]


def exported(module: griffe.Module) -> list[str]:
    """The names in `__all__`, or those that the file of a package imports."""
    if module.exports:
        return list(map(str, module.exports))
    members = module.members.items()
    ours = f"{module.path}."
    names = [name for name, one in members if one.is_alias and one.target_path.startswith(ours)]
    return sorted(names) if module.is_init_module else []


def defined(module: griffe.Module) -> list[str]:
    """Public functions and classes of a module."""
    members = module.members.items()
    own = {name: one for name, one in members if not one.is_alias and not name.startswith("_")}
    return [name for name, one in own.items() if one.is_function or one.is_class]


def find(package: griffe.Module, name: str) -> Any:
    """The object of a name; None for a name that is assigned in a group."""
    one = package.members.get(name)
    try:
        return one.final_target if one and one.is_alias else one
    except griffe.AliasResolutionError:
        return None


def entry(one: Any, path: str, fence: str = "::::") -> str:
    """One name as a directive of Sphinx's Python domain, its members inside."""
    if one.is_attribute:
        kind, head = "attribute" if fence == ":::" else "data", path
        options = [f":type: {one.annotation}"] if one.annotation else []
        if one.value and len(str(one.value)) < 60 and "\n" not in str(one.value):
            options.append(f":value: {one.value}")
    else:
        kind = "class" if one.is_class else "method" if fence == ":::" else "function"
        head, options = path + signature(one), []
    members = [
        entry(member, name, ":::")
        for name, member in (one.members.items() if one.is_class else ())
        if not name.startswith("_")
        and not member.is_alias
        and (member.docstring or member.is_attribute)
    ]
    body = "\n\n".join(["\n".join(options), doc(one), *members])
    return f"{fence}{{py:{kind}}} {head}\n{body.strip()}\n{fence}"


def signature(one: Any) -> str:
    """Parameters and result as they stand in the source."""
    parameters = [p for p in one.parameters if p.name not in ("self", "cls")]
    parts, star = [], False
    for p in parameters:
        if p.kind is griffe.ParameterKind.keyword_only and not star:
            star = True
            parts.append("*")
        if p.kind is griffe.ParameterKind.var_positional:
            star = True
        parts.append(
            stars(p) + p.name + (f": {p.annotation}" if p.annotation else "") + default(p)
        )
    result = f" -> {one.returns}" if one.is_function and one.returns else ""
    return f"({', '.join(parts)}){result}"


def stars(p: griffe.Parameter) -> str:
    kinds = {griffe.ParameterKind.var_positional: "*", griffe.ParameterKind.var_keyword: "**"}
    return kinds.get(p.kind, "")


def default(p: griffe.Parameter) -> str:
    if p.default is None or stars(p):
        return ""
    return " = " + (str(p.default) if not isinstance(p.default, griffe.ExprLambda) else "...")


def doc(one: Any) -> str:
    return one.docstring.value if one.docstring else ""


def first(one: Any) -> str:
    """The first sentence of a docstring, fit for a table."""
    return doc(one).split("\n\n")[0].replace("\n", " ").replace("|", r"\|")
