"""Check that a run can resume from a file: the same spec, the same kind of device."""

import json
from collections.abc import Iterator, Mapping
from typing import Any


class OtherDevice(ValueError):
    """The file was computed on another kind of device, where bits may differ."""


def devices_of(
    spec: str, device: str, attributes: Mapping[str, str], other_device: bool
) -> tuple[str, ...]:
    """Return the kinds of device of a file and, last, the present one.

    Raises `ValueError` for another spec, and `OtherDevice` for another kind of device unless
    `other_device` allows it.
    """
    _refuse_other(json.loads(attributes["spec"]), json.loads(spec))
    devices = json.loads(attributes["device"])
    if devices[-1] != device and not other_device:
        raise OtherDevice(
            f"`device` must be {devices[-1]!r}, on which the run was computed, for the same "
            f"bits; got {device!r}."
        )
    return tuple(devices if devices[-1] == device else [*devices, device])


def _refuse_other(held: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Refuse another spec; a search may have more generations, which follow from the file."""
    if _without_length(held) != _without_length(wanted):
        if _unversioned(_without_length(held)) == _unversioned(_without_length(wanted)):
            raise ValueError(_versions(held, wanted))
        raise ValueError("`spec` in the file must be the run's own, got another")
    before, now = _length(held), _length(wanted)
    if now < before:
        raise ValueError(
            f"`search.generations` must be at least the file's {before}, got {now}"
        )


def _versions(held: dict[str, Any], wanted: dict[str, Any]) -> str:
    now = dict(_sources(wanted))
    path, then = next((path, of) for path, of in _sources(held) if now.get(path) != of)
    return (
        f"`{path}` must be {then[:12]}, the version with which the run was computed, got "
        f"{now.get(path, 'none')[:12]}: continue with that version, or begin a new run"
    )


def _sources(spec: Any, path: str = "") -> Iterator[tuple[str, str]]:
    parts = spec.items() if isinstance(spec, dict) else enumerate(spec)
    for name, part in parts:
        if name == "source":
            yield f"{path}{name}", part
        elif isinstance(part, dict | list):
            yield from _sources(part, f"{path}{name}.")


def _unversioned(spec: Any) -> Any:
    if isinstance(spec, dict):
        return {name: _unversioned(part) for name, part in spec.items() if name != "source"}
    return [_unversioned(part) for part in spec] if isinstance(spec, list) else spec


def _length(spec: dict[str, Any]) -> int:
    return spec.get("search", {}).get("generations", 0)


def _without_length(spec: dict[str, Any]) -> dict[str, Any]:
    if "search" not in spec:
        return spec
    return {**spec, "search": {**spec["search"], "generations": 0}}
