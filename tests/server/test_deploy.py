"""The files in deploy/ fit the code: modules, settings and times exist, and they parse."""

import importlib.util
import re
import subprocess
from pathlib import Path

import pytest
from setting_names import setting_names

from microcosmos_server.settings import Settings
from microcosmos_worker.supervisor import STOP_SECONDS

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
UNITS = sorted((DEPLOY / "systemd").glob("*.service"))
SLURM = DEPLOY / "slurm" / "worker.sbatch"
OTHERS = {"JAX_PLATFORMS", "JAX_COMPILATION_CACHE_DIR", "AWS_ENDPOINT_URL"}
OTHERS |= {"AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}
ENVIRONMENT = "MICROCOSMOS_ENV"
"""A variable of the SLURM script alone: the file with the settings."""


@pytest.mark.parametrize("unit", UNITS, ids=lambda path: path.name)
def test_units_start_modules_that_exist_and_leave_them_time(unit):
    text = unit.read_text()
    (module,) = re.findall(r"^ExecStart=\S+ -m ([\w.]+)", text, re.MULTILINE)
    assert importlib.util.find_spec(module)
    (seconds,) = re.findall(r"^TimeoutStopSec=(\d+)", text, re.MULTILINE)
    assert int(seconds) > STOP_SECONDS
    if module != "microcosmos_server.main":
        assert "KillMode=mixed" in text or module == "microcosmos_worker.renderer"


def test_all_variables_are_settings():
    known = setting_names() | OTHERS | {ENVIRONMENT}
    for file in (*UNITS, SLURM, DEPLOY / "microcosmos.env"):
        text = file.read_text()
        used = set(re.findall(r"\b(?:MICROCOSMOS|JAX|AWS)_[A-Z_]+\b", text))
        assert used
        assert used <= known, file.name


def test_bash_accepts_the_slurm_script_and_the_signal_reaches_the_worker():
    subprocess.run(["bash", "-n", str(SLURM)], check=True)
    text = SLURM.read_text()
    (seconds,) = re.findall(r"^#SBATCH --signal=B:TERM@(\d+)$", text, re.MULTILINE)
    assert int(seconds) > STOP_SECONDS
    options = [number for number, line in enumerate(text.splitlines()) if "#SBATCH" in line]
    first = next(n for n, line in enumerate(text.splitlines()) if line[:1] not in ("#", ""))
    assert max(options) < first, "SLURM reads no option after the first command"
    assert re.fullmatch(
        r"exec \.venv/bin/python -m microcosmos_worker\.supervisor 0", text.splitlines()[-1]
    )


def test_the_example_of_settings_is_valid(monkeypatch):
    lines = (DEPLOY / "microcosmos.env").read_text().replace("\n#", "\n").splitlines()
    for line in lines:
        if match := re.fullmatch(r"(\w+)=(.+)", line):
            monkeypatch.setenv(*match.groups())
    found = Settings()
    assert (found.log_format, found.workers, found.auth) == ("json", 1, "required")
