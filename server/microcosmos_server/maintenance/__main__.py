"""`python -m microcosmos_server.maintenance`: back up, restore and check an installation."""

import argparse
import sys
from pathlib import Path

from sqlalchemy.exc import SQLAlchemyError

from ..services.services import Services, connect
from ..settings import create_data_folder, from_environment
from ..tables import migrations
from . import backup
from .backup import BackupError, DumpError


def main(words: list[str] | None = None) -> None:
    arguments = _arguments().parse_args(words)
    settings = from_environment()
    file = settings.database_file
    if arguments.act is _restore:
        create_data_folder(settings)
    elif file and not file.exists():  # A mistyped folder is not made.
        sys.exit(f"`data` must be the folder of an installation; there is no {file}")
    services = connect(settings)
    try:
        if arguments.act is not _restore and (fault := migrations.fault(services.sessions)):
            sys.exit(fault)
        arguments.act(services, arguments)
    except (BackupError, DumpError, migrations.SchemaError, OSError) as error:
        sys.exit(str(error))
    except SQLAlchemyError as error:
        sys.exit(f"The database does not answer: {getattr(error, 'orig', None) or error}")
    finally:
        services.close()


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m microcosmos_server.maintenance", description=__doc__
    )
    actions = parser.add_subparsers(required=True, metavar="backup | restore | check")
    saving = actions.add_parser("backup", help="copy the database, then the files it names")
    saving.add_argument("folder", type=Path, help="an empty folder, or that of earlier backups")
    saving.set_defaults(act=_backup)
    restoring = actions.add_parser("restore", help="restore into an empty database and store")
    restoring.add_argument("folder", type=Path)
    restoring.set_defaults(act=_restore)
    checking = actions.add_parser("check", help="read each file that the database names")
    checking.set_defaults(act=_check)
    return parser


def _backup(services: Services, arguments: argparse.Namespace) -> None:
    made = backup.make(services, arguments.folder.resolve())
    print(f"{len(made.files)} files and the database ({made.database}) in {arguments.folder}")
    _end_with(made.faults)


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
