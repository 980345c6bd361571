"""Addresses and certificates: what is refused, and that TLS is on beyond this machine."""

import asyncio
import stat

import pytest

from microcosmos.cluster import security, write_certificate
from microcosmos.cluster.scheduler import configured


@pytest.fixture
def certificate(tmp_path):
    file = tmp_path / "cluster.pem"
    write_certificate(file)
    return file


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("tcp://example.org:8786", "only for this machine"),
        ("tcp://0.0.0.0:8786", "only for this machine"),
        ("tls://example.org:8786", "needs a certificate"),
        ("tls://example.org", "must be like tls://host:8786, got 'tls://example.org'"),
        ("http://127.0.0.1:8786", "must be like"),
        ("head:8786", "must be like"),
    ],
)
def test_an_address_that_may_not_be_used_is_named(url, message):
    with pytest.raises(ValueError, match=message):
        security(url, None)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "[::1]"])
def test_this_machine_needs_no_certificate(host, tmp_path):
    """It uses none either: the environment may name one for the addresses elsewhere."""
    for given in (None, tmp_path / "absent"):
        assert security(f"tcp://{host}:8786", given) is None


def test_a_certificate_that_is_missing_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"must be a file, got .*absent"):
        security("tls://head:8786", tmp_path / "absent")


def test_only_its_owner_reads_a_certificate_and_no_file_is_replaced(certificate):
    assert stat.S_IMODE(certificate.stat().st_mode) == 0o600
    before = certificate.read_bytes()
    with pytest.raises(FileExistsError):
        write_certificate(certificate)
    assert certificate.read_bytes() == before


def test_who_has_the_certificate_may_connect_and_nobody_else(certificate, tmp_path):
    """A scheduler with TLS answers a client with its certificate, not one with another."""
    other = tmp_path / "other.pem"
    write_certificate(other)
    distributed = configured()

    async def connect(scheduler, file):
        url = scheduler.address
        return await distributed.Client(
            url, security=security(url, file), asynchronous=True, timeout=5
        )

    async def run():
        async with distributed.Scheduler(
            host="127.0.0.1",
            port=0,
            protocol="tls",
            security=security("tls://127.0.0.1:8786", certificate),
            dashboard=False,
            dashboard_address="127.0.0.1:0",
        ) as scheduler:
            client = await connect(scheduler, certificate)
            found = await client.scheduler.identity()
            await client.close()
            with pytest.raises(OSError, match=r"(?i)timed out|ssl|tls"):
                await connect(scheduler, other)
            return found

    assert asyncio.run(run())["address"].startswith("tls://127.0.0.1:")
