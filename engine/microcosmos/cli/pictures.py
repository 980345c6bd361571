"""Commands for pictures: targets of folding runs, and obstacles."""

from hashlib import md5
from pathlib import Path
from typing import Annotated

import httpx
import typer
from typer import Argument, Option

from ..archive.atomic import place, write_whole
from ..spec import Pattern, targets
from ..spec import picture as target
from ..spec.targets import MAX_PIXELS
from .app import app, fail, failing, say

MNIST = "https://ossci-datasets.s3.amazonaws.com/mnist/"
"""PyTorch's mirror of LeCun's files."""

MNIST_FILES = {
    "t10k-images-idx3-ubyte.gz": "9fb629c4189551a2d022fa330f9573f3",
    "t10k-labels-idx1-ubyte.gz": "ec29112dd5afa0611ce80d1b7f02629c",
}
"""The test set, with the MD5 digests that torchvision checks."""

LONGEST = 100
"""Characters of a text: the letters of a longer one have less than five pixels."""

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
    if text is not None and len(text) > LONGEST:
        fail(
            f"--text needs at most {LONGEST} characters, since a picture has {MAX_PIXELS} "
            f"pixels in a row; got {len(text):,}"
        )
    with failing():
        if file is None:
            ink, default = targets.text(text or "", font), text or ""
        elif number is not None:
            ink, default = targets.mnist(file, number), f"{file.name} {number}"
        else:
            ink, default = targets.png(file), file.stem
        drawn = Pattern.of_ink(ink) if obstacle else target((name or default)[:64], ink)
        print(drawn.model_dump_json())


@data.command()
def mnist(
    folder: Annotated[Path, Argument(help="Folder to write the files to.")] = Path("mnist"),
) -> None:
    """Download and verify the test images and labels of MNIST."""
    with failing("FOLDER must be a folder or a new path"):
        folder.mkdir(parents=True, exist_ok=True)
    with failing():
        for file, digest in MNIST_FILES.items():
            path = place(folder / file)
            # A broken file of an earlier attempt has another digest and is fetched again.
            if path.exists() and _digest(path.read_bytes()) == digest:
                say(f"{path} exists")
                continue
            try:
                answer = httpx.get(MNIST + file, follow_redirects=True, timeout=60)
                answer.raise_for_status()
            # `InvalidURL` is about a proxy of the environment.
            except (httpx.HTTPError, httpx.InvalidURL) as error:
                fail(f"{MNIST + file}: {error}")
            if (found := _digest(answer.content)) != digest:
                fail(f"{file} must have the MD5 digest {digest}, got {found}; nothing is kept")
            write_whole(path, answer.content)
            say(f"{path} is downloaded and verified")


def _digest(content: bytes) -> str:
    # torchvision knows these files by MD5, which systems in FIPS mode refuse for security.
    return md5(content, usedforsecurity=False).hexdigest()
