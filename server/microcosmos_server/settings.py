"""Settings from the environment."""

import re
import sys
from base64 import b64decode
from contextlib import suppress
from math import inf
from pathlib import Path
from typing import Annotated, Literal, get_args
from urllib.parse import urlsplit

from pydantic import (
    AliasChoices,
    Field,
    SecretStr,
    ValidationError,
    ValidationInfo,
    field_validator,
)
from pydantic_settings import BaseSettings, SettingsConfigDict
from redis import ConnectionPool, RedisError
from sqlalchemy import URL, make_url
from sqlalchemy.exc import ArgumentError

from microcosmos.invalid import invalid_field
from microcosmos.sinks.address import parse_all

LOOPBACK = ("127.0.0.1", "localhost", "::1")
MIN_TOKEN_LENGTH = 16
WEBHOOK_PREFIX = "whsec_"
WEBHOOK_KEY_BYTES = (24, 64)
"""Least and largest number of random bytes in the secret of the webhook."""
MAX_DAYS = 36_500
"""A century: the calendar and the timers of a program end not much later."""
MAX_SECONDS = MAX_DAYS * 86_400
NEW_SECRET = "`echo whsec_$(openssl rand -base64 32)` prints one"


class Settings(BaseSettings):
    """Read from `MICROCOSMOS_*`; some also from `PORT`, `WORKERS` and `SERVERS`."""

    model_config = SettingsConfigDict(
        env_prefix="MICROCOSMOS_",
        populate_by_name=True,
        extra="ignore",
        hide_input_in_errors=True,  # Secrets are among the input; see `explain`.
    )

    data: Path = Path("data")
    """Folder of database, artifacts, logs and caches."""
    database_url: str = ""
    """Empty: SQLite in the data folder."""
    redis_url: str = "redis://127.0.0.1:6379/0"
    redis_prefix: str = "microcosmos:"
    """Prefix of queues and streams, so that two installations can share a Redis."""
    artifacts_url: str = ""
    """The store of files: a folder, or `s3://bucket/prefix`. Empty: in the data folder."""
    max_bytes: Annotated[int, Field(gt=0)] | None = None
    """Limit on the memory of a run, in addition to that of the workers."""
    min_free_bytes: Annotated[int, Field(ge=0)] = 2_000_000_000
    """Free bytes on a disk below which runs, `/readyz` and the page warn."""
    host: str = "127.0.0.1"
    port: int = Field(
        default=8000, ge=1, le=65535, validation_alias=AliasChoices("PORT", "MICROCOSMOS_PORT")
    )
    token: SecretStr | None = None
    """An admin token, in addition to those in the database."""
    auth: Literal["local", "required"] = "local"
    """`required`: a token is needed on loopback too, as it always is elsewhere."""
    public_url: str = ""
    """Public address of the server, for links to shares. Empty: that of the request. Without a
    path: all pages begin at the root of their host."""
    webhook_url: SecretStr | None = None
    """Webhook, called when a run ends or needs a person. Its URL may contain a secret."""
    # The default is checked, too: with a webhook a missing secret is an error.
    webhook_secret: SecretStr | None = Field(default=None, validate_default=True)
    """Key that signs calls of the webhook: `whsec_`, and random bytes in base64."""
    workers: int = Field(
        default=1, ge=0, le=256, validation_alias=AliasChoices("WORKERS", "MICROCOSMOS_WORKERS")
    )
    """Number of workers that `make run` starts."""
    servers: int = Field(
        default=1, ge=1, le=64, validation_alias=AliasChoices("SERVERS", "MICROCOSMOS_SERVERS")
    )
    """Number of processes that answer requests, all at one port."""
    modules: str = ""
    """Python files with plug-ins, separated by colons. Only workers read them. Installed
    packages with entry points `microcosmos.plugins` need not be named."""
    demonstration: bool = True
    """Submit a small run in a new data folder."""
    labels: str = ""
    """Labels of the workers of this machine, separated by commas: runs can ask for them."""
    cluster: str = ""
    """Scheduler of helpers that compute for this machine's workers too, like tls://host:8786.
    Only workers read it."""
    cluster_certificate: Path | None = None
    """File of `microcosmos cluster certificate`, which tls:// needs."""
    sinks: str = ""
    """Sinks that also get the curves, pictures and files of runs, separated by commas:
    `tensorboard:FOLDER`, `mlflow:URI`, `wandb:PROJECT`."""
    checkpoint_interval: float = Field(default=60.0, ge=0.0)
    """Seconds between two checkpoints of a run."""
    segment_bytes: int = Field(default=1 << 18, ge=64)
    """Bytes of a piece of a growing column that is stored once for all checkpoints of a run."""
    lease: float = Field(default=20.0, gt=0.0, le=MAX_SECONDS)
    """Seconds without a heartbeat after which a worker counts as dead."""
    grace: float = Field(default=15.0, ge=0.0, le=MAX_SECONDS)
    """Seconds after which the job of a worker that ignores a cancellation is killed."""
    bin_seconds: float = Field(default=86_400.0, ge=0.0, le=MAX_SECONDS)
    """Seconds in which a deleted run can be restored."""
    keep_checkpoints: float = Field(default=inf, ge=0.0)
    """Days for which an ended run keeps checkpoints beside its last one."""
    keep_renderings: float = Field(default=90.0, ge=0.0)
    """Days for which replays, pictures and films are kept; a request makes them again."""
    keep_poses: float = Field(default=inf, ge=0.0)
    """Days after the end of its runs for which a replaced elite keeps its pose stream."""
    keep_logs: float = Field(default=inf, ge=0.0)
    """Days for which the log of an ended run is kept."""
    keep_device_use: float = Field(default=inf, ge=31.0)
    """Days for which the device time of owners is kept; quotas need 30."""
    keep_events: float = Field(default=1.0, ge=0.0)
    """Days for which the event stream keeps events."""
    log_format: Literal["plain", "json"] = "plain"
    log_bytes: Annotated[int, Field(gt=0)] = 20_000_000
    """Length at which `make run` rotates a log."""
    reconcile_interval: float = Field(default=5.0, gt=0.0, le=MAX_SECONDS)

    @field_validator("data")
    @classmethod
    def refuse_impossible_folders(cls, folder: Path) -> Path:
        needed = "must be a folder, or one that can be made"
        try:
            first = existing(folder.resolve())
            possible = first.is_dir()
        except (
            OSError,
            RuntimeError,
        ) as error:  # A name is too long, or links lead in a circle.
            reason = getattr(error, "strerror", None) or str(error)
            raise ValueError(f"{needed}; got {folder} ({reason})") from None
        if not possible:
            raise ValueError(f"{needed}; got {folder}, and {first} is a file")
        return folder

    @field_validator(
        *("keep_checkpoints", "keep_renderings", "keep_poses"),
        *("keep_logs", "keep_device_use", "keep_events"),
    )
    @classmethod
    def refuse_impossible_days(cls, days: float) -> float:
        if MAX_DAYS < days < inf:
            raise ValueError(f"must be at most {MAX_DAYS} days, or inf: for ever; got {days:g}")
        return days

    @field_validator("token")
    @classmethod
    def refuse_guessable(cls, token: SecretStr | None) -> SecretStr | None:
        if token and len(token) < MIN_TOKEN_LENGTH:
            raise ValueError(
                f"must have at least {MIN_TOKEN_LENGTH} random characters "
                f"(`openssl rand -hex 32` prints some); got {len(token)}",
            )
        return token

    @field_validator("database_url")
    @classmethod
    def refuse_other_databases(cls, url: str) -> str:
        if not url:
            return url
        with suppress(ArgumentError, ValueError):  # Their texts may show the password.
            made = make_url(url)
            # In memory each process would have a database of its own; options can mean that.
            on_disk = made.database not in (None, "", ":memory:") and not made.query
            drivers = {"postgresql", "postgresql+psycopg", *(["sqlite"] if on_disk else [])}
            if made.drivername in drivers:
                return url
        raise ValueError(
            "must be postgresql+psycopg://USER:PASSWORD@HOST/NAME or sqlite:///FILE"
        )

    @field_validator("redis_url")
    @classmethod
    def refuse_other_brokers(cls, url: str) -> str:
        # Their texts may show the password. A wrong option is a TypeError.
        with suppress(ValueError, TypeError, RedisError):
            ConnectionPool.from_url(url).make_connection()
            # Redis takes database 0 for a path that is no number.
            if url.startswith("unix:") or re.fullmatch(r"(/\d*)?", urlsplit(url).path):
                return url
        raise ValueError("must be redis://:PASSWORD@HOST:PORT/NUMBER")

    @field_validator("artifacts_url")
    @classmethod
    def refuse_other_stores(cls, url: str) -> str:
        kind, separator, rest = url.partition("://")
        bucket = rest.partition("/")[0]
        if separator and (kind != "s3" or not bucket):
            raise ValueError(f"must be a folder or s3://BUCKET/PREFIX; got {kind}://…")
        if kind == "s3" and set("@:?") & set(rest):
            raise ValueError(
                "must be s3://BUCKET/PREFIX alone: the server's address goes "
                "into AWS_ENDPOINT_URL, credentials into AWS_ACCESS_KEY_ID and "
                "AWS_SECRET_ACCESS_KEY",
            )
        return url

    @field_validator("public_url")
    @classmethod
    def refuse_paths(cls, url: str) -> str:
        if not re.fullmatch(r"(https?://[^\s/?#@]+/?)?", url):
            raise ValueError(
                "must be http:// or https:// and a host, without a path: all pages begin at "
                f"the root of their host, so a proxy gives them one of its own; got {url}"
            )
        return url.rstrip("/")

    @field_validator("sinks")
    @classmethod
    def refuse_other_sinks(cls, sinks: str) -> str:
        parse_all(sinks.split(","))
        return sinks

    @field_validator("webhook_url")
    @classmethod
    def refuse_other_schemes(cls, url: SecretStr | None) -> SecretStr | None:
        if not url or not url.get_secret_value():
            return None
        text = url.get_secret_value()
        if not re.match(r"https?://[^@/?#]+([/?#]|$)", text):
            raise ValueError("must begin with https:// or http://, without user or password")
        with suppress(ValueError):  # Their texts may show the secret.
            parts = urlsplit(text)
            sent = f"{parts.path}?{parts.query}"
            host = (parts.hostname or "").encode("idna").decode()
            # `urlsplit` leaves out newlines and tabs.
            plain = re.fullmatch(r"[!-~]+", host + sent) and not re.search(r"\s", text)
            if parts.port != 0 and host and plain:
                return url
        raise ValueError(
            "must have a host, a port from 1 to 65535 if any, and after them ASCII alone "
            "(%C3%A4 instead of ä)"
        )

    @field_validator("webhook_secret")
    @classmethod
    def refuse_unsigned(
        cls, secret: SecretStr | None, info: ValidationInfo
    ) -> SecretStr | None:
        if not secret or not secret.get_secret_value():
            if info.data.get("webhook_url"):
                raise ValueError(f"is needed with a webhook: {NEW_SECRET}")
            return None
        key = secret.get_secret_value().removeprefix(WEBHOOK_PREFIX)
        with suppress(ValueError):
            least, most = WEBHOOK_KEY_BYTES
            if least <= len(b64decode(key, validate=True)) <= most:
                return secret
        raise ValueError(
            f"must be `whsec_` and 24 to 64 random bytes in base64: {NEW_SECRET}",
        )

    @property
    def database(self) -> URL:
        if self.database_url:
            return make_url(self.database_url)
        # As text, a folder named `r?1` would lead to the folder `r`.
        return URL.create("sqlite", database=str(self.data.resolve() / "microcosmos.sqlite"))

    @property
    def database_file(self) -> Path | None:
        """The file of an SQLite database."""
        url = self.database
        return Path(str(url.database)) if url.get_backend_name() == "sqlite" else None

    @property
    def artifacts(self) -> str:
        return self.artifacts_url or str(self.data.resolve() / "artifacts")

    @property
    def address(self) -> str:
        """Address on this machine, to print and to ask."""
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(self.host, self.host)
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}"

    @property
    def needs_admin_token(self) -> bool:
        """A token is needed, and the environment sets none."""
        return self.needs_token and not self.token

    @property
    def needs_token(self) -> bool:
        return bool(self.token) or self.auth == "required" or self.host not in LOOPBACK


def explain(error: ValidationError) -> str:
    """Return what is wrong with the environment, in lines that hold no secret."""
    lines: list[str] = []
    for one in error.errors():
        name = str(one["loc"][0])
        field = Settings.model_fields.get(name)
        secret = field is not None and SecretStr in get_args(field.annotation)
        found = invalid_field(one, name)
        needed = found.needed and f"`{name}` needs {found.needed}"
        lines.append(needed if secret and needed else str(found))
    return "\n".join(lines)


def from_environment() -> Settings:
    """Return the settings; end the program with what is wrong with them."""
    try:
        return Settings()
    except ValidationError as error:
        sys.exit(explain(error))


def create_private(folder: Path) -> None:
    """Create a folder that no other user can read; leave an existing one as it is."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)


def create_data_folder(settings: Settings) -> None:
    """Create the data folder; end the program where that is not possible."""
    try:
        create_private(settings.data)
    except OSError as error:
        needed = "`data` must be a folder, or one that can be made"
        sys.exit(f"{needed}; got {settings.data} ({error.strerror})")


def existing(path: Path) -> Path:
    """Return a path, or its nearest parent that exists."""
    return next(one for one in (path, *path.parents) if one.exists())
