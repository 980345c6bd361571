"""The report of a study: every number names its runs, and the same runs give the same bytes."""

import csv
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from made_archives import without_elites

from microcosmos.archive.file import load
from microcosmos.statistics import Group
from microcosmos.study import carry_out, exports, figures, report
from microcosmos.study.document import Figure
from microcosmos.study.lock import alone
from microcosmos.study.results import Finished, gather


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


def test_the_page_needs_no_network(page):
    assert all(x.startswith(("#", "data:image/svg+xml;base64,")) for x in page.sources)
    assert sum(x.startswith("data:") for x in page.sources) == 5
    assert len(page.ids) == len(set(page.ids))


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
    again = report.write(found, "the file", "the command")
    assert again == paths
    assert all(path.read_bytes() == data for path, data in before.items())


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


def test_captions_name_seeds_and_runs(finished):
    found, _ = finished
    text = (found.folder / "figures/5-creatures.caption.txt").read_text()
    assert sum(run.id in text for run in found.runs) == 2
    assert "Each has n = 1, seed 3." in (
        found.folder / "figures/2-box.caption.txt"
    ).read_text()  # fmt: skip


@pytest.fixture
def without(finished):
    """A function that gives the results as if runs of some numbers had found no elites."""

    def make(*numbers):
        found = finished[0]
        results = gather(found)
        for number in numbers:
            one = results.runs[found.runs[number].id]
            empty = Finished(one.run, without_elites(one.data))
            results.runs[one.run.id] = empty
            for compared in results.comparisons.values():
                (group,) = [x for x in compared.groups if one.record in x.runs]
                runs = [empty.record if run is one.record else run for run in group.runs]
                compared.groups[compared.groups.index(group)] = Group(group.name, tuple(runs))
        return results

    return make


def test_runs_without_elites_have_no_poses_and_an_empty_table(without, tmp_path):
    results = without(0)
    written = exports.save(results, tmp_path)
    first, second = results.runs
    names = {path.relative_to(tmp_path).as_posix() for path in written}
    assert f"poses/{first}.npz" not in names
    assert f"poses/{second}.npz" in names
    assert len((tmp_path / f"archives/{first}.csv").read_text().splitlines()) == 1


def test_the_fittest_creatures_are_those_of_groups_with_elites(without):
    results = without(0)
    figure = Figure(kind="creatures", of="Viscosity")
    study = results.plan.study.model_copy(update={"figures": (figure,)})
    drawn = replace(results, plan=replace(results.plan, study=study))
    (picture,) = figures.draw(drawn)
    _, second = results.runs
    assert picture.runs == (second,)
    assert "viscosity 0.05 has no elites" in picture.caption
    drawn = replace(without(0, 1), plan=drawn.plan)
    with pytest.raises(
        ValueError, match=r"figures.0 \(creatures\): a run with an elite is need"
    ):
        figures.draw(drawn)


def test_a_folder_has_one_study_at_a_time(tmp_path):
    refused = pytest.raises(ValueError, match="another process carries out")
    with alone(tmp_path), refused, alone(tmp_path):
        pass
