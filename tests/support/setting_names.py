"""Names of the environment variables that the settings read."""

from microcosmos_server.settings import Settings


def names_of(field: str) -> set[str]:
    """Return the variables of a setting: its own names, or the usual one."""
    alias = Settings.model_fields[field].validation_alias
    return set(getattr(alias, "choices", ())) or {f"MICROCOSMOS_{field.upper()}"}


def setting_names() -> set[str]:
    return {name for field in Settings.model_fields for name in names_of(field)}
