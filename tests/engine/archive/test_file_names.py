"""Files beside another keep its name, also one with dots."""

from pathlib import Path

import pytest

from microcosmos.archive.file_names import beside


@pytest.mark.fast
@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("run.h5", "run.best.json"),
        ("nu0.05.h5", "nu0.05.best.json"),
        ("nu0.05", "nu0.05.best.json"),
        ("tiny ö 0.05", "tiny ö 0.05.best.json"),
        ("Eel.JSON", "Eel.best.json"),
        (".h5", ".h5.best.json"),
        ("in.a.folder/run", "in.a.folder/run.best.json"),
    ],
)
def test_only_known_endings_are_replaced(name, expected):
    assert beside(Path(name), ".best.json") == Path(expected)
