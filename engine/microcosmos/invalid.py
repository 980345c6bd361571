"""Errors of fields as data: the field, the reason, and the nearest number that is allowed."""

from collections.abc import Mapping
from typing import Any

PREFIX = "Input should be "
"""Prefix of most of pydantic's messages; ours have "needs" in its place."""
NEEDED = {
    "missing": "a value",
    "extra_forbidden": "no field of this name",
    "uuid_parsing": "an id such as 1b4e28ba-2fa1-41d2-883f-0016d3cca427",
    "uuid_type": "an id such as 1b4e28ba-2fa1-41d2-883f-0016d3cca427",
    "too_short": "{min_length} or more items",
    "too_long": "at most {max_length} items",
    "string_too_short": "{min_length} or more characters",
    "string_too_long": "at most {max_length} characters",
    "string_pattern_mismatch": "a text that matches {pattern}",
}
"""Needed values, by types of pydantic's errors whose messages do not state them, or begin with
the name of a type; in braces are names of the error's context."""


class InvalidField(ValueError):
    """A wrong value: its `field` as a dotted path, and the `reason`, which follows the name.

    `least` or `most` is the nearest number that the field would accept.
    """

    def __init__(
        self,
        field: str,
        reason: str,
        *,
        needed: str | None = None,
        got: Any = None,
        least: float | None = None,
        most: float | None = None,
    ):
        super().__init__(field, reason)  # The arguments with which pickle creates it again.
        self.field, self.reason = field, reason
        self.needed, self.got = needed, got
        self.least, self.most = least, most

    def __str__(self) -> str:
        return f"`{self.field}` {self.reason}" if self.field else self.reason

    def within(self, path: str) -> "InvalidField":
        """Return the same error of a field in the part at a path."""
        field = ".".join(filter(None, [path, self.field]))
        limits = {"least": self.least, "most": self.most}
        return InvalidField(field, self.reason, needed=self.needed, got=self.got, **limits)


def invalid_field(error: Mapping[str, Any], path: str) -> InvalidField:
    """Return one of the `errors()` of a pydantic model, which is about the part at a path."""
    kind = error["type"]
    context = error.get("ctx", {})
    match context.get("error"):
        case InvalidField() as ours:
            return ours.within(path)
        case ValueError() as ours:
            return InvalidField(path, str(ours))
    if kind in NEEDED:
        needed = NEEDED[kind].format_map(context)
    else:
        needed = str(error["msg"]).removeprefix(PREFIX)
    got = "nothing" if kind == "missing" else error["input"]
    return InvalidField(path, f"needs {needed}; got {got!r:.120}", needed=needed, got=got)
