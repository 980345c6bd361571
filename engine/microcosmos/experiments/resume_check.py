"""Check that a run can resume from a file: the same spec, the same kind of device."""

import json
from collections.abc import Iterator, Mapping
from typing import Any


class OtherSpec(ValueError):
    """The file was computed for another spec than the run's."""


class OtherDevice(ValueError):
    """The file was computed on another kind of device, where bits may differ."""

    def __init__(self, message: str, recorded: str):
        super().__init__(message)
        self.recorded = recorded
        """The kind of device that computed the file."""


def devices_of(
    spec: str, device: str, attributes: Mapping[str, str], other_device: bool
) -> tuple[str, ...]:
    """Return the kinds of device of a file and, last, the present one.

    Raises `OtherSpec` for another spec, and `OtherDevice` for another kind of device unless
    `other_device` allows it.
    """
    _refuse_other(*(dict(_values(json.loads(text))) for text in (attributes["spec"], spec)))
    devices = json.loads(attributes["device"])
    if devices[-1] != device and not other_device:
        raise OtherDevice(
            f"`device` must be {devices[-1]!r}, on which the run was computed, for the same "
            f"bits; got {device!r}.",
            devices[-1],
        )
    return tuple(devices if devices[-1] == device else [*devices, device])


def _refuse_other(held: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Refuse another spec; a search may have more generations, which follow from the file."""
    # A run with more generations begins like the shorter one
    # (tests/engine/experiments/test_contract.py, "an extended run").
    before, now = (values.pop("search.generations", 0) for values in (held, wanted))
    paths = {**held, **wanted}
    other = [path for path in paths if held.get(path, ...) != wanted.get(path, ...)]
    # Another version of a plug-in has its own message: loading the old version may help.
    if any(path.split(".")[-1] != "source" for path in other):
        raise OtherSpec("`spec` in the file must be the run's own, got another")
    if other:
        then, present = (values.get(other[0], "none") for values in (held, wanted))
        raise OtherSpec(
            f"`{other[0]}` must be {then[:12]}, the version with which the run was computed, "
            f"got {present[:12]}: continue with that version, or begin a new run"
        )
    if now < before:
        raise OtherSpec(f"`search.generations` must be at least the file's {before}, got {now}")


def _values(part: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value of a spec with its dotted path."""
    items = dict(enumerate(part)) if isinstance(part, list) else part
    if not isinstance(items, dict) or not items:
        yield path, part
        return
    for name, value in items.items():
        yield from _values(value, f"{path}.{name}" if path else str(name))
