"""Tokens made outside of a request: by the first start and on the command line."""

import stat
from dataclasses import replace

import pytest
from pydantic import SecretStr

from server.auth import __main__ as commands
from server.auth import bootstrap, tokens
from server.core.errors import ProblemError


@pytest.fixture
def settings(services, tmp_path):
    """Those of the server, with a data folder where nothing is yet."""
    return services.settings.model_copy(update={"data": tmp_path})


def test_the_first_start_beyond_loopback_makes_the_token_of_an_admin(serve, services, settings):
    open_to_all = settings.model_copy(update={"host": "0.0.0.0"})
    exposed = with_settings(services, open_to_all)
    secret = bootstrap.create_first_token(exposed)
    assert secret is not None
    file = settings.data / bootstrap.FILE
    assert file.read_text() == f"{secret}\n"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert secret in bootstrap.announcement(open_to_all, secret)
    assert str(file) in bootstrap.announcement(open_to_all, secret)
    assert bootstrap.create_first_token(exposed) is None  # The second start makes none.
    assert tokens.principal_of(services, secret).scope == "admin"


def with_settings(services, settings):
    return replace(services, settings=settings)


def test_no_token_is_made_where_none_is_needed_or_one_is_set(rows, services, settings):
    assert bootstrap.create_first_token(services) is None
    told = settings.model_copy(update={"host": "0.0.0.0", "token": SecretStr("secret")})
    assert bootstrap.create_first_token(with_settings(services, told)) is None
    assert rows() == []


def test_a_server_whose_admins_are_all_gone_does_not_listen(rows, services, settings, admin):
    exposed = with_settings(services, settings.model_copy(update={"host": "0.0.0.0"}))
    bootstrap.refuse_without_admin(exposed)
    tokens.revoke(services, rows()[0].id, last=True)
    for begin in (bootstrap.create_first_token, bootstrap.refuse_without_admin):
        with pytest.raises(ValueError, match=r"python -m server\.auth create"):
            begin(exposed)


def test_tokens_are_made_and_revoked_on_the_command_line(
    services, settings, monkeypatch, capsys
):
    monkeypatch.setattr(commands, "Settings", lambda: settings)
    commands.main(["create", "frank", "--scope", "admin", "--days", "1"])
    secret = capsys.readouterr().out.strip()
    assert tokens.principal_of(services, secret).name == "frank"
    commands.main(["list"])
    assert "frank\tadmin\t" + secret[:9] in capsys.readouterr().out
    commands.main(["revoke", "frank"])
    with pytest.raises(ProblemError, match="`frank` was revoked"):
        tokens.principal_of(services, secret)
    with pytest.raises(SystemExit, match="No live token is named 'frank'"):
        commands.main(["revoke", "frank"])
