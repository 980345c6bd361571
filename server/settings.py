"""Settings from the environment."""

import re
from base64 import b64decode
from contextlib import suppress
from math import inf
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import (
    AliasChoices,
    Field,
    SecretStr,
    ValidationError,
    ValidationInfo,
    field_validator,
)
from pydantic_settings import BaseSettings, SettingsConfigDict

from microcosmos.sinks.address import parse_all

LOOPBACK = ("127.0.0.1", "localhost", "::1")
MIN_TOKEN_LENGTH = 16
WEBHOOK_PREFIX = "whsec_"
WEBHOOK_KEY_BYTES = (24, 64)
"""Least and largest number of random bytes in the secret of the webhook."""
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
    public_url: str = Field(default="", pattern=r"^(https?://[^\s/]+(/\S*)?)?$")
    """Public address of the server, for links to shares. Empty: that of the request."""
    webhook_url: SecretStr | None = None
    """Address that is told when a run ends or needs a person: a secret, as it may hold one."""
    webhook_secret: SecretStr | None = Field(default=None, validate_default=True)
    """Key with which it is signed: `whsec_`, and random bytes in base64."""
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
    """Where workers send the curves, pictures and files of their runs too, separated by
    commas: `tensorboard:FOLDER`, `mlflow:URI`, `wandb:PROJECT`."""
    checkpoint_interval: float = Field(default=60.0, ge=0.0)
    """Seconds between two checkpoints of a run."""
    lease: float = Field(default=20.0, gt=0.0)
    """Seconds without a heartbeat after which a worker counts as dead."""
    grace: float = Field(default=15.0, ge=0.0)
    """Seconds after which the job of a worker that ignores a cancellation is killed."""
    bin_seconds: float = Field(default=86_400.0, ge=0.0)
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
    reconcile_interval: float = Field(default=5.0, gt=0.0)

    @field_validator("token")
    @classmethod
    def refuse_guessable(cls, token: SecretStr | None) -> SecretStr | None:
        if token and len(token) < MIN_TOKEN_LENGTH:
            raise ValueError(
                f"`token` must have at least {MIN_TOKEN_LENGTH} random characters "
                f"(`openssl rand -hex 32` prints some); got {len(token)}"
            )
        return token

    @field_validator("artifacts_url")
    @classmethod
    def refuse_other_stores(cls, url: str) -> str:
        kind, separator, rest = url.partition("://")
        bucket = rest.partition("/")[0]
        if separator and (kind not in ("file", "s3") or (kind == "s3" and not bucket)):
            raise ValueError(
                f"`artifacts_url` must be a folder or s3://BUCKET/PREFIX; got {kind}://…"
            )
        if kind == "s3" and set("@:?") & set(rest):
            raise ValueError(
                "`artifacts_url` must be s3://BUCKET/PREFIX alone: the server's address goes "
                "into AWS_ENDPOINT_URL, credentials into AWS_ACCESS_KEY_ID and "
                "AWS_SECRET_ACCESS_KEY"
            )
        return url

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
        if not re.fullmatch(r"https?://[^\s/@]+(/\S*)?", url.get_secret_value()):
            raise ValueError(
                "`webhook_url` must begin with https:// or http://, without user or password"
            )
        return url

    @field_validator("webhook_secret")
    @classmethod
    def refuse_unsigned(
        cls, secret: SecretStr | None, info: ValidationInfo
    ) -> SecretStr | None:
        if not secret or not secret.get_secret_value():
            if info.data.get("webhook_url"):
                raise ValueError(f"`webhook_secret` is needed with a webhook: {NEW_SECRET}")
            return None
        key = secret.get_secret_value().removeprefix(WEBHOOK_PREFIX)
        with suppress(ValueError):
            least, most = WEBHOOK_KEY_BYTES
            if least <= len(b64decode(key, validate=True)) <= most:
                return secret
        raise ValueError(
            "`webhook_secret` must be `whsec_` and 24 to 64 random bytes in base64: "
            f"{NEW_SECRET}"
        )

    @property
    def database(self) -> str:
        return self.database_url or f"sqlite:///{self.data.resolve() / 'microcosmos.sqlite'}"

    @property
    def artifacts(self) -> str:
        return self.artifacts_url or str(self.data.resolve() / "artifacts")

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
        got = "" if secret else f"; got {one['input']!r}"
        text = one["msg"].removeprefix("Value error, ")
        lines.append(text if text.startswith("`") else f"`{name}`: {text}{got}")
    return "\n".join(lines)


def create_private(folder: Path) -> None:
    """Create a folder that no other user can read; leave an existing one as it is."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
