"""The command `doctor`."""

import typer

from ..doctor import Finding, examine
from .app import CACHE, app
from .remote import Json, Token, Url, show, stdout

COLOURS = {"ok": "green", "warning": "yellow", "problem": "red"}


@app.command()
def doctor(json: Json = False, url: Url = None, token: Token = None) -> None:
    """Check devices, memory, disk, Redis, database and server, and say what to do."""
    found: list[Finding] = []
    for finding in examine(url, token, CACHE):
        found.append(finding)
        if not json:
            _tell(finding)
    if json:
        show([finding.document() for finding in found])
    else:
        _sum_up(found)
    if any(finding.level == "problem" for finding in found):
        raise typer.Exit(1)


def _tell(finding: "Finding") -> None:
    console = stdout()
    mark = f"[{COLOURS[finding.level]}]{finding.level:>7}[/]"
    console.print(f"{mark}  [bold]{finding.subject}[/]: ", end="")
    console.print(finding.found, markup=False, highlight=False, soft_wrap=True)
    if finding.advice:
        advice = f"         → {finding.advice}"
        console.print(advice, markup=False, highlight=False, soft_wrap=True)


def _sum_up(found: "list[Finding]") -> None:
    problems = sum(one.level == "problem" for one in found)
    warnings = sum(one.level == "warning" for one in found)
    if not problems and not warnings:
        print("All is well.")
    else:
        words = (_counted(problems, "problem"), _counted(warnings, "warning"))
        print(" and ".join(filter(None, words)) + ".")


def _counted(number: int, word: str) -> str:
    return f"{number} {word}{'s' if number > 1 else ''}" if number else ""
