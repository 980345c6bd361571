"""A drill for a cluster: helpers die, hang, join and leave; the bytes stay."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from hashlib import sha256
from pathlib import Path
from typing import Any

import rich
from databases import Missing, service_settings
from drive import QUICK, ROOT, SHORT, Installation, free_port, running, wait_until
from small_spec import SMALL_SCENE

HERE = Path(__file__).parent
GATE = HERE / "gate.py"


def spec(generations: int) -> dict[str, Any]:
    axes = [{"name": "gate.wait", "bins": 12}, {"name": "hidden_nodes", "bins": 4}]
    repeated = {"every": 4, "samples": 2}
    search = {"generations": generations, "batch": 24, "block": 4, "reevaluation": repeated}
    return SMALL_SCENE | {"archive": {"descriptors": axes}, "search": search}


class Cluster:
    """A scheduler, helpers and runs of this machine, each a process that can be ended."""

    def __init__(self, folder: Path, generations: int):
        self.folder, self.gate = folder, folder / "gate"
        self.gate.mkdir(parents=True)
        self.url = f"tcp://127.0.0.1:{free_port()}"
        self.spec = folder / "spec.json"
        self.spec.write_text(json.dumps(spec(generations)))
        self.processes: list[subprocess.Popen[bytes]] = []
        self.helpers: dict[str, subprocess.Popen[bytes]] = {}

    def start(self, name: str, *command: str, **settings: str) -> subprocess.Popen[bytes]:
        """Start `python COMMAND`; its output is in NAME.txt."""
        environment = os.environ | QUICK | {"GATE": str(self.gate), "GATE_NAME": name}
        with (self.folder / f"{name}.txt").open("ab") as output:
            started = subprocess.Popen(
                [sys.executable, *command],
                cwd=ROOT,
                env=environment | settings,
                stdin=subprocess.PIPE,
                stdout=output,
                stderr=output,
            )
        self.processes.append(started)
        return started

    def schedule(self) -> subprocess.Popen[bytes]:
        command = ("-m", "microcosmos", "cluster", "scheduler", self.url)
        started = self.start("scheduler", *command)
        wait_until(lambda: "may join" in self.output("scheduler"), 120, "it listens")
        return started

    def join(self, name: str, **settings: str) -> subprocess.Popen[bytes]:
        command = ("-m", "microcosmos.cluster.helper", self.url, name, "--module", str(GATE))
        started = self.start(name, *command, GATE_SECONDS="0.02", **settings)
        wait_until(lambda: "has joined" in self.output(name), 240, f"{name} joins")
        self.helpers[name] = started
        return started

    def run(self, name: str, *url: str) -> subprocess.Popen[bytes]:
        file = str(self.archive(name))
        return self.start(name, str(HERE / "cluster_run.py"), str(self.spec), file, *url)

    def archive(self, name: str) -> Path:
        return self.folder / f"{name}.h5"

    def output(self, name: str) -> str:
        file = self.folder / f"{name}.txt"
        return file.read_text() if file.exists() else ""

    def reports(self, name: str) -> list[dict[str, Any]]:
        lines = (line.partition(" ") for line in self.output(name).splitlines())
        return [json.loads(rest) for number, _, rest in lines if number.isdigit()]

    def wait_for(self, name: str, generation: int) -> None:
        wait_until(
            lambda: len(self.reports(name)) >= generation, 240, f"generation {generation}"
        )

    def finish(self, name: str, run: subprocess.Popen[bytes]) -> str:
        """Wait for a run; return the digest of its archive."""
        if status := run.wait(300):
            raise AssertionError(f"{name} ended with {status}: {self.output(name)[-2000:]}")
        return sha256(self.archive(name).read_bytes()).hexdigest()

    def hold(self, name: str = "all") -> None:
        """Keep a helper, or all, in the middle of the blocks that they compute."""
        (self.gate / f"hold-{name}").touch()

    def release(self, name: str = "all") -> None:
        (self.gate / f"hold-{name}").unlink()

    def wait_held(self, name: str) -> None:
        wait_until((self.gate / f"held-{name}").exists, 240, f"{name} is in a block")

    def used(self, name: str) -> bool:
        return (self.gate / f"used-{name}").exists()

    def leave(self, name: str) -> None:
        process = self.helpers.pop(name)
        process.terminate()
        process.wait(60)

    def end(self) -> None:
        for one in self.processes:
            one.kill()
            one.wait()
            if one.stdin:
                one.stdin.close()


def undisturbed(cluster: Cluster) -> str:
    """Return the digest of the archive that this machine computes alone."""
    return cluster.finish("alone", cluster.run("alone"))


def disturbed(cluster: Cluster) -> str:
    """Compute with helpers that die, hang, join and leave; return the archive's digest."""
    scheduler, first = cluster.schedule(), cluster.join("first")
    run = cluster.run("disturbed", cluster.url)
    cluster.wait_for("disturbed", 1)
    cluster.hold("first")
    cluster.wait_held("first")
    # These join while a generation waits; the late block goes to the second too.
    cluster.join("other-flags", XLA_FLAGS="--xla_cpu_enable_fast_math=true")
    second = cluster.join("second")
    cluster.wait_for("disturbed", len(cluster.reports("disturbed")) + 1)
    cluster.hold("second")
    first.kill()
    cluster.wait_held("second")
    third = cluster.join("third")
    cluster.wait_for("disturbed", len(cluster.reports("disturbed")) + 1)
    second.send_signal(signal.SIGSTOP)
    cluster.release("second")
    cluster.hold()
    cluster.wait_held("third")
    scheduler.kill()
    scheduler.wait()
    (cluster.folder / "scheduler.txt").unlink()
    cluster.release()
    cluster.schedule()
    second.send_signal(signal.SIGCONT)
    found = cluster.finish("disturbed", run)
    assert cluster.used("third")
    assert third.poll() is None
    assert not cluster.used("other-flags"), "another kind of device has computed"
    assert "gets no blocks" in cluster.output("disturbed")
    return found


def with_helpers(made: Cluster, expected: str) -> list[str]:
    """Compute with one helper, two and three; return what is wrong."""
    wrong = []
    for count in (1, 2, 3):
        made.join(f"helper {count}")
        name = f"with {count}"
        found = made.finish(name, made.run(name, made.url))
        devices = max(report["cluster.devices"] for report in made.reports(name))
        if (found, devices) != (expected, count):
            wrong.append(f"{devices} helpers instead of {count} computed {found}")
    return wrong


def through_the_queue(made: Cluster, services: dict[str, str]) -> list[str]:
    """Compute two runs at the same time, by workers that share the helpers."""
    gate = {"GATE": str(made.gate), "GATE_NAME": "worker", "MICROCOSMOS_MODULES": str(GATE)}
    settings = SHORT | services | gate | {"WORKERS": "2", "MICROCOSMOS_CLUSTER": made.url}
    specs = [json.loads(made.spec.read_bytes()) | {"seed": seed} for seed in (1, 2)]
    with running(made.folder / "data", settings) as product:
        wait_until(lambda: any(one["plugins"] for one in product.get("workers")), 120, "gate")
        runs = [product.submit(one) for one in specs]
        found = []
        for run in runs:
            product.wait(run, "finished", seconds=600)
            found.append(sha256(product.archive(run)).hexdigest())
        summary = product.get(f"runs/{runs[0]}/generations")["summary"]
    wrong = [] if max(summary["cluster.devices"]) > 2 else ["the workers had no helpers"]
    for number, (one, digest) in enumerate(zip(specs, found, strict=True)):
        made.spec.write_text(json.dumps(one))
        if made.finish(name := f"alone {number}", made.run(name)) != digest:
            wrong.append(f"run {number} of the queue ends with other bytes than alone")
    return wrong


def cluster(_: Installation) -> bool:
    """Tell whether a run over many hosts survives what happens to them."""
    wrong = []
    with tempfile.TemporaryDirectory() as place, ExitStack() as stack:
        made = Cluster(Path(place) / "cluster", generations=200)
        stack.callback(made.end)
        expected = undisturbed(made)
        if disturbed(made) != expected:
            wrong.append("a disturbed run ends with other bytes")
        for name in ("second", "third"):
            made.leave(name)
        wrong += with_helpers(made, expected)
        try:
            services = stack.enter_context(service_settings())
        except Missing as missing:
            rich.print(f"on SQLite: {missing}")
            services = {}
        wrong += through_the_queue(made, services)
    print(*wrong or ["cluster: every archive has the bytes of one process"], sep="\n")
    return not wrong
