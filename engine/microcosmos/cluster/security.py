"""Addresses and certificates of a cluster."""

import os
from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit

from ..optional import require

DEFAULT_PORT = 8786
PACKAGE = "microcosmos[cluster]"


def security(url: str, certificate: Path | None):
    """Return Dask's `Security` for an address such as tls://host:8786.

    The file holds a certificate and its key, of `write_certificate`; whoever has it may join,
    and run programs on every helper. Without TLS an address must be of this machine. Raises
    `ValueError` for another address and for a certificate that is missing or not needed.
    """
    distributed = require("distributed", PACKAGE)
    parts = urlsplit(url)
    if parts.scheme not in ("tls", "tcp") or not parts.hostname or not parts.port:
        raise ValueError(f"the cluster must be like tls://host:{DEFAULT_PORT}, got {url!r}")
    if parts.scheme == "tcp":
        if not _is_loopback(parts.hostname):
            raise ValueError(
                f"tcp:// is only for this machine (127.0.0.1), got {url!r}: use tls:// and a "
                "certificate (microcosmos cluster certificate FILE)"
            )
        if certificate:
            raise ValueError(f"a certificate needs tls://, got {url!r}")
        return None
    if certificate is None:
        raise ValueError(
            "tls:// needs a certificate; make one: microcosmos cluster certificate FILE"
        )
    if not certificate.is_file():
        raise ValueError(f"the certificate must be a file, got {certificate}")
    file = str(certificate)
    roles = ("client", "scheduler", "worker")
    files = {f"tls_{role}_{part}": file for role in roles for part in ("cert", "key")}
    return distributed.Security(require_encryption=True, tls_ca_file=file, **files)


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def write_certificate(path: Path) -> None:
    """Write a new certificate, valid for a year, and its key, for all hosts of a cluster.

    Only the file's owner may read it. Raises `FileExistsError` rather than replace a file.
    """
    require("cryptography", PACKAGE)
    made = require("distributed", PACKAGE).Security.temporary()
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    with os.fdopen(os.open(path, flags, 0o600), "w") as file:
        file.write(f"{made.tls_client_key.strip()}\n{made.tls_client_cert.strip()}\n")
