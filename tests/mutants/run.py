"""Mutation tests: break the code one defect at a time and check that tests fail.

`make mutants` tries all, `make mutants NAMES="auth gradient-wrap"` those with these prefixes.
Each mutant is a file beside this one: the source file, a text that occurs there exactly once,
its replacement, and the tests that have to fail: those of a folder that `make test` runs, or
all of some files. These tests must pass without the defect. Mutants change a copy of the
repository only.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]


class Mutant(NamedTuple):
    """A seeded defect."""

    name: str
    about: str
    file: str
    text: str
    replacement: str
    tests: list[str]

    @property
    def of_page(self) -> bool:
        return self.file.startswith("web/")

    def mutate(self, source: str) -> str:
        """Insert the defect; raise `ValueError` unless the source has the text exactly once."""
        if (found := source.count(self.text)) != 1:
            raise ValueError(
                f"mutants/{self.name}.toml: {self.file} must hold {self.text!r} exactly once, "
                f"found {found} times"
            )
        return source.replace(self.text, self.replacement)


def mutants() -> list[Mutant]:
    files = sorted(Path(__file__).parent.glob("*.toml"))
    return [Mutant(name=file.stem, **tomllib.loads(file.read_text())) for file in files]


def copy_repository(to: Path) -> None:
    """Copy the files that git tracks or would add; link installed packages and builds."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, names.split("\0")):
        if (ROOT / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, to / name)
    for name in (".venv", ".cache", "web/node_modules", "web/dist"):
        if (ROOT / name).exists():
            (to / name).symlink_to(ROOT / name)


def failure(page: bool, tests: Iterable[str], copy: Path) -> str | None:
    """Run tests of the page or of Python in the copy; return the first that fails, if any."""
    if page:
        command, folder = ["npx", "vitest", "run", "--bail", "1", *tests], copy / "web"
    else:
        pytest = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
        quick = [] if all(path.endswith(".py") for path in tests) else ["-m", "not long"]
        command, folder = [*pytest, *quick, *tests], copy
    # The copy's own packages go before those that are installed.
    path = os.pathsep.join([str(copy / ".venv" / "bin"), os.environ["PATH"]])
    here = {
        "PYTHONPATH": f"{copy / 'server'}:{copy / 'worker'}:{copy / 'engine'}",
        "PATH": path,
        "NO_COLOR": "1",
    }
    env = os.environ | here
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True)
    # Pytest ends with 1 if a test failed; 2 and more mean that it could not run them.
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    lines = (done.stdout + done.stderr).splitlines()
    failed = (line for line in lines if line.lstrip().startswith(("FAIL", "ERROR")))
    return next(failed, "an error").strip()[:150] if done.returncode == 1 else None


def caught_by(mutant: Mutant, copy: Path) -> str | None:
    """Return the test that fails with the defect; restore the copy afterwards."""
    file = copy / mutant.file
    source = file.read_text()
    file.write_text(mutant.mutate(source))
    try:
        return failure(mutant.of_page, mutant.tests, copy)
    finally:
        file.write_text(source)


def apart(chosen: Iterable[Mutant]) -> list[list[str]]:
    """Return the tests of mutants in groups: files and folders apart, since only of files the
    long tests run, and those of the engine, since after JAX no process may fork."""
    found: dict[tuple[str, bool], list[str]] = {}
    for path in sorted({path for one in chosen for path in one.tests}):
        place = "engine" if path.startswith("tests/engine") else path.partition("/")[0]
        found.setdefault((place, path.endswith(".py")), []).append(path)
    return list(found.values())


def main(prefixes: list[str]) -> int:
    chosen = [one for one in mutants() if one.name.startswith(tuple(prefixes or [""]))]
    missed = 0
    with tempfile.TemporaryDirectory() as folder:
        copy_repository(Path(folder))
        for tests in apart(chosen):
            if failed := failure(tests[0].startswith("src/"), tests, Path(folder)):
                sys.exit(f"Tests fail without a defect, so they prove nothing: {failed}")
        for mutant in chosen:
            start = time.monotonic()
            failed = caught_by(mutant, Path(folder))
            missed += failed is None
            seconds = time.monotonic() - start
            word = "caught" if failed else "MISSED"
            print(f"{word}  {seconds:4.0f} s  {mutant.name}: {mutant.about}")
            print(f"                {failed or 'all tests pass'}", flush=True)
    print(f"{len(chosen) - missed} of {len(chosen)} caught")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
