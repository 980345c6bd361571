"""The files that a study writes, and the removal of those that it no longer has."""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from ..archive.atomic import write_whole

RECORD = "written.sha256"
"""File with the SHA-256 and the path of every figure and export, as `sha256sum` writes it."""


def write(folder: Path, made: Mapping[str, Iterable[tuple[str, bytes]]]) -> list[Path]:
    """Write files, given by folder and name; return their paths.

    Files that an earlier call wrote and this one does not are removed, unless they have changed
    since. Other files stay.
    """
    record, lines = folder / RECORD, dict[Path, str]()
    earlier = _lines(record)
    with record.open("a", encoding="utf-8") as file:
        for part, files in made.items():
            for name, data in files:
                path = folder / part / name
                path.parent.mkdir(parents=True, exist_ok=True)
                lines[path] = _line(folder, path, data)
                # Recorded first: a process that is killed leaves no file without a record.
                print(lines[path], file=file, flush=True)
                write_whole(path, data)
    there = {path for part in made for path in (folder / part).rglob("*") if path.is_file()}
    for path in there - lines.keys():
        # The bytes, not the name, tell that a file is the study's own.
        if _line(folder, path, path.read_bytes()) in earlier:
            path.unlink()
    write_whole(record, "".join(f"{line}\n" for line in lines.values()).encode())
    return list(lines)


def _lines(record: Path) -> set[str]:
    if not record.exists():
        return set()
    return set(record.read_text(encoding="utf-8", errors="replace").splitlines())


def _line(folder: Path, path: Path, data: bytes) -> str:
    digest = hashlib.sha256(data).hexdigest()
    return f"{digest}  {path.relative_to(folder).as_posix()}"
