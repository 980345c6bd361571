"""`python cluster_run.py SPEC ARCHIVE [URL]`: a run that only helpers compute, or none.

It prints the number of each generation, and the devices that computed it.
"""

import json
import logging
import sys
from functools import partial
from pathlib import Path

from microcosmos import plugins
from microcosmos.build import local
from microcosmos.cluster import over
from microcosmos.device import prepare
from microcosmos.spec import parse


def main(spec: str, archive: str, url: str | None = None) -> None:
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(message)s")
    plugins.load(Path(__file__).with_name("gate.py"))
    prepare(devices=1)
    elsewhere = {"over": partial(over, url=url, own=False)} if url else {}
    local.evolve(
        parse(json.loads(Path(spec).read_bytes())), Path(archive), tell=tell, **elsewhere
    )


def tell(report) -> None:
    print(report.generation, json.dumps(report.summary), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
