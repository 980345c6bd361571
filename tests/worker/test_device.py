"""The device of a worker, and how much of it is in use."""

import os
import subprocess
import sys
from types import SimpleNamespace

import pynvml
import pytest

from microcosmos_worker import device, heartbeats, nvidia
from microcosmos_worker.device import Device, memory
from microcosmos_worker.heartbeats import Usage

TWO = {
    "GPU-aaaa1111": ("NVIDIA H200", 143771 << 20),
    "GPU-bbbb2222": ("NVIDIA A100-SXM4-40GB", 40 << 30),
}
DIVIDED = {
    "MIG-cccc3333": ("NVIDIA H200 MIG 3g.71gb", 71 << 30),
    "MIG-dddd4444": ("NVIDIA H200 MIG 1g.18gb", 18 << 30),
}


@pytest.fixture
def nvml(monkeypatch):
    """A function that replaces NVIDIA's library by one that knows some cards.

    `cards` has name and memory by UUID, None for a card that fails; None is no driver.
    `divided` is the UUID of a card with the MIG instances `DIVIDED`. `hot` is temperature and
    memory errors.
    """
    for name in ("JAX_PLATFORMS", "CUDA_VISIBLE_DEVICES", device.MEMORY_FRACTION):
        monkeypatch.delenv(name, raising=False)

    def install(cards, divided=None, used=0, load=None, hot=(None, None)):
        every = DIVIDED | (cards or {})

        def known(value):
            if value is None:
                raise pynvml.NVMLError(pynvml.NVML_ERROR_NOT_SUPPORTED)
            return value

        answers = {
            "Init": lambda: known(cards),
            "Shutdown": lambda: None,
            "DeviceGetCount": lambda: len(cards),
            "DeviceGetHandleByIndex": lambda i: list(cards)[i],
            "DeviceGetHandleByUUID": lambda uuid: uuid,
            "DeviceGetUUID": lambda uuid: uuid,
            "DeviceGetName": lambda uuid: known(every[uuid])[0],
            "DeviceGetMemoryInfo": lambda uuid: SimpleNamespace(
                total=known(every[uuid])[1], used=known(used)
            ),
            "DeviceGetUtilizationRates": lambda _: SimpleNamespace(gpu=known(load)),
            "DeviceGetTemperature": lambda *_: known(hot[0]),
            "DeviceGetTotalEccErrors": lambda *_: known(hot[1]),
            "DeviceGetMigMode": lambda uuid: (known(1 if uuid == divided else None), 1),
            "DeviceGetMaxMigDeviceCount": lambda _: 7,
            "DeviceGetMigDeviceHandleByIndex": lambda _, i: known(
                dict(enumerate(DIVIDED)).get(i)
            ),
        }
        for name, answer in answers.items():
            monkeypatch.setattr(pynvml, f"nvml{name}", answer)

    return install


@pytest.fixture
def errors(monkeypatch):
    """The errors that the driver is about to report, by card; the first card is divided."""
    coming = {card: [] for card in TWO}

    def next_error(watched, _):
        if not coming[watched[0]]:
            raise pynvml.NVMLError(pynvml.NVML_ERROR_TIMEOUT)
        return coming[watched[0]].pop()

    answers = {
        "DeviceIsMigDeviceHandle": lambda uuid: uuid in DIVIDED,
        "DeviceGetDeviceHandleFromMigDeviceHandle": lambda _: next(iter(TWO)),
        "EventSetCreate": list,
        "DeviceRegisterEvents": lambda uuid, _, watched: watched.append(uuid),
        "EventSetWait_v2": next_error,
    }
    for name, answer in answers.items():
        monkeypatch.setattr(pynvml, f"nvml{name}", answer)
    return coming


def test_every_worker_has_a_gpu_of_its_own(nvml):
    nvml(TWO)
    first, second = device.find(0, 2), device.find(1, 2)
    assert (first.name, first.memory_bytes) == ("NVIDIA H200", 143771 << 20)
    assert first.environment == {"CUDA_VISIBLE_DEVICES": "GPU-aaaa1111"}
    assert second.name == "NVIDIA A100-SXM4-40GB"
    assert second.environment == {"CUDA_VISIBLE_DEVICES": "GPU-bbbb2222"}
    assert first.threads == second.threads == ()


def test_more_workers_than_gpus_share_them_and_their_memory(nvml, monkeypatch):
    nvml(TWO)
    first, second, third = (device.find(i, 3) for i in range(3))
    assert first == third
    assert first.name == "NVIDIA H200 (shared by 2 workers)"
    assert first.memory_bytes == (143771 << 20) // 2
    assert first.environment == {
        "CUDA_VISIBLE_DEVICES": "GPU-aaaa1111",
        device.MEMORY_FRACTION: "0.375",
    }
    assert device.MEMORY_FRACTION not in second.environment
    monkeypatch.setenv(device.MEMORY_FRACTION, "0.2")
    assert device.find(0, 4).environment[device.MEMORY_FRACTION] == "0.2"


@pytest.mark.parametrize(
    ("allowed", "found"),
    [
        ("1", ["GPU-bbbb2222", "GPU-bbbb2222"]),
        ("1,0", ["GPU-bbbb2222", "GPU-aaaa1111"]),
        ("GPU-bbbb", ["GPU-bbbb2222", "GPU-bbbb2222"]),
        ("1,-1,0", ["GPU-bbbb2222", "GPU-bbbb2222"]),
        ("", [None, None]),
        ("-1", [None, None]),
    ],
)
def test_only_gpus_that_the_environment_allows_are_used(nvml, monkeypatch, allowed, found):
    nvml(TWO)
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", allowed)
    assert [device.find(i, 2).gpu for i in range(2)] == found


def test_mig_instances_are_devices(nvml, monkeypatch):
    nvml(TWO, divided="GPU-aaaa1111")
    first, second, third = (device.find(i, 3) for i in range(3))
    assert (first.gpu, first.name) == ("MIG-cccc3333", "NVIDIA H200 MIG 3g.71gb")
    assert first.memory_bytes == 71 << 30
    assert (second.gpu, second.memory_bytes) == ("MIG-dddd4444", 18 << 30)
    assert third.gpu == "GPU-bbbb2222"
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "MIG-dddd4444,0")
    assert [device.find(i, 2).gpu for i in range(2)] == ["MIG-dddd4444", "MIG-cccc3333"]


@pytest.mark.parametrize("cards", [None, {}, {"GPU-aaaa1111": None}])
def test_the_processor_is_used_without_a_gpu(nvml, cards):
    nvml(cards)
    found = device.find(0)
    assert found.memory_bytes > 1 << 20
    assert found.environment == {}
    assert set(found.threads) == set(device.threads())
    assert found.name.endswith(f"({len(found.threads)} threads)")


def test_threads_are_given_out_evenly_and_shared_if_there_are_too_few():
    for threads, workers in ((8, 1), (8, 2), (8, 3), (7, 7)):
        given = [10 + i for i in range(threads)]
        shares = [device.share_threads(given, i, workers) for i in range(workers)]
        assert [thread for share in shares for thread in share] == given
        assert max(map(len, shares)) - min(map(len, shares)) <= 1
    assert [device.share_threads([4, 5], i, 5) for i in range(5)] == [[4], [5], [4], [5], [4]]


def test_threads_of_a_core_are_neighbours(tmp_path, monkeypatch):
    """Two sockets of two cores of two threads, numbered as Linux often does."""
    for thread in range(8):
        topology = tmp_path / f"cpu{thread}" / "topology"
        topology.mkdir(parents=True)
        (topology / "physical_package_id").write_text(f"{thread % 2}\n")
        (topology / "core_id").write_text(f"{thread // 2 % 2}\n")
    monkeypatch.setattr(device, "TOPOLOGY", tmp_path)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    assert device.threads() == [0, 4, 2, 6, 1, 5, 3, 7]


def test_a_machine_without_processor_information_works(tmp_path, monkeypatch):
    monkeypatch.setattr(device, "CPUINFO", tmp_path / "none")
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.delattr(os, "sched_setaffinity", raising=False)
    assert device.cpu_model()
    assert device.threads() == list(range(os.cpu_count()))
    device.pin([0])


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="the system has no affinity")
def test_child_processes_keep_to_the_workers_threads():
    one = device.threads()[-1]
    program = (
        "import subprocess, sys; from microcosmos_worker import device\n"
        "device.pin([int(sys.argv[1])])\n"
        "ask = 'import os; print(*os.sched_getaffinity(0))'\n"
        "subprocess.run([sys.executable, '-c', ask], check=True)"
    )
    asked = [sys.executable, "-c", program, str(one)]
    answer = subprocess.run(asked, check=True, capture_output=True, text=True)
    assert answer.stdout.split() == [str(one)]


def test_a_processor_reports_load_and_memory():
    found = heartbeats.usage(Device("cpu", memory(), {}))
    assert found.load is not None
    assert found.load == pytest.approx(os.getloadavg()[0] / os.cpu_count(), abs=0.5)
    assert found.memory_bytes is not None
    assert 0 < found.memory_bytes < memory()


@pytest.mark.parametrize(
    ("current", "expected"), [("1000", 990), ("5", 0), ("no number", None)]
)
def test_in_a_container_its_own_memory_is_reported(tmp_path, monkeypatch, current, expected):
    (tmp_path / "memory.max").write_text("2000")
    (tmp_path / "memory.current").write_text(current)
    (tmp_path / "memory.stat").write_text("inactive_file 10\n")
    monkeypatch.setattr(heartbeats, "CGROUP", tmp_path)
    found = heartbeats.usage(Device("cpu", 1, {}))
    assert (found.memory_bytes, found.load is None) == (expected, False)


GPU = {"GPU-3": ("a GPU", 80 << 30)}


def state(temperature, ecc_errors):
    """What a worker says about that GPU."""
    return {"uuid": "GPU-3", "temperature_celsius": temperature, "ecc_errors": ecc_errors}


@pytest.mark.parametrize(
    ("cards", "used", "load", "hot", "expected"),
    [
        (GPU, 1234, 56, (71, 2), Usage(1234, 0.56, state(71.0, 2))),
        (GPU, 1234, None, (71, None), Usage(1234, None, state(71.0, None))),
        (GPU, None, None, (None, None), Usage(None, None, state(None, None))),
        (None, 0, None, (71, 2), Usage(None, None, state(None, None))),
    ],
)
def test_a_gpu_reports_its_own_state_and_none_for_the_rest(
    nvml, cards, used, load, hot, expected
):
    nvml(cards, used=used, load=load, hot=hot)
    assert heartbeats.usage(Device("gpu", 80 << 30, {}, "GPU-3")) == expected


def test_errors_of_a_card_are_counted_also_by_a_worker_on_a_part_of_it(nvml, errors):
    nvml(TWO)
    part, other = nvidia.XidErrors("MIG-cccc3333"), nvidia.XidErrors("GPU-bbbb2222")
    errors["GPU-aaaa1111"] += [31, 79]
    assert (part.read(), part.read(), other.read()) == (2, 2, 0)
    errors["GPU-aaaa1111"].append(48)
    assert part.read() == 3
    nvml(None)
    assert nvidia.XidErrors("GPU-bbbb2222").read() == 0, "without a driver"


@pytest.mark.parametrize("error", [OSError("gone"), ValueError("no number")])
def test_a_gauge_reads_until_its_end_and_drops_what_is_old_after_a_failure(error):
    results = iter([Usage(load=1.0), error, Usage(load=2.0), Usage(load=3.0)])
    seen = []

    def look():
        seen.append(gauge.last)
        found = next(results)
        if found == Usage(load=3.0):
            gauge.end()
        if isinstance(found, Exception):
            raise found
        return found

    gauge = heartbeats.Gauge(look, 0.001)
    gauge.start()
    gauge.join(20)
    assert not gauge.is_alive()
    assert seen == [Usage(), Usage(load=1.0), Usage(), Usage(load=2.0)]
    assert gauge.last == Usage(load=3.0)
