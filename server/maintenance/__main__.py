"""`python -m server.maintenance`: back up a running installation, restore one, check files."""

import argparse
import sys
from pathlib import Path

from ..services.services import Services, connect
from ..settings import Settings, create_private
from . import backup
from .backup import BackupError
from .dump import DumpError


def main(words: list[str] | None = None) -> None:
    arguments = _arguments().parse_args(words)
    settings = Settings()
    create_private(settings.data)
    services = connect(settings)
    try:
        arguments.act(services, arguments)
    except (BackupError, DumpError, OSError) as error:
        sys.exit(str(error))
    finally:
        services.close()


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m server.maintenance", description=__doc__)
    actions = parser.add_subparsers(required=True, metavar="backup | restore | check")
    saving = actions.add_parser("backup", help="copy the database, then the files it names")
    saving.add_argument("folder", type=Path, help="a new folder, or that of an earlier backup")
    saving.set_defaults(act=_backup)
    restoring = actions.add_parser("restore", help="restore into an empty database and store")
    restoring.add_argument("folder", type=Path)
    restoring.set_defaults(act=_restore)
    checking = actions.add_parser("check", help="read each file that the database names")
    checking.set_defaults(act=_check)
    return parser


def _backup(services: Services, arguments: argparse.Namespace) -> None:
    made, faults = backup.make(services, arguments.folder.resolve())
    print(f"{len(made.files)} files and the database ({made.database}) in {arguments.folder}")
    _end_with(faults)


def _restore(services: Services, arguments: argparse.Namespace) -> None:
    made = backup.restore(services, arguments.folder.resolve())
    print(f"The backup of {made.made_at} is restored.")
    _check(services, arguments)


def _check(services: Services, arguments: argparse.Namespace) -> None:
    number, faults = backup.check(services)
    print(f"The database names {number} files; {number - len(faults)} are intact.")
    _end_with(faults)


def _end_with(faults: list[str]) -> None:
    """End with status 1 if files of the store are not intact."""
    if faults:
        sys.exit("\n".join(("The store does not have all files:", *faults)))


if __name__ == "__main__":
    main()
