"""The report of a study: every number names its runs, and the same runs give the same bytes."""

import csv
import errno
import fcntl
import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from importlib import import_module
from queue import SimpleQueue
from unittest.mock import Mock

import numpy as np
import pytest

from microcosmos.archive.file import load
from microcosmos.spec import estimate
from microcosmos.study import PlannedRun, carry_out, local, report, written
from microcosmos.study.results import gather
from microcosmos.study.runs import alone, of_run


class Cells(HTMLParser):
    """Collect the cells of tables with their links, and all ids and addresses of a page."""

    def __init__(self, text):
        super().__init__()
        self.cells, self.ids, self.sources, self._open = [], [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.ids += [found["id"]] if "id" in found else []
        self.sources += [found[x] for x in ("src", "href") if x in found]
        if tag == "td":
            self.cells.append(["", {}])
            self._open = True
        elif tag == "a" and self._open:
            self.cells[-1][1] = found

    def handle_endtag(self, tag):
        self._open = self._open and tag != "td"

    def handle_data(self, data):
        if self._open:
            self.cells[-1][0] += data


@pytest.fixture
def page(finished):
    return Cells(finished[1][0].read_text())


def is_number(text):
    try:
        float(text.replace(",", "").removeprefix("< "))
    except ValueError:
        return False
    return True


def test_every_number_names_the_runs_that_it_comes_from(finished, page):
    known = {run.id for run in finished[0].runs}
    numbers = [cell for cell in page.cells if is_number(cell[0])]
    assert len(numbers) > 30
    for text, link in numbers:
        runs = link.get("data-runs", "").split()
        assert runs, text
        assert set(runs) <= known, text
        assert link["href"][1:] in page.ids, text


def test_numbers_are_those_of_the_named_runs(finished, page):
    results = gather(finished[0])
    values = {x: one.record.curves["qd_score"][-1] for x, one in results.runs.items()}
    links = [cell for cell in page.cells if cell[1].get("data-runs") in values]
    shown = {link["data-runs"]: [] for _, link in links}
    for text, link in links:
        shown[link["data-runs"]].append(text)
    assert all(f"{values[name]:.4g}" in texts for name, texts in shown.items())
    assert set(shown) == set(values)


def test_text_of_the_study_is_escaped(finished):
    text = finished[1][0].read_text()
    assert "<h1>Thin &amp; thick water</h1>" in text
    assert "<p>One seed &lt;each&gt;.</p>" in text
    assert "Tests need at least 5 seeds in each group, got 1" in text


@pytest.mark.long
def test_a_study_that_is_finished_runs_nothing_and_has_the_same_bytes(finished, monkeypatch):
    found, paths = finished
    before = {path: path.read_bytes() for path in [*paths, *(run.path for run in found.runs)]}
    monkeypatch.setattr("microcosmos.study.local._here", None)  # Nothing may be carried out.
    assert carry_out(found)
    again = report.write(found, b"the file", "the command")
    assert again == paths
    assert all(path.read_bytes() == data for path, data in before.items())


def test_the_report_has_the_file_that_was_carried_out(
    finished, study_file, invoke, tmp_path, monkeypatch
):
    file, out = tmp_path / "it's.json", tmp_path / "out"
    source = study_file().read_bytes().replace(b", ", b",\r\n")
    file.write_bytes(source)
    shutil.copytree(finished[0].folder, out)

    def edited(*_):
        file.write_text("edited")

    command = import_module("microcosmos.cli.study")
    monkeypatch.setattr(command, "_carry_out", edited)
    monkeypatch.setattr(command, "load_modules", lambda files: None)
    invoke("study", file, "--out", out, "--module", tmp_path / "plug.py")
    text = unescape((out / "report.html").read_bytes().decode())
    assert f"<pre>{source.decode()}</pre>" in text
    assert f"<code>{hashlib.sha256(source).hexdigest()[:12]}</code>" in text
    assert """<code>microcosmos study 'it'"'"'s.json' --module=plug.py</code>""" in text


def test_errors_of_a_run_name_it(planned, monkeypatch):
    def evolve(*_, **__):
        raise OSError("the disk is full")

    found = planned()
    run = found.runs[0]
    monkeypatch.setattr("microcosmos.build.local.evolve", evolve)
    with pytest.raises(ValueError, match=f"^run {run.id}: the disk is full"):
        carry_out(found)
    run.path.write_bytes(b"damaged")
    with pytest.raises(ValueError, match=f"^run {run.id}: an archive file must be HDF5"):
        carry_out(found)


def test_files_of_two_runs_that_are_swapped_are_refused(finished, planned):
    """The report would give each viscosity the numbers of the other."""
    found = planned()
    first, second = found.unique()
    for run, other in zip(finished[0].unique(), (second, first), strict=True):
        other.path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(run.path, other.path)
    message = f"^run {first.id}: the file .* must be of this run, got one of another spec"
    for use in (first.done, lambda: carry_out(found), lambda: gather(found)):
        with pytest.raises(ValueError, match=message):
            use()


def test_a_run_that_needs_files_of_creatures_is_refused_before_any_begins(planned):
    sweep = planned().study.sweeps["viscosity"].model_dump()
    grid = {"search.initial": [[], ["0" * 64]]}
    found = planned(
        sweeps={"viscosity": sweep | {"grid": grid}},
        comparisons={"x": {"groups": ["viscosity"]}},
        figures=[],
    )
    first, second = found.unique()
    with pytest.raises(ValueError, match=f"^run {second.id}: `search.initial` must be empty"):
        carry_out(found)
    assert not first.path.exists()


def test_exports_are_those_of_the_runs(finished):
    found, paths = finished
    names = {path.relative_to(found.folder).as_posix() for path in paths}
    run = found.runs[0]
    assert {"exports/Viscosity.csv", "exports/Viscosity.tex", "exports/Tasks.json"} <= names
    assert "exports/Tasks.csv" not in names
    with (found.folder / f"exports/archives/{run.id}.csv").open() as file:
        rows = list(csv.DictReader(file))
    archive = load(run.path.read_bytes())[0]["archive"]
    assert [float(row["objective"]) for row in rows] == pytest.approx(
        archive["fitness"].tolist()
    )
    poses = np.load(found.folder / f"exports/poses/{run.id}.npz")
    assert poses["positions"].shape[1:] == (8, 2)


def files_in(folder):
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix() for path in paths}


def test_figures_and_exports_that_a_study_has_no_more_are_removed(finished, tmp_path):
    before, names = replace(finished[0], folder=tmp_path), {"report.html", written.RECORD}
    study = before.study.model_copy(
        update={"figures": before.study.figures[:1], "exports": ("csv", "archive-csv")}
    )
    report.write(replace(before, study=study), b"the file", "the command")
    archives = {f"exports/archives/{run.id}.csv" for run in before.runs}
    curves = {f"figures/1-curves{suffix}" for suffix in (".svg", ".pdf", ".caption.txt")}
    assert files_in(tmp_path) == names | archives | curves | {"exports/Viscosity.csv"}
    # Files of the user, one of which the study wrote first.
    own = {"figures/2-box.svg", "exports/mine.csv", "figures/1-curves.svg"}
    for name in own:
        (tmp_path / name).write_text("mine")
    study = study.model_copy(update={"figures": (), "exports": ("latex",)})
    report.write(replace(before, study=study), b"the file", "the command")
    assert files_in(tmp_path) == names | own | {"exports/Viscosity.tex"}
    assert all((tmp_path / name).read_text() == "mine" for name in own)


def test_files_of_a_call_that_was_killed_are_removed(tmp_path):
    def killed():
        yield "archives/1.csv", b"1"
        raise KeyboardInterrupt

    written.write(tmp_path, {"exports": [("archives/0.csv", b"0")]})
    with pytest.raises(KeyboardInterrupt):
        written.write(tmp_path, {"exports": killed()})
    assert written.write(tmp_path, {"exports": [("x.csv", b"2")]}) == [
        tmp_path / "exports/x.csv"
    ]
    assert files_in(tmp_path) == {"exports/x.csv", written.RECORD}


def test_the_time_left_is_that_of_the_measured_speed(planned):
    found = planned()
    work = sum(estimate(run.spec).cell_steps for run in found.unique())
    found.folder.mkdir()
    speed = found.folder / local.SPEED
    assert local.estimated_seconds(found, 1) is None
    speed.write_text(f'{{"cell_steps_per_second": {work / 60}}}')
    # Two runs are left: more processes than runs are no faster.
    seconds = [local.estimated_seconds(found, processes) for processes in (1, 2, 8)]
    assert seconds == pytest.approx([60, 30, 30])
    for damaged in (
        "",
        "[]",
        "{}",
        *(f'{{"cell_steps_per_second": {x}}}' for x in ("0", "-1")),
    ):
        speed.write_text(damaged)
        assert local.estimated_seconds(found, 1) is None


def test_runs_that_lack_their_end_alone_measure_no_speed(planned, monkeypatch):
    found = planned()
    monkeypatch.setattr(PlannedRun, "done", lambda run: (run.spec.generations, False))
    monkeypatch.setattr(local, "_here", lambda run, heard, ended, *_: ended(run) is None)
    assert carry_out(found)
    assert local.estimated_seconds(found, 1) == 0
    assert not (found.folder / local.SPEED).exists()


def test_a_folder_has_one_study_at_a_time(tmp_path):
    refused = pytest.raises(ValueError, match="another process carries out")
    with alone(tmp_path), refused, alone(tmp_path):
        pass


def test_a_folder_is_of_one_file_unless_it_is_named(finished, study_file, invoke, tmp_path):
    """Both would be `it.study`, and the second would remove the first one's exports."""
    shutil.copytree(finished[0].folder, tmp_path / "it.study")
    for name in ("it.json", "it.yaml"):
        shutil.copy(study_file(figures=[], exports=["csv"]), tmp_path / name)
    invoke("study", tmp_path / "it.json")
    before = (tmp_path / "it.study/report.html").read_bytes()
    said = invoke("study", tmp_path / "it.yaml", code=2)
    assert "must be of the study it.yaml, got that of it.json" in said
    assert (tmp_path / "it.study/report.html").read_bytes() == before
    invoke("study", tmp_path / "it.yaml", "--out", tmp_path / "it.study")


def test_a_file_system_without_locks_has_no_other_process(tmp_path, monkeypatch):
    def failing(number):
        def flock(*_):
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr(fcntl, "flock", flock)

    failing(errno.ENOLCK)
    with alone(tmp_path), of_run(tmp_path / "run.h5"):
        pass
    failing(errno.EIO)
    with pytest.raises(OSError, match="Input/output error"), alone(tmp_path):
        pass


def test_what_a_plug_in_prints_is_no_message_of_a_worker(tmp_path):
    (tmp_path / "loud.py").write_text("print('hello')\n")
    options = json.dumps(local.Options(1, 20.0, None)._asdict())
    command = [sys.executable, "-m", "microcosmos.study.worker", options, "loud.py"]
    done = subprocess.run(command, cwd=tmp_path, input="", capture_output=True, text=True)
    assert done.stdout == ""
    assert done.stderr.startswith("hello")


def test_a_worker_that_cannot_be_read_has_ended():
    messages = SimpleQueue()
    with pytest.raises(ValueError, match="Expecting value"):
        local._listen(0, io.StringIO("hello\n"), messages)
    assert messages.get_nowait() == (0, None)


def test_a_worker_that_lives_and_cannot_be_read_is_named(planned, monkeypatch):
    monkeypatch.setattr(local, "ENDING", 0.1)
    process = subprocess.Popen(["cat"], stdin=subprocess.PIPE, text=True)
    messages = SimpleQueue()
    messages.put((0, None))
    run = planned().runs[0]
    with pytest.raises(ValueError, match=f"run {run.id}: its process wrote what is no message"):
        local.distribute(
            [local.Worker(process, messages)], [run], Mock(), Mock(), lambda: False
        )
    process.kill()
    process.communicate()
