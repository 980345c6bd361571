"""The OpenAPI document and docs/operation.md are true."""

import os
import re
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from reports import archive_file, replay
from schemathesis import GenerationMode
from schemathesis.checks import not_a_server_error
from schemathesis.core.failures import FailureGroup
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)
from setting_names import names_of

from microcosmos.archive import creature
from microcosmos.spec import EXPERIMENTS, estimate
from microcosmos_server.app import create_app
from microcosmos_server.attempts.claim import claim
from microcosmos_server.auth import tokens
from microcosmos_server.creatures import storage as creatures
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.settings import Settings
from microcosmos_server.tables import REPLAY
from microcosmos_worker.device import DEFAULT_FRACTION
from microcosmos_worker.supervisor import STOP_SECONDS

EXAMPLES = int(os.environ.get("EXAMPLES", "4"))
"""Requests to each operation, right ones and wrong ones; `EXAMPLES=500` looks longer."""
CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]
STREAMS = "/api/v1/events"
HERE = settings(
    max_examples=EXAMPLES,
    deadline=None,
    database=None,
    derandomize=True,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture
def known(
    services, spec, run_id, sweep_id, report, identity, table, attempt, record
) -> dict[str, list[str]]:
    """Existing values of path parameters."""
    for generation in (1, 2):
        record(generation, {generation: 1.0})
    attempt.save(2, archive_file(spec))
    claim(services, sweep_id, "worker").record(table(1, {"number": 1, "speed": 0.5}), 1.0)
    kept = creature.document(identity(3), None, None)
    with services.sessions.write.begin() as session:
        creatures.import_files(session, kept)
    planes = {"velocity": {"scale": 1.0}, "energy": {"scale": 1.0, "frames": 0}}
    positions = np.array([[[0.0, 0.0], [1.0, 0.0]]])
    still = replay(positions, 3, joints=[], **planes)
    renderings.save(services, kept["sha256"], REPLAY, still)
    token = tokens.create(services, "somebody", "read").token
    return {
        "run_id": [str(run_id), str(sweep_id)],
        "sha": [kept["sha256"], report(1, {1: 1.0}).elites[0].creature],
        "token_id": [str(token.id)],
    }


def test_generated_clients_know_a_type_of_every_answer(services):
    """Generators know JSON, text and plain bytes, and need a schema."""
    document = create_app(services).openapi()
    answers = {
        (path, method): answer["responses"]["200"].get("content", {})
        for path, operations in document["paths"].items()
        for method, answer in operations.items()
        if "200" in answer["responses"]
    }
    unknown = [
        place
        for place, content in answers.items()
        if content
        and not any(
            "schema" in how or "itemSchema" in how
            for kind, how in content.items()
            if kind in ("application/json", "application/octet-stream")
            or kind.startswith("text/")
        )
    ]
    assert len(answers) > 50
    assert unknown == []


@pytest.mark.parametrize("database", ["sqlite"])
def test_no_request_breaks_the_server_or_its_document(address, services, known):
    schema = schemathesis.openapi.from_dict(create_app(services).openapi())
    wrong: list[str] = []
    reached: set[str] = set()
    for found in schema.exclude(path=STREAMS).get_all_operations():
        wrong += broken(found.ok(), address, known, reached)
    assert wrong == []
    assert len(reached) > 30  # Most were answered with what they are there for.


def broken(
    operation: Any, address: str, known: dict[str, list[str]], reached: set[str]
) -> list[str]:
    wrong: list[str] = []
    modes = [operation.as_strategy(generation_mode=mode) for mode in GenerationMode]

    @seed(1)
    @HERE
    @given(case=st.one_of(modes), draw=st.data())
    def ask(case: Any, draw: Any) -> None:
        for name in (case.path_parameters or {}).keys() & known.keys():
            if draw.draw(st.integers(0, 3)):
                case.path_parameters[name] = draw.draw(st.sampled_from(known[name]))
        answer = case.call(base_url=address, timeout=20)
        if answer.status_code < 300:
            reached.add(operation.label)
        try:
            case.validate_response(answer, checks=CHECKS)
        except FailureGroup as group:
            wrong.extend(
                f"{case.method} {case.formatted_path}: {one}" for one in group.exceptions
            )

    ask()
    return wrong[:3]


TEXT = (Path(__file__).parents[2] / "docs" / "operation.md").read_text()
ELSEWHERE = {"database_url", "redis_url", "artifacts_url", "token", "max_bytes", "data"}
ELSEWHERE |= {"public_url", "modules", "labels", "cluster", "cluster_certificate"}
ELSEWHERE |= {"webhook_url", "webhook_secret", "sinks"}
"""Settings whose defaults are described in words."""


def rows(heading):
    """The cells of the tables under a heading."""
    part = TEXT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in part.splitlines() if line.startswith("| `")]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]


def test_every_setting_is_there_with_its_default_and_no_other():
    documented = {
        name: row[1] for row in rows("Settings") for name in re.findall(r"`(\w+)`", row[0])
    }
    fields = Settings.model_fields
    known = {name: field for field in fields for name in names_of(field)}
    assert documented.keys() == known.keys()
    for name, field in known.items():
        if field not in ELSEWHERE:
            default = fields[field].default
            default = str(default).lower() if isinstance(default, bool) else default
            shown = f"{default:g}" if isinstance(default, float) else str(default)
            assert documented[name].strip("`") == shown, name


def test_every_metric_is_there_and_no_other(address):
    found = httpx.get(f"{address}/metrics", verify=False).text
    there = set(re.findall(r"^# TYPE (\w+)", found, re.MULTILINE))
    documented = {
        n for row in rows("Health and figures") for n in re.findall(r"microcosmos_\w+", row[0])
    }
    assert documented == there


@pytest.mark.parametrize("row", rows("Size"), ids=lambda row: row[0])
def test_documented_sizes_match_the_estimates(row):
    experiment, name = re.match(r"`(.*)/(.*)`", row[0]).groups()
    presets = {preset.name: preset.spec for preset in EXPERIMENTS[experiment].presets}
    found = estimate(presets[name])
    assert row[1] == f"{found.evaluations:,}"
    assert row[2] == f"{found.memory_bytes / 2**20:.0f} MiB"
    assert float(row[3]) == pytest.approx(found.cell_steps, rel=0.05)


def test_documented_times_and_shares_match_the_code():
    assert f"{STOP_SECONDS:g} s" in TEXT
    assert f"{DEFAULT_FRACTION:g} divided by their number" in TEXT
    assert f"have {DEFAULT_FRACTION / 2:g} of its memory" in TEXT
