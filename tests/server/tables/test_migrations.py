"""The tables are those of the models, on every database."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from alembic import command
from sqlalchemy import URL, inspect, make_url

from microcosmos_server.core.database import connect
from microcosmos_server.tables import migrations

pytestmark = pytest.mark.postgresql


def test_migrated_tables_are_those_of_the_models(services):
    migrations.check(services.sessions)


def test_several_processes_may_migrate_a_new_database_at_once(tmp_path):
    url = f"sqlite:///{tmp_path / 'new.sqlite'}"
    several = [connect(make_url(url)) for _ in range(4)]
    with ThreadPoolExecutor() as pool:
        list(pool.map(migrations.upgrade, several))
    assert "runs" in inspect(several[0].engine).get_table_names()
    for sessions in several:
        sessions.engine.dispose()


def test_the_tables_can_be_taken_down_again(tmp_path):
    sessions = connect(URL.create("sqlite", database=str(tmp_path / "new.sqlite")))
    migrations.upgrade(sessions)
    with sessions.engine.begin() as connection:
        command.downgrade(migrations.config(connection), "base")
    assert inspect(sessions.engine).get_table_names() == ["alembic_version"]
    sessions.engine.dispose()
