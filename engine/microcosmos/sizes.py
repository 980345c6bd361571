"""Numbers of bytes for people."""

UNITS = ("B", "kB", "MB", "GB", "TB")


def size(count: float) -> str:
    """Format bytes with three digits."""
    value, unit = float(count), 0
    while value >= 999.5 and unit < len(UNITS) - 1:
        value, unit = value / 1000, unit + 1
    return f"{value:.3g} {UNITS[unit]}"
