"""What the environment decides: where things lie, how large, how often."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import AliasChoices, Field, SecretStr, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

LOOPBACK = ("127.0.0.1", "localhost", "::1")
SHORTEST = 16
"""Characters of a token that is set: shorter ones could be found by trying."""


class Settings(BaseSettings):
    """Read from `MICROCOSMOS_*`, and the port from `PORT`."""

    model_config = SettingsConfigDict(
        env_prefix="MICROCOSMOS_", populate_by_name=True, extra="ignore"
    )

    data: Path = Path("data")
    """Folder of database, artifacts, logs and caches."""
    database_url: str = ""
    """Empty: SQLite in the data folder."""
    redis_url: str = "redis://127.0.0.1:6379/0"
    redis_prefix: str = "microcosmos:"
    """Begins the names of queues and streams, so that two installations can share a Redis."""
    artifacts_url: str = ""
    """Where files are kept, as fsspec understands it. Empty: a folder in the data folder."""
    max_bytes: Annotated[int, Field(gt=0)] | None = None
    """Memory that a run may need at most, however much workers have."""
    host: str = "127.0.0.1"
    port: int = Field(
        default=8000, ge=1, le=65535, validation_alias=AliasChoices("PORT", "MICROCOSMOS_PORT")
    )
    token: SecretStr | None = None
    """An admin's, beside those in the database."""
    auth: Literal["local", "required"] = "local"
    """Who needs a token on loopback: nobody, or everybody, as it is beyond loopback."""
    public_url: str = Field(default="", pattern=r"^(https?://[^\s/]+(/\S*)?)?$")
    """How the outside reaches the server, for links that are shared. Empty: as it is asked."""
    workers: int = Field(
        default=1, ge=0, le=256, validation_alias=AliasChoices("WORKERS", "MICROCOSMOS_WORKERS")
    )
    """How many workers `make run` starts."""
    modules: str = ""
    """Python files with something of users' own, a colon between them. Workers alone read it;
    installed packages with entry points `microcosmos.plugins` need not be named."""
    demonstration: bool = True
    """Whether a new data folder begins with a small run."""
    checkpoint_interval: float = Field(default=60.0, ge=0.0)
    """Seconds between two checkpoints of a run."""
    lease: float = Field(default=20.0, gt=0.0)
    """Seconds without a heartbeat after which a worker counts as dead."""
    grace: float = Field(default=15.0, ge=0.0)
    """Seconds that a worker has to obey a cancellation before its job is killed."""
    bin_seconds: float = Field(default=86_400.0, ge=0.0)
    """How long a deleted run can be restored, before it goes for good."""
    reconcile_interval: float = Field(default=5.0, gt=0.0)

    @field_validator("token")
    @classmethod
    def refuse_guessable(cls, token: SecretStr | None) -> SecretStr | None:
        if token and len(token) < SHORTEST:
            raise ValueError(
                f"`token` must have at least {SHORTEST} characters that nobody can guess "
                f"(`openssl rand -hex 32` makes them); got {len(token)}"
            )
        return token

    @property
    def database(self) -> str:
        return self.database_url or f"sqlite:///{self.data.resolve() / 'microcosmos.sqlite'}"

    @property
    def artifacts(self) -> str:
        return self.artifacts_url or str(self.data.resolve() / "artifacts")

    @property
    def needs_token(self) -> bool:
        """Only what this machine alone can reach may go without."""
        return bool(self.token) or self.auth == "required" or self.host not in LOOPBACK
