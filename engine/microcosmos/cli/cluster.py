"""Commands of a cluster, on which one run computes with the devices of many hosts."""

import logging
import os
import shlex
from pathlib import Path
from typing import Annotated

import typer
from typer import Argument, Option

from ..archive.atomic import write_whole
from .app import CACHE, Modules, app, fail, failing, refuse_input, say

group = typer.Typer(
    help="Compute one run on many hosts: start a scheduler, join it with helpers, and give "
    "`evolve --cluster` its address.",
    no_args_is_help=True,
)
app.add_typer(group, name="cluster")

Address = Annotated[str, Argument(metavar="URL", help="Like tls://host:8786.")]
CERTIFICATE = "MICROCOSMOS_CLUSTER_CERTIFICATE"
Certificate = Annotated[
    Path | None,
    Option(
        envvar=CERTIFICATE,
        help="File of `microcosmos cluster certificate`, the same on every host.",
    ),
]


@group.command("certificate")
def certificate(
    file: Annotated[Path, Argument(help="New file; whoever has it may join.")],
) -> None:
    """Write the certificate and key that all hosts of a cluster share."""
    from ..cluster import write_certificate

    with failing(file):
        write_certificate(file)
    say(
        f"{file} is valid for a year. Copy it to every host, and keep it secret: "
        "whoever has it may run programs on all of them."
    )


@group.command("scheduler")
def scheduler(url: Address, certificate: Certificate = None) -> None:
    """Run the scheduler at an address of this machine, until Ctrl+C. It needs no GPU."""
    from ..cluster.scheduler import serve

    with failing("cluster"):
        serve(url, certificate, lambda address: say(f"Helpers may join {address}"))


@group.command("join")
def join(
    url: Address,
    certificate: Certificate = None,
    processes: Annotated[
        int | None,
        Option(min=1, help="Number of helpers; default: one for each GPU, else each core."),
    ] = None,
    module: Modules = None,
    slurm: Annotated[
        Path | None,
        Option(help="Write a SLURM batch file that joins from two nodes, and do not join."),
    ] = None,
) -> None:
    """Compute blocks for runs elsewhere with all devices of this machine, until Ctrl+C."""
    from ..cluster import security
    from ..cluster.join import join, sbatch

    inputs = [*(module or ()), *([certificate] if certificate else [])]
    refuse_input(slurm, *inputs, option="--slurm")
    with failing("cluster"):
        # A wrong address is refused before a batch file is written or a helper is started.
        security(url, certificate)
    options = ["--certificate", str(certificate.resolve())] if certificate else []
    for file in module or ():
        # Whole paths: helpers of a batch file may start in another folder.
        options += ["--module", str(file.resolve())]
    if slurm:
        words = ["microcosmos", "cluster", "join", url, *options]
        words += ["--processes", str(processes)] if processes else []
        with failing(slurm):
            write_whole(slurm, sbatch(shlex.join(words), gpus=not processes).encode())
        say(f"Change {slurm} to fit your cluster, then: sbatch {slurm}")
        return
    logging.basicConfig(format="%(asctime)s %(message)s")
    logging.getLogger("microcosmos").setLevel(logging.INFO)
    with failing("cluster"):
        cache = Path(os.environ.get("JAX_COMPILATION_CACHE_DIR") or CACHE)
        try:
            went_on = join(url, options, cache, processes)
        except RuntimeError as error:
            fail(f"JAX fails: {error}")
    if not went_on:
        fail("no helper could go on")
