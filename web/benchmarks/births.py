"""Write a run with many births, and measure its tree of life while it is dragged.

Each birth is a creature of its own, with one or two parents among those that held a cell
before. Their bodies are those of a small search: the browser gets one stream under each name.
"""

import json
import statistics
from datetime import timedelta
from hashlib import sha256
from urllib.parse import parse_qs, urlsplit
from uuid import UUID

import numpy as np
from drive import Installation
from playwright.sync_api import Page, Route
from sqlalchemy import insert

from microcosmos.archive.poses import batch, decode
from microcosmos_server.services.services import Services
from microcosmos_server.tables import FINISHED, Creature, Elite, Parent, Run

PER_GENERATION = 50
CELLS = 4096
PANNED_SECONDS = 6
DRAWN_MS = 3000
"""Time until picture and bodies are there."""

DRAG = """
(seconds) => new Promise((resolve) => {
  const port = document.querySelector(".tree-port");
  const { left, top, width, height } = port.getBoundingClientRect();
  const send = (type, x, y) => port.dispatchEvent(new PointerEvent(type, {
    clientX: left + x, clientY: top + y, bubbles: true, pointerId: 1, pointerType: "mouse",
  }));
  port.setPointerCapture = () => {};
  const ended = new MessageChannel();
  const [times, busy] = [[], []];
  let begun = 0;
  ended.port1.onmessage = () => busy.push(performance.now() - begun);
  send("pointerdown", width / 2, height / 2);
  requestAnimationFrame(function step(now) {
    begun = now;
    const turn = times.length / 60;
    const [x, y] = [0.5 + 0.4 * Math.sin(turn), 0.5 + 0.45 * Math.sin(0.7 * turn)];
    send("pointermove", x * width, y * height);
    ended.port2.postMessage(0);
    times.push(now);
    if (now - times[0] < 1000 * seconds) return void requestAnimationFrame(step);
    send("pointerup", width / 2, height / 2);
    resolve([busy, 1000 * (times.length - 1) / (now - times[0])]);
  });
})
"""
"""Milliseconds from the start of each frame to its end, and frames per second, of a drag."""


def write_births(services: Services, of: str, count: int) -> str:
    """Write a run whose archive `count` creatures ever entered; return its id."""
    draw = np.random.default_rng(count)
    generations = count // PER_GENERATION
    names = [sha256(b"%d" % i).hexdigest() for i in range(count)]
    holders: dict[int, int] = {}
    older: list[int] = []
    creatures, parents, elites = [], [], []
    fitness = np.cumsum(np.abs(draw.normal(0, 1e-4, count))) + draw.normal(0, 0.3, count)
    for i in range(count):
        generation = 1 + i // PER_GENERATION
        if i % PER_GENERATION == 0:
            older = list(holders.values())
        places = draw.integers(0, len(older), 1 + i % 3 // 2) if older else ()
        named = list(dict.fromkeys(names[older[place]] for place in places))
        creatures.append(row_of(names[i], named, generation))
        parents += [(names[i], k, one) for k, one in enumerate(named)]
        cell = (generation * PER_GENERATION + i % PER_GENERATION * 61) % CELLS
        holders[cell] = i
        elites.append((cell, generation, float(fitness[i]), names[i]))
    with services.sessions.write.begin() as session:
        run = copied(session.get_one(Run, UUID(of)), generations)
        session.add(run)
        session.flush()
        session.execute(insert(Creature), creatures)
        keys = ("child", "position", "parent")
        session.execute(insert(Parent), [dict(zip(keys, one, strict=True)) for one in parents])
        keys = ("cell", "generation", "fitness", "creature")
        shared = {"run_id": run.id, "descriptors": [0.5, 0.5]}
        rows = [shared | dict(zip(keys, one, strict=True)) for one in elites]
        session.execute(insert(Elite), rows)
        return str(run.id)


def row_of(name: str, parents: list[str], generation: int) -> dict:
    return {
        "sha256": name,
        "identity": b"{}",
        "parents": parents,
        "operator": ("random", "neat", "crossover")[len(parents)],
        "measured": None,
        "provenance": {"generation": generation, "seed": 0, "version": ""},
        "licence": "",
        "credit": [],
    }


def copied(run: Run, generations: int) -> Run:
    """A finished run with as many generations."""
    search = {**run.spec["search"], "generations": generations}
    return Run(
        experiment=run.experiment,
        spec={**run.spec, "search": search},
        version=run.version,
        status=FINISHED,
        started_at=run.started_at,
        finished_at=run.started_at and run.started_at + timedelta(hours=1),
        generations=generations,
        generation=generations,
        coverage=1.0,
    )


def body_of(product: Installation, run: str) -> bytes:
    """The pose stream of an elite of a run."""
    cells = product.get(f"runs/{run}/archive")["cell"][:1]
    asked = {"cells": cells}
    answer = product.http.get(f"/api/v1/runs/{run}/archive/poses", params=asked)
    return answer.raise_for_status().content[4:]


def serve_bodies(page: Page, stream: bytes) -> None:
    """Answer requests for pose streams with one stream under the name of each creature."""
    length = int.from_bytes(stream[:4], "little")
    header = json.loads(stream[4 : 4 + length])
    assert decode(stream).creature == header["creature"]

    def answer(route: Route) -> None:
        (names,) = parse_qs(urlsplit(route.request.url).query)["creatures"]
        own = header["creature"].encode()
        found = [stream.replace(own, name.encode()) for name in names.split(",")]
        route.fulfill(body=batch(found), content_type="application/octet-stream")

    page.route("**/tank/poses?*", answer)


def drag(page: Page) -> str:
    """Work of the main thread for a frame while the tree is dragged, at three levels of zoom.

    It is processor time, so that other processes do not count; times of frames do.
    """
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def worked() -> float:
        """Seconds of all tasks so far."""
        metrics = session.send("Performance.getMetrics")["metrics"]
        return next(one["value"] for one in metrics if one["name"] == "TaskDuration")

    found = []
    tree = page.locator(".tree-port")
    for steps in (0, 6, 10):
        for _ in range(steps):  # A key is nothing where a small tree is at its largest.
            tree.press("+")
        page.wait_for_timeout(DRAWN_MS)
        before = worked()
        busy, rate = page.evaluate(DRAG, PANNED_SECONDS)
        work = 1000 * (worked() - before) / len(busy)
        tail = statistics.quantiles(busy, n=20)[-1]
        found.append(
            f"{work:.1f} ms of work; from start to end {statistics.median(busy):.1f} ms, one "
            f"in twenty over {tail:.1f} ms; {rate:.0f} frames/s"
        )
        tree.press("0")
    return "\n".join(found)
