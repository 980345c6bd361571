"""A study of two runs as small as can be, carried out once per process."""

import json

import pytest
from small_spec import SMALL_RUN

from microcosmos.study import carry_out, plan, read, report

STUDY = {
    "title": "Thin & thick water",
    "about": "Two viscosities.\n\nOne seed <each>.",
    "sweeps": {
        "viscosity": {
            "spec": SMALL_RUN,
            "set": {"search.generations": 3},
            "grid": {"world.viscosity": [0.05, 0.2]},
            "seeds": [3],
        }
    },
    "comparisons": {
        "Viscosity": {"groups": ["viscosity"], "measures": ["qd_score", "best", "best>=1.2"]},
        "Tasks": {
            "groups": ["viscosity"],
            "measures": ["coverage"],
            "tasks": ["world.viscosity"],
        },
    },
    "figures": [
        {"kind": "curves", "of": "Viscosity"},
        {"kind": "box", "of": "Viscosity"},
        {"kind": "parameter", "of": "Viscosity", "field": "world.viscosity"},
        {"kind": "profile", "of": "Tasks"},
        {"kind": "creatures", "of": "Viscosity"},
    ],
    "exports": ["csv", "json", "latex", "archive-csv", "poses-npz"],
    "resamples": 99,
}


@pytest.fixture(scope="session")
def study_file(tmp_path_factory):
    """A function that writes the study with some parts replaced, and returns the path."""

    def write(**parts):
        path = tmp_path_factory.mktemp("study") / "thin.json"
        path.write_text(json.dumps(STUDY | parts))
        return path

    return write


@pytest.fixture(scope="session")
def planned(study_file):
    def make(**parts):
        path = study_file(**parts)
        return plan(read(path), path.with_suffix(".study"), path.parent)

    return make


@pytest.fixture(scope="session")
def finished(planned):
    """The plan of the study, carried out, and the paths of its report, figures and exports."""
    found = planned()
    told = []
    assert carry_out(found, tell=lambda progress: told.append(progress.done / progress.work))
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1)
    return found, report.write(found, b"the file", "the command")
