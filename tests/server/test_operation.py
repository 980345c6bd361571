"""What docs/operation.md says of settings, metrics and limits is what the code has."""

import re
from pathlib import Path

import httpx
import pytest

from microcosmos.spec import EXPERIMENTS, estimate
from server.settings import Settings
from worker.device import TAKEN
from worker.supervisor import PATIENCE

TEXT = (Path(__file__).parents[2] / "docs" / "operation.md").read_text()
ELSEWHERE = {"database_url", "redis_url", "artifacts_url", "token", "max_bytes", "data"}
ELSEWHERE |= {"public_url", "modules"}
"""Whose defaults are said in words."""


def rows(heading):
    """The cells of the tables under a heading."""
    part = TEXT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in part.splitlines() if line.startswith("| `")]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]


def names(field, info):
    return set(getattr(info.validation_alias, "choices", ())) or {
        f"MICROCOSMOS_{field.upper()}"
    }


def test_every_setting_is_there_with_its_default_and_no_other():
    told = {name: row[1] for row in rows("Settings") for name in re.findall(r"`(\w+)`", row[0])}
    fields = Settings.model_fields
    known = {name: field for field, info in fields.items() for name in names(field, info)}
    assert told.keys() == known.keys()
    for name, field in known.items():
        if field not in ELSEWHERE:
            default = fields[field].default
            default = str(default).lower() if isinstance(default, bool) else default
            shown = f"{default:g}" if isinstance(default, float) else str(default)
            assert told[name].strip("`") == shown, name


def test_every_metric_is_there_and_no_other(address):
    found = httpx.get(f"{address}/metrics", verify=False).text
    there = set(re.findall(r"^# TYPE (\w+)", found, re.MULTILINE))
    told = {
        n for row in rows("Health and figures") for n in re.findall(r"microcosmos_\w+", row[0])
    }
    assert told == there


@pytest.mark.parametrize("row", rows("Size"), ids=lambda row: row[0])
def test_sizes_are_those_of_the_estimates(row):
    experiment, name = re.match(r"`(.*)/(.*)`", row[0]).groups()
    presets = {preset.name: preset.spec for preset in EXPERIMENTS[experiment].presets}
    found = estimate(presets[name])
    assert row[1] == f"{found.evaluations:,}"
    assert row[2] == f"{found.memory_bytes / 2**20:.0f} MiB"
    assert float(row[3]) == pytest.approx(found.cell_steps, rel=0.05)


def test_times_and_shares_are_those_of_the_code():
    assert f"{PATIENCE:g} s" in TEXT
    assert f"{TAKEN:g} divided by their number" in TEXT
    assert f"have {TAKEN / 2:g} of its memory" in TEXT
