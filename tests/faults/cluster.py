"""A drill for a cluster: helpers die, hang, join and leave, the scheduler too; the bytes stay."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

import rich
from drive import QUICK, ROOT, free_port, wait_until
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
        command = ("-m", "microcosmos.cli", "cluster", "scheduler", self.url)
        started = self.start("scheduler", *command)
        wait_until(lambda: "may join" in self.output("scheduler"), 120, "it listens")
        return started

    def join(self, name: str, **settings: str) -> subprocess.Popen[bytes]:
        command = ("-m", "microcosmos.cluster.helper", self.url, name, "--module", str(GATE))
        started = self.start(name, *command, **settings)
        wait_until(lambda: "has joined" in self.output(name), 240, f"{name} joins")
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

    @contextmanager
    def held(self, name: str = "all") -> Iterator[None]:
        """Keep a helper, or all, in the middle of the blocks that they compute."""
        file = self.gate / f"hold-{name}"
        file.touch()
        try:
            yield
        finally:
            file.unlink()

    def wait_held(self, name: str) -> None:
        wait_until((self.gate / f"held-{name}").exists, 240, f"{name} is in a block")

    def used(self, name: str) -> bool:
        return (self.gate / f"used-{name}").exists()

    def end(self) -> None:
        for one in self.processes:
            if one.poll() is None:
                one.send_signal(signal.SIGCONT)
                one.kill()
            one.wait()


def undisturbed(cluster: Cluster) -> str:
    """Return the digest of the archive that this machine computes alone."""
    return cluster.finish("alone", cluster.run("alone"))


def disturbed(cluster: Cluster) -> str:
    """Compute with helpers that die, hang, join and leave; return the archive's digest."""
    scheduler, first = cluster.schedule(), cluster.join("first")
    run = cluster.run("disturbed", cluster.url)
    cluster.wait_for("disturbed", 1)
    with cluster.held("first"):
        cluster.wait_held("first")
        # These join while a generation waits; the late block goes to the second too.
        cluster.join("other-flags", XLA_FLAGS="--xla_cpu_enable_fast_math=true")
        second = cluster.join("second")
        cluster.wait_for("disturbed", len(cluster.reports("disturbed")) + 1)
        first.kill()
    third = cluster.join("third")
    with cluster.held("second"):
        cluster.wait_held("second")
        second.send_signal(signal.SIGSTOP)
    cluster.wait_for("disturbed", len(cluster.reports("disturbed")) + 1)
    with cluster.held():
        cluster.wait_held("third")
        scheduler.kill()
        scheduler.wait()
        cluster.folder.joinpath("scheduler.txt").unlink()
    cluster.schedule()
    second.send_signal(signal.SIGCONT)
    found = cluster.finish("disturbed", run)
    assert cluster.used("third") and third.poll() is None
    assert not cluster.used("other-flags"), "another kind of device has computed"
    assert "gets no blocks" in cluster.output("disturbed")
    assert first.poll() == -signal.SIGKILL
    return found


def main() -> None:
    """The drill at full size, for `make acceptance PARTS=cluster`."""
    with tempfile.TemporaryDirectory() as place:
        cluster = Cluster(Path(place) / "cluster", generations=40)
        try:
            expected = undisturbed(cluster)
            assert disturbed(cluster) == expected
            rich.print("kill -9, SIGSTOP, joining, a scheduler killed, other flags: same bytes")
            joined = [name for name in ("second", "third")]
            for name in ("fourth", "fifth"):
                cluster.join(name)
                joined.append(name)
            found = cluster.finish("again", cluster.run("again", cluster.url))
            assert found == expected
            devices = [report["cluster: devices"] for report in cluster.reports("again")]
            rich.print(f"{max(devices)} helpers ({', '.join(joined)}): same bytes")
        finally:
            cluster.end()
