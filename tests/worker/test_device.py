"""Which device a worker computes on."""

import pytest

from worker import device

TWO = """#!/bin/sh
echo "NVIDIA H200, 143771"
echo "NVIDIA A100-SXM4-40GB, 40960"
"""


@pytest.fixture
def nvidia_smi(tmp_path, monkeypatch):
    """A program of that name which says what it is told to."""

    def says(script):
        program = tmp_path / "nvidia-smi"
        program.write_text(script)
        program.chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")

    monkeypatch.delenv("JAX_PLATFORMS", raising=False)
    monkeypatch.delenv("CUDA_VISIBLE_DEVICES", raising=False)
    return says


def test_every_worker_has_a_gpu_of_its_own(nvidia_smi):
    nvidia_smi(TWO)
    first, second = device.find(0), device.find(1)
    assert (first.name, first.memory_bytes) == ("NVIDIA H200", 143771 << 20)
    assert first.environment == {"CUDA_VISIBLE_DEVICES": "0"}
    assert second.name == "NVIDIA A100-SXM4-40GB"
    assert second.environment == {"CUDA_VISIBLE_DEVICES": "1"}


def test_more_workers_than_gpus_share_them(nvidia_smi):
    nvidia_smi(TWO)
    assert device.find(2).environment == {"CUDA_VISIBLE_DEVICES": "0"}


def test_only_gpus_that_the_environment_allows_are_used(nvidia_smi, monkeypatch):
    nvidia_smi(TWO)
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "1")
    assert device.find(0).name == "NVIDIA A100-SXM4-40GB"
    assert device.find(5).environment == {"CUDA_VISIBLE_DEVICES": "1"}


@pytest.mark.parametrize("script", ["#!/bin/sh\nexit 9\n", "#!/bin/sh\necho 'No devices'\n"])
def test_without_a_gpu_that_answers_it_is_the_processor(nvidia_smi, script):
    nvidia_smi(script)
    found = device.find(0)
    assert found.memory_bytes > 1 << 20
    assert found.environment == {}
