"""Commands for pictures: targets of folding runs, and obstacles."""

from hashlib import md5
from pathlib import Path
from typing import Annotated

import httpx
import typer
from typer import Argument, Option

from ..archive.atomic import write_whole
from ..spec import Pattern, targets
from ..spec import picture as target
from .app import app, console, fail, failing

MNIST = "https://ossci-datasets.s3.amazonaws.com/mnist/"
"""PyTorch's mirror of LeCun's files."""

MNIST_FILES = {
    "t10k-images-idx3-ubyte.gz": "9fb629c4189551a2d022fa330f9573f3",
    "t10k-labels-idx1-ubyte.gz": "ec29112dd5afa0611ce80d1b7f02629c",
}
"""The test set, with the MD5 digests that torchvision checks."""

data = typer.Typer(help="Download public data sets.", no_args_is_help=True)
app.add_typer(data, name="data")


@app.command()
def picture(
    file: Annotated[
        Path | None, Argument(help="A picture, or an IDX file of images such as MNIST's.")
    ] = None,
    number: Annotated[
        int | None, Option(help="Number of the image in an IDX file, from 0.")
    ] = None,
    text: Annotated[str | None, Option(help="Text to draw, instead of FILE.")] = None,
    font: Annotated[Path | None, Option(help="Font file for --text.")] = None,
    name: Annotated[str | None, Option(help="Name of the picture in the run.")] = None,
    obstacle: Annotated[
        bool, Option("--obstacle", help="Print an obstacle, for `world.obstacles`.")
    ] = False,
) -> None:
    """Print a picture as JSON, for `targets` of a folding spec or for `world.obstacles`."""
    if (file is None) == (text is None):
        fail("picture needs FILE or --text, but not both")
    with failing():
        if file is None:
            ink, default = targets.text(text or "", font), text or ""
        elif number is not None:
            ink, default = targets.mnist(file, number), f"{file.name} {number}"
        else:
            ink, default = targets.png(file), file.stem
        found = Pattern.of_ink(ink) if obstacle else target((name or default)[:64], ink)
        print(found.model_dump_json())


@data.command()
def mnist(
    folder: Annotated[Path, Argument(help="Folder to write the files to.")] = Path("mnist"),
) -> None:
    """Download and verify the test images and labels of MNIST."""
    with failing("FOLDER must be a folder or a new path"):
        folder.mkdir(parents=True, exist_ok=True)
    for file, digest in MNIST_FILES.items():
        path = folder / file
        if path.exists() and _digest(path.read_bytes()) == digest:
            console.print(f"{path} exists")
            continue
        try:
            answer = httpx.get(MNIST + file, follow_redirects=True, timeout=60)
            answer.raise_for_status()
        except httpx.HTTPError as error:
            fail(f"{MNIST + file}: {error}")
        if (found := _digest(answer.content)) != digest:
            fail(f"{file} must have the MD5 digest {digest}, got {found}; nothing is kept")
        write_whole(path, answer.content)
        console.print(f"{path} is downloaded and verified")


def _digest(content: bytes) -> str:
    return md5(content, usedforsecurity=False).hexdigest()
