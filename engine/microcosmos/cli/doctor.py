"""The command `doctor`."""

from dataclasses import asdict

import typer

from ..client.formatting import visible_lines
from ..doctor import Finding, examine
from .app import CACHE, app
from .remote import Json, Token, Url, show, stdout

COLOURS = {"ok": "green", "warning": "yellow", "problem": "red"}


@app.command()
def doctor(json: Json = False, url: Url = None, token: Token = None) -> None:
    """Check the library, devices and memory, then ask the server, and say what to do."""
    findings: list[Finding] = []
    for finding in examine(url, token, CACHE):
        findings.append(finding)
        # At once: a driver that hangs delays the next finding by minutes.
        if not json:
            _print(finding)
    counts = {level: sum(one.level == level for one in findings) for level in COLOURS}
    if json:
        show([asdict(finding) for finding in findings])
    else:
        words = (_counted(counts[level], level) for level in ("problem", "warning"))
        print(" and ".join(filter(None, words)) or "No problems", end=".\n")
    if counts["problem"]:
        raise typer.Exit(1)


def _print(finding: Finding) -> None:
    console = stdout()
    console.print(
        f"[{COLOURS[finding.level]}]{finding.level:>7}[/]  [bold]{finding.subject}[/]: ", end=""
    )
    advice = f"\n         → {finding.advice}" if finding.advice else ""
    text = visible_lines(f"{finding.found}{advice}")
    console.print(text, markup=False, emoji=False, highlight=False, soft_wrap=True)


def _counted(number: int, word: str) -> str:
    return f"{number} {word}{'s' if number > 1 else ''}" if number else ""
