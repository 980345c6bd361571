"""The tables are those of the models, on every database."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest
from alembic import command
from sqlalchemy import inspect, text

from server.attempts.begin import claim
from server.core.database import connect
from server.tables import migrations

pytestmark = pytest.mark.postgresql


def test_migrated_tables_are_those_of_the_models(services):
    migrations.check(services.sessions)


def test_several_processes_may_migrate_a_new_database_at_once(tmp_path):
    url = f"sqlite:///{tmp_path / 'new.sqlite'}"
    several = [connect(url) for _ in range(4)]
    with ThreadPoolExecutor() as pool:
        list(pool.map(migrations.upgrade, several))
    assert "runs" in inspect(several[0].engine).get_table_names()
    for sessions in several:
        sessions.engine.dispose()


def test_runs_of_before_know_how_many_generations_they_have(tmp_path, spec):
    sessions = connect(f"sqlite:///{tmp_path / 'old.sqlite'}")
    with sessions.engine.begin() as connection:
        command.upgrade(migrations.config(connection), "0001")
        names = (
            "id, experiment, spec, version, demonstration, status, created_at, attempt, "
            "attempts_without_checkpoint, generation, checkpoint_generation, evaluations, "
            "diverged, seconds"
        )
        values = "'00', 'quality-diversity', :spec, '', 0, 'paused', '', 0, 0, 0, 0, 0, 0, 0"
        insert = text(f"INSERT INTO runs ({names}) VALUES ({values})")
        connection.execute(insert, {"spec": json.dumps(spec)})
        columns = "run_id, generation, evaluations, diverged, seconds"
        row = f"INSERT INTO generations ({columns}) VALUES ('00', 1, 1, 0, 1)"
        connection.execute(text(row))
    migrations.upgrade(sessions)
    with sessions.engine.begin() as connection:
        found = connection.execute(text("SELECT generations FROM runs")).scalar_one()
        curve = connection.execute(text("SELECT generation FROM generations")).scalars().all()
    assert curve == [1], "rebuilding the table of runs leaves what belongs to them"
    assert found == spec["search"]["generations"]
    sessions.engine.dispose()


def test_the_tables_can_be_taken_down_again(tmp_path):
    sessions = connect(f"sqlite:///{tmp_path / 'new.sqlite'}")
    migrations.upgrade(sessions)
    with sessions.engine.begin() as connection:
        command.downgrade(migrations.config(connection), "base")
    assert inspect(sessions.engine).get_table_names() == ["alembic_version"]
    sessions.engine.dispose()


def test_descriptors_go_down_to_two_columns_and_come_back_with_every_bit(
    services, run_id, report, api
):
    precise = (0.1 + 0.2, 1 / 3e20)
    claim(services, run_id, "worker").record(report(1, {5: 1.0}, precise), 1.0)
    with services.sessions.engine.begin() as connection:
        command.downgrade(migrations.config(connection), "0002")
        rows = connection.execute(text("SELECT descriptor_0, descriptor_1 FROM elites")).all()
    assert [tuple(row) for row in rows] == [precise]
    migrations.upgrade(services.sessions)
    migrations.check(services.sessions)
    assert api.get(f"runs/{run_id}/archive").json()["descriptors"] == [list(precise)]
