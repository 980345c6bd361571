"""The command `microcosmos`, also `python -m microcosmos`."""

from .loading import load


def main() -> None:
    """Carry out a command."""
    load("microcosmos.cli").app()


if __name__ == "__main__":
    main()
