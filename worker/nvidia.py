"""The NVIDIA GPUs that a process may use, as `nvidia-smi` and CUDA name them."""

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass

MIB, GIB = 1 << 20, 1 << 30
QUERY = ("--query-gpu=uuid,name,memory.total", "--format=csv,noheader,nounits")
SECONDS = 20
CARD = re.compile(r"GPU \d+: .*\(UUID: (?P<uuid>GPU-[^)]+)\)")
SLICE = re.compile(r"\s+MIG (?P<profile>\S+)\s+Device\s+\d+: \(UUID: (?P<uuid>MIG-[^)]+)\)")


@dataclass(frozen=True)
class Gpu:
    """A card, or a part of one that MIG has cut off, which is a device like any other."""

    uuid: str
    name: str
    memory_bytes: int
    card: str
    """The UUID of the card that it is, or is a part of."""


def visible() -> list[Gpu]:
    """Those that answer and that CUDA_VISIBLE_DEVICES allows, in its order."""
    if os.environ.get("JAX_PLATFORMS") == "cpu" or not shutil.which("nvidia-smi"):
        return []
    cards = list(_cards())
    found = list(_parts(cards))
    allowed = os.environ.get("CUDA_VISIBLE_DEVICES")
    return found if allowed is None else _allowed(allowed, cards, found)


def _allowed(names: str, cards: list[Gpu], found: list[Gpu]) -> list[Gpu]:
    """Numbers of cards or the beginnings of UUIDs; as in CUDA, all before the first unknown."""
    chosen: list[Gpu] = []
    for name in (part.strip() for part in names.split(",")):
        if name.isdigit() and int(name) < len(cards):
            card = cards[int(name)].uuid
            those = [gpu for gpu in found if gpu.card == card][:1]  # CUDA sees one part of it.
        else:
            those = [g for g in (*cards, *found) if name and g.uuid.startswith(name)][:1]
        if not those:
            break
        chosen += those
    return chosen


def _cards() -> Iterator[Gpu]:
    for line in _said(*QUERY):
        fields = [part.strip() for part in line.split(",")]
        if len(fields) == 3 and fields[2].isdigit():
            uuid, name, size = fields
            yield Gpu(uuid, name, int(size) * MIB, uuid)


def _parts(cards: list[Gpu]) -> Iterator[Gpu]:
    """The cards; in place of one that MIG has divided, its parts."""
    divided: dict[str, list[Gpu]] = {}
    named, card = {card.uuid: card for card in cards}, None
    for line in _said("-L") if cards else []:
        if match := CARD.match(line):
            card = named.get(match["uuid"])
        elif card and (match := SLICE.match(line)):
            share = re.search(r"(\d+)gb", match["profile"])  # As in 3g.20gb.
            size = int(share[1]) * GIB if share else card.memory_bytes
            name = f"{card.name} MIG {match['profile']}"
            divided.setdefault(card.uuid, []).append(Gpu(match["uuid"], name, size, card.uuid))
    for card in cards:
        yield from divided.get(card.uuid, [card])


def _said(*arguments: str) -> list[str]:
    """The lines that `nvidia-smi` answers; none where it fails or hangs."""
    try:
        answer = subprocess.run(
            ["nvidia-smi", *arguments],
            check=False,
            capture_output=True,
            text=True,
            timeout=SECONDS,
        )
    except (OSError, subprocess.TimeoutExpired):
        return []
    return [] if answer.returncode else answer.stdout.splitlines()
