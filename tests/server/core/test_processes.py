"""Child processes end with their parent, in time, and with all that they started."""

import os
import subprocess
import sys

import psutil
import pytest

from microcosmos_server.core import processes

PARENT = """
import os, time
from microcosmos_server.core import processes
child = "import time; from microcosmos_server.core import processes; "
child += "processes.end_with_parent(); print('bound', flush=True); time.sleep(60)"
started = processes.start(processes.python("x")[:1] + ["-c", child], os.environ)
print(started.pid, flush=True)
time.sleep(60)
"""


def ended(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def test_a_child_that_binds_itself_ends_with_a_parent_that_was_killed():
    command = [sys.executable, "-c", PARENT]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout
        lines = {parent.stdout.readline().strip() for _ in range(2)}
        (pid,) = lines - {"bound"}
        child = psutil.Process(int(pid))
        parent.kill()
    child.wait(timeout=5)


def test_its_own_children_do_not_take_the_parent_for_theirs():
    code = "import os; from microcosmos_server.core import processes\n"
    code += "processes.end_with_parent(); print(processes.PARENT in os.environ)"
    done = processes.run([sys.executable, "-c", code], os.environ)
    assert (done.code, done.output) == (0, b"False\n")


def test_output_errors_and_status_come_back():
    code = "import sys; print(1); sys.exit('wrong')"
    done = processes.run([sys.executable, "-c", code], os.environ)
    assert done == (1, b"1\n", b"wrong\n")


@pytest.mark.parametrize("error", [processes.TooLateError, processes.StoppedError])
def test_an_ended_process_takes_those_with_it_that_it_started(tmp_path, eventually, error):
    numbers = tmp_path / "numbers"
    script = f"sleep 60 & echo $! > {numbers}; wait"
    late = error is processes.TooLateError
    limits = (
        {"seconds": 1.0}
        if late
        else {"stop_requested": lambda: numbers.exists() and bool(numbers.read_text())}
    )
    with pytest.raises(error):
        processes.run(["sh", "-c", script], os.environ, **limits)
    eventually(lambda: ended(int(numbers.read_text())))
