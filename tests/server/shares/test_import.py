"""Shared creatures are imported elsewhere: the file that any page may read, and its page."""

import pytest
from answers import detail

from microcosmos.archive import pedigree
from microcosmos.client import Client, NotFound, ServerError, sharing
from microcosmos_server.core import static_files

FOREIGN = {"Origin": "https://else.example"}


@pytest.fixture
def share(api, known) -> dict:
    return api.post("shares", json={"creature": known, "licence": "CC0-1.0"}).json()


def test_pages_of_other_sites_read_the_files_of_a_share_and_nothing_else(api, share, known):
    file = f"shares/{share['slug']}/creature.json"
    answer = api.get(file, headers=FOREIGN)
    assert answer.headers["access-control-allow-origin"] == "*"
    assert pedigree.split(answer.json())[0]["sha256"] == known
    assert answer.json()["licence"] == "CC0-1.0"
    names = api.get(f"shares/{share['slug']}/creatures.json", headers=FOREIGN)
    assert names.headers["access-control-allow-origin"] == "*"
    assert names.json() == {"creatures": [known]}
    for path in (f"shares/{share['slug']}", f"creatures/{known}", f"{file}/x"):
        refused = api.get(path, headers=FOREIGN)
        assert refused.status_code == 403, path
        assert "access-control-allow-origin" not in refused.headers
    assert api.post(file, headers=FOREIGN).status_code == 403
    assert api.get(file, headers={"Host": "evil.example"}).status_code == 403


def test_a_file_holds_only_what_the_share_shows(api, share, upload, identity):
    other = upload(identity(4))
    path = f"shares/{share['slug']}/creature.json"
    assert api.get(path, params={"creature": other}).status_code == 404
    api.delete(f"shares/{share['slug']}")
    gone = api.get(path, headers=FOREIGN)
    assert detail(gone, 410) == "Its owner has revoked this share."
    assert gone.headers["access-control-allow-origin"] == "*", "the page can say why"


@pytest.fixture
def built(tmp_path, monkeypatch):
    (tmp_path / "index.html").write_text("<title>Microcosmos</title>")
    monkeypatch.setattr(static_files, "BUILT", tmp_path)


SHARE = "https://lab.example:8443/a/s/Ab-_9"


@pytest.mark.parametrize("sent", [SHARE, f"{SHARE}/", f"{SHARE}/creatures/{'ab' * 32}"])
def test_the_page_of_an_import_may_request_two_files(api, address, built, sent):
    at = api.get(f"{address}/import", params={"share": sent})
    policy = at.headers["content-security-policy"].split("; ")
    file = "https://lab.example:8443/a/api/v1/shares/Ab-_9/creature.json"
    names = "https://lab.example:8443/a/api/v1/shares/Ab-_9/creatures.json"
    assert policy[-1] == f"connect-src 'self' {file} {names}"
    assert policy[0] == "default-src 'self'"


@pytest.mark.parametrize(
    "sent",
    [
        "",
        "https://lab.example/",
        "javascript://lab.example/s/x",
        "https://lab.example/s/x; script-src *",
        "https://*/s/x",
        "https://lab.example *//s/x",
        "https://lab.example/s/x\nconnect-src *",
        "https://a@lab.example/s/x",
    ],
)
def test_an_address_that_is_none_opens_nothing(api, address, built, sent):
    at = api.get(f"{address}/import", params={"share": sent})
    assert "connect-src" not in at.headers["content-security-policy"]


def test_a_client_imports_a_share_by_its_address(address, share, known):
    with Client(address) as client:
        assert client.import_creature(share["url"]).sha == known
        assert client.import_creature(f"{share['url']}/creatures/{known}").sha == known
        with pytest.raises(NotFound):
            client.import_creature(f"{address}/s/none")
        with pytest.raises(ValueError, match="`address` must be that of a share"):
            list(client.import_all("x.json"))
        with pytest.raises(ValueError, match="shares a creature"):
            client.submit(share["url"])


def test_a_client_verifies_what_it_imports(monkeypatch, share, known, api):
    file = api.get(f"shares/{share['slug']}/creature.json").json()
    at = sharing.address(f"https://lab.example/s/x/creatures/{'ab' * 32}")
    assert at
    monkeypatch.setattr(sharing.Address, "read", lambda *_, **__: file)
    with pytest.raises(ServerError, match=f"instead of {'ab' * 32}"):
        sharing.creature(at)
    file["identity"]["task"]["steps"] += 1
    with pytest.raises(ValueError, match="sha256"):
        sharing.creature(at._replace(creature=None))
