"""One request for many runs: a grid over fields of a spec, each case with several seeds."""

from collections.abc import Iterator, Mapping
from typing import Any, Self

from . import watching
from .columns import frame
from .pages import items
from .polling import ENDED
from .record import Record
from .run import Run

MEASURES = ("qd_score", "coverage", "best")


class Sweep(Record):
    """As it was when the server was last asked; `refresh` asks again."""

    NOUN = "sweeps"

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        counts = counts_as_text(self.status_counts)
        return f"<Sweep {self.id[:8]}{name}: {self.total} runs, {counts}>"

    @property
    def cases(self) -> list[dict[str, Any]]:
        """Each with its `values`, by the paths of fields, and the ids of its `runs`."""
        return self.record["cases"]

    @property
    def total(self) -> int:
        return self.record["total"]

    @property
    def status_counts(self) -> dict[str, int]:
        """How many runs are in each state."""
        return self.record["status_counts"]

    @property
    def ended(self) -> bool:
        return all(status in ENDED for status, count in self.status_counts.items() if count)

    def runs(self) -> Iterator[Run]:
        found = items(self._connection, "runs", sweep=self.id, limit=200, sort="created")
        return (Run(self._connection, one) for one in found)

    def watch(self) -> dict[str, int]:
        """Show how its runs go until all have ended; Ctrl-C leaves them going."""
        watching.watch_sweep(self._connection, self.id)
        return self.refresh().status_counts

    def delete(self) -> Self:
        """Move its runs to the bin, except queued and running ones: see `status_counts`."""
        self._connection.send("DELETE", self._path)
        return self.refresh()

    def restore(self) -> Self:
        """Its runs back from the bin."""
        return self._ask("restore")

    def change(self, *, name: str | None) -> Self:
        """Say what it is called."""
        self.record = self._connection.send("PATCH", self._path, {"name": name})
        return self

    def summary(self) -> "Summary":
        """Of each case, median and spread of its runs by generation."""
        return Summary(self._connection.read(f"{self._path}/summary")["cases"])

    def rows(self) -> list[dict[str, Any]]:
        """What each run has come to, beside the values that set it apart."""
        values = {str(run): case["values"] for case in self.cases for run in case["runs"]}
        return [
            {
                **values.get(run.id, {}),
                "seed": run.spec.get("seed"),
                "status": run.status,
                "generation": run.generation,
                **{name: run.record[name] for name in (*MEASURES, "evaluations")},
                "run": run.id,
            }
            for run in self.runs()
        ]

    def to_pandas(self) -> Any:
        """A data frame of `rows`."""
        return frame(self.rows())

    def _ask(self, action: str, document: Any = None) -> Self:
        """The answer tells which runs were changed, not how the sweep stands."""
        self._connection.send("POST", f"{self._path}/{action}", document)
        return self.refresh()


class Summary:
    """Of each case, columns by generation, with median and spread over its runs."""

    def __init__(self, cases: list[dict[str, Any]]):
        self.cases = cases

    def __repr__(self) -> str:
        return f"<Summary of {len(self.cases)} cases>"

    def rows(self) -> list[dict[str, Any]]:
        """One for each case, generation and measure."""
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
        """A data frame of `rows`: `median`, `low` and `high` (a quarter), `min`, `max`."""
        return frame(self.rows())


def counts_as_text(standing: Mapping[str, int]) -> str:
    """How many runs are in which state, in words."""
    return ", ".join(f"{count} {status}" for status, count in standing.items() if count)
