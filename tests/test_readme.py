"""The README's example runs, and its links exist."""

import os
import re
import subprocess
import sys
from pathlib import Path

from drive import QUICK

README = Path(__file__).parents[1] / "README.md"
SMALL = """"experiment": "quality-diversity",
    "world": {"width": 32, "height": 32}, "body": {"nodes": 12}, "task": {"steps": 400},
    "search": {"generations": 2, "batch": 16}"""


def test_the_library_example_runs_and_its_check_is_exact():
    examples = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    (example,) = examples
    spec = '"experiment": "quality-diversity", "search": {"generations": 10}'
    assert spec in example
    command = [sys.executable, "-c", example.replace(spec, SMALL)]
    quick = os.environ | QUICK
    done = subprocess.run(command, env=quick, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "True"


def test_the_pictures_and_documents_that_are_linked_are_there():
    links = re.findall(r'\]\(([^)#]+)\)|src(?:set)?="([^"]+)"', README.read_text())
    links = [link or picture for link, picture in links]
    assert links
    assert [link for link in links if not (README.parent / link).exists()] == []
