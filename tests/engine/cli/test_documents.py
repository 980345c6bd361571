"""The commands and the Python of the documentation run, at a small size.

A block is carried out line by line in a folder with the files that it names. Presets run with
the settings of `SMALLER`. `ELSEWHERE` names what cannot run here, and the reason.
"""

import json
import re
import shlex
import shutil
from fnmatch import fnmatchcase
from pathlib import Path

import h5py
import matplotlib as mpl
import numpy as np
import pytest
import yaml
from PIL import Image
from small_spec import SMALL_RUN

import microcosmos as mc
from microcosmos.archive import file

ROOT = Path(__file__).parents[3]
DOCUMENTS = {
    path.name: path
    for path in [*sorted((ROOT / "docs").glob("*.md")), ROOT / "CONTRIBUTING.md"]
}
BLOCK = re.compile(r"^( *)```(sh|bash|python)\n(.*?)^\1```$", re.MULTILINE | re.DOTALL)

TINY = (
    *("search.generations=1", "search.batch=8", "search.block=8"),
    *("task.steps=20", "control.period=10"),
)
DIGIT = ("updates=1", "steps=10", 'targets=[{"digit": 1}]', "body.nodes=60", "size=20")
SMALLER = {
    **dict.fromkeys(("demo", "standard", "zoo", "paper", "spec.json"), TINY),
    **dict.fromkeys(("neuroevolution/demo", "neuroevolution/paper"), TINY),
    "neuroevolution/paper-energy": TINY,
    **dict.fromkeys((f"folding/{name}" for name in ("demo", "digits", "paper")), DIGIT),
    "folding/digits-fluid": DIGIT,
    **dict.fromkeys(
        ("gaits/demo", "gaits/paper"),
        (
            *('swimmers=["ray"]', 'forms=["ours"]', "viscosities=[0.5, 1.0]"),
            *("period=30", "cycles=1"),
        ),
    ),
    **dict.fromkeys(
        ("scaling/demo", "scaling/paper"),
        ("nodes=[40, 80]", "filament=20", "all_pairs=40", "width=32", "height=32", "steps=2"),
    ),
}
"""Settings with which a preset takes seconds."""

THICK = {"world": {"viscosity": 0.2}}
SCREENED = {"search": {"screening": {}}}
FILES = {
    **{f"{name}.h5": ({}, 0) for name in ("run", "runs/0")},
    "runs/1.h5": (THICK, 0),
    **{f"{name}.h5": (THICK, seed) for seed, name in enumerate("abcde")},
    **{f"seed{seed}.h5": ({}, seed) for seed in range(3)},
    **{f"thin/{seed}.h5": ({}, seed) for seed in range(2)},
    **{f"thick/{seed}.h5": (THICK, seed) for seed in range(2)},
    **{f"runs/thin/{seed}.h5": ({}, seed) for seed in range(2)},
    **{f"runs/thick/{seed}.h5": (THICK, seed) for seed in range(2)},
    "runs/plain/0.h5": ({}, 0),
    "runs/plain/1.h5": (THICK, 0),
    "runs/screened/0.h5": (SCREENED, 0),
    "runs/screened/1.h5": (SCREENED | THICK, 0),
}
"""Archive files of the documents: how specs differ from that of a small run, and seeds."""

STATUS = {"audit": 1}
"""Exit statuses: twenty steps of a random creature are no swimming that an audit trusts."""

SERVER = "needs a server: tests/server/client and tests/e2e/test_client.py have one"
MACHINE = "changes or needs this machine"
ELSEWHERE = {
    **dict.fromkeys(("curl *", '"*'), SERVER),
    "id=*": SERVER,
    **dict.fromkeys((f"microcosmos {name} *" for name in ("submit", "watch", "sweep")), SERVER),
    "microcosmos share *": SERVER,
    "microcosmos reproject *": SERVER,
    "microcosmos choices *": SERVER,
    "microcosmos compare *7c1e*": SERVER,
    "microcosmos export 3f2a91c0 *": SERVER,
    "microcosmos study * --server": SERVER,
    "microcosmos evolve https://*": SERVER,
    "microcosmos evolve * --choices *": "needs choices of people: tests/engine/cli/test_cli.py",
    "microcosmos units demo.best.json *": "tiny creatures do no two strokes: cli/test_files.py",
    "microcosmos cluster *": "tests/faults/test_cluster.py starts a cluster",
    "microcosmos evolve * --cluster *": "tests/faults/test_cluster.py starts a cluster",
    "microcosmos evolve * mlflow:*": "tests/engine/sinks/test_mlflow_server.py starts MLflow",
    "microcosmos data mnist": "fetches from another site",
    "microcosmos picture mnist/*": "needs that file: tests/engine/spec/targets has one like it",
    **dict.fromkeys(("make *", "MICROCOSMOS_SINKS=* make run", "git *", "cd *"), MACHINE),
    **dict.fromkeys(("pip *", "ssh *", "docker *", "cp *", "useradd *"), MACHINE),
    **dict.fromkeys(("systemctl *", "createuser *", "createdb *", "export *"), MACHINE),
    "python -m microcosmos_server.auth *": "tests/server/auth/test_tokens.py runs it",
    ".venv/bin/python -m microcosmos_server.maintenance *": "tests/server/maintenance runs it",
}
"""Lines that are not run here, by pattern, with the reason."""

NOT_HERE = {
    "client.md": "tests/e2e/test_client.py runs it against a server",
    "evolution.md": SERVER,
}
"""Documents whose Python is not run here."""
FROM_A_SERVER = re.compile(
    r"^(run = mc\.Client|run\.|header, arrays|mc\.Player\(run).*\n", re.M
)
STEPS = ("steps=20", "steps=2")
"""Gradient steps, and how many are taken here."""
SPEC = re.compile(r'\{"experiment": "quality-diversity", "search": \{"generations": \d+\}\}')
LEARNED = {"archive": {"container": {"kind": "learned", "measures": []}}}


def blocks(document, *languages):
    found = BLOCK.findall(DOCUMENTS[document].read_text())
    return [text for _, language, text in found if language in languages]


def commands(document):
    """Return the commands of a document, without comments, one for each line and `&&`."""
    for block in blocks(document, "sh", "bash"):
        for line in block.replace("\\\n", " ").splitlines():
            words = " ".join(line.split(" #")[0].split())
            yield from (part for part in words.split(" && ") if part and part[0] != "#")


def reason_elsewhere(command):
    return next((why for one, why in ELSEWHERE.items() if fnmatchcase(command, one)), None)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A small run with its best creature beside it, and one along learned axes."""
    path = tmp_path_factory.mktemp("run") / "small.h5"
    mc.evolve(mc.parse(SMALL_RUN), path)
    mc.evolve(mc.parse(SMALL_RUN | LEARNED), path.with_name("learned.h5"))
    return path


def varied(run, changes, seed):
    """Return the file of a run as if it had another spec and seed, and other scores."""
    tree, attributes = file.load(run.read_bytes())
    document = json.loads(attributes["spec"]) | {"seed": seed}
    for part, fields in changes.items():
        document[part] |= fields
    tree["curves"]["qd_score"] = tree["curves"]["qd_score"] * (1 + seed + len(changes))
    spec = mc.parse(document).model_dump_json()
    return file.dump(tree, attributes | {"spec": spec})


@pytest.fixture
def folder(tmp_path, run, monkeypatch):
    """A folder with the files that the documents name."""
    monkeypatch.chdir(tmp_path)
    for name, given in FILES.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_bytes(varied(run, *given))
    shutil.copy(run.with_name("learned.h5"), "archive.h5")
    for name in ("creature", "archive.best"):
        shutil.copy(run.with_suffix(".best.json"), f"{name}.json")
    Path("creature.poses").write_bytes(mc.pose_streams(run)[0].encode())
    Path("spec.json").write_text(json.dumps(SMALL_RUN))
    study = yaml.safe_load((ROOT / "examples" / "studies" / "viscosity.yaml").read_text())
    sweep = study["sweeps"]["viscosity"] | {"spec": SMALL_RUN, "seeds": 2}
    study["sweeps"]["viscosity"] = sweep | {"set": {"search.generations": 2}}
    for name in ("viscosity.yaml", "study.yaml"):
        Path(name).write_text(yaml.safe_dump(study | {"resamples": 99}))
    Image.fromarray(np.full((20, 20), 255, np.uint8) * np.eye(20, dtype=np.uint8)).save(
        "logo.png"
    )
    shutil.copy(Path(mpl.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", "Some.ttf")
    return tmp_path


def matching(word):
    """Return what a shell makes of a word."""
    return sorted(map(str, Path().glob(word))) if "*" in word else [word]


def arguments(command):
    """Return the words of a command, at a small size."""
    words = [part for word in shlex.split(command)[1:] for part in matching(word)]
    if words[0] == "evolve":
        words += [word for one in SMALLER[words[1]] for word in ("--set", one)]
    if "--cell" in words:
        with h5py.File("run.h5") as archive:
            words[words.index("--cell") + 1] = str(archive["archive/cell"][0])
    return words


WITH_COMMANDS = [
    name for name in DOCUMENTS if any(not reason_elsewhere(c) for c in commands(name))
]
WITH_PYTHON = [name for name in DOCUMENTS if blocks(name, "python")]


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("document", WITH_COMMANDS)
def test_the_commands_of_a_document_run(document, folder, invoke):
    carried_out = [one for one in commands(document) if not reason_elsewhere(one)]
    first = next((one for one in carried_out if " demo" in one), "evolve demo")
    if "evolve demo" not in first:
        invoke(*arguments("microcosmos evolve demo"))
    for command in carried_out:
        words = arguments(command)
        invoke(*words, code=STATUS.get(words[0], 0))


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("document", [name for name in WITH_PYTHON if name not in NOT_HERE])
def test_the_python_of_a_document_runs(document, folder, invoke):
    found = blocks(document, "python")
    for preset in ("demo", "gaits/demo"):
        if f'"{preset.replace("/", "-")}.' in "".join(found):
            invoke(*arguments(f"microcosmos evolve {preset}"))
    mc.to_xarray("run.h5").to_netcdf("archive.nc", engine="h5netcdf")
    names = {"json": json, "np": np, "Path": Path, "mc": mc, "display": print}
    for block in found:
        text = SPEC.sub(repr(SMALL_RUN), block.replace(*STEPS))
        exec(FROM_A_SERVER.sub("", text), names)


@pytest.mark.parametrize("document", DOCUMENTS)
def test_a_command_that_is_not_run_has_a_reason(document):
    assert all(
        command.startswith("microcosmos ") or reason_elsewhere(command)
        for command in commands(document)
    )


def test_each_reason_is_one_of_a_command():
    found = [command for name in DOCUMENTS for command in commands(name)]
    assert [one for one in ELSEWHERE if not any(fnmatchcase(c, one) for c in found)] == []
    assert set(NOT_HERE) <= set(WITH_PYTHON)
