"""What every part of a spec shares: nothing unknown is accepted and nothing changes."""

from pydantic import BaseModel, ConfigDict
from pydantic.config import JsonDict


class Part(BaseModel):
    """A frozen part of a spec; unknown fields, NaN and infinities are refused."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        validate_default=True,
    )


def unit(name: str) -> JsonDict:
    """The unit of a field, for the forms that people fill in."""
    return {"unit": name}
