"""A sweep on a server: a grid over fields of a spec, each case with several seeds."""

from collections.abc import Iterator
from typing import Any, Self

from .columns import frame
from .errors import SWEEP
from .formatting import MEASURES, corrected_titles, counts_as_text
from .polling import ENDED, follow_sweep
from .record import Field, Record
from .run import Run
from .views import watch


class Sweep(Record):
    """A copy of the server's record; `refresh` reads it again."""

    NOUN, KINDS = "sweeps", SWEEP
    total = Field[int]()
    status_counts = Field[dict[str, int]]()
    """Number of runs by status."""

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        counts = counts_as_text(self.status_counts)
        return f"<Sweep {self.id[:8]}{name}: {self.total} runs, {counts}>"

    @property
    def cases(self) -> list[dict[str, Any]]:
        """Return its cases: `values` by the paths of fields, and the ids of its `runs`."""
        if "cases" not in self.record:  # Lists omit them.
            self.refresh()
        return self.record["cases"]

    @property
    def ended(self) -> bool:
        return all(status in ENDED for status, count in self.status_counts.items() if count)

    def runs(self) -> Iterator[Run]:
        records = self._connection.items("runs", sweep=self.id, limit=200, sort="created")
        return (Run(self._connection, one) for one in records)

    def watch(self) -> dict[str, int]:
        """Show its runs until all have ended; Ctrl-C ends only the watching."""
        watch(follow_sweep(self._connection, self.id), f"Sweep {self.id}")
        return self.refresh().status_counts

    def delete(self) -> Self:
        """Move its runs to the bin, except queued and running ones: see `status_counts`."""
        self._connection.send("DELETE", self._path)
        return self.refresh()

    def change(self, *, name: str | None) -> Self:
        """Change its name."""
        self.record = self._checked(self._connection.send("PATCH", self._path, {"name": name}))
        return self

    def uncancel(self) -> Self:
        """Take the cancellation of all its cancelled runs back."""
        runs = [run.id for run in self.runs() if run.status == "cancelled"]
        return self._ask("uncancel", {"runs": runs})

    def summary(self) -> "Summary":
        """Return median and spread of the runs of each case, by generation."""
        return Summary(self._connection.read(f"{self._path}/summary")["cases"])

    def rows(self) -> list[dict[str, Any]]:
        """Return the result of each run, beside the values of its case."""
        values = {str(run): case["values"] for case in self.cases for run in case["runs"]}
        runs = list(self.runs())
        measures = MEASURES | corrected_titles([run.record for run in runs])
        return [
            {
                **values.get(run.id, {}),
                "seed": run.spec.get("seed"),
                "status": run.status,
                "generation": run.generation,
                **{name: run.record[name] for name in (*measures, "evaluations")},
                "run": run.id,
            }
            for run in runs
        ]

    def to_pandas(self) -> Any:
        """Return a data frame of `rows`."""
        return frame(self.rows())

    def _ask(self, action: str, document: Any = None) -> Self:
        """Read the record again: the answer lists only the changed runs."""
        self._connection.send("POST", f"{self._path}/{action}", document)
        return self.refresh()


class Summary:
    """Columns by generation for each case, with median and spread of its runs."""

    def __init__(self, cases: list[dict[str, Any]]):
        self.cases = cases

    def __repr__(self) -> str:
        return f"<Summary of {len(self.cases)} cases>"

    def rows(self) -> list[dict[str, Any]]:
        """Return a row for each case, measure and generation."""
        return [
            {
                **case["values"],
                "generation": generation,
                "measure": measure,
                "runs": case["runs"][i],
                **{name: column[i] for name, column in case[measure].items()},
            }
            for case in self.cases
            for measure in MEASURES
            for i, generation in enumerate(case["generation"])
        ]

    def to_pandas(self) -> Any:
        """Return a data frame of `rows`: `median`, quartiles `low` and `high`, `min`, `max`."""
        return frame(self.rows())
