import os
import signal
import subprocess
import sys
import time

import pytest

from slmm.running.processes import processes

SCRIPT = """
import os, time
from slmm.running.processes import processes
if __name__ == "__main__":
    with processes(2) as pool:
        started = [pool.submit(os.getpid) for _ in range(20)]
        print(*{future.result() for future in started}, flush=True)
        [pool.submit(time.sleep, 100) for _ in range(2)]
        time.sleep(100)
"""


def is_running(pid):
    try:
        with open(f"/proc/{pid}/stat") as stream:
            return stream.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


@pytest.mark.slow
@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="looks for processes in /proc")
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT])
def test_they_end_with_the_one_that_started_them(end):
    with subprocess.Popen(
        [sys.executable, "-c", SCRIPT], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        workers = [int(pid) for pid in process.stdout.readline().split()]
        assert workers and all(map(is_running, workers))
        process.send_signal(end)
        deadline = time.monotonic() + 20
        while any(map(is_running, workers)) and time.monotonic() < deadline:
            time.sleep(0.02)
        assert not any(map(is_running, workers))


@pytest.mark.slow
def test_an_exception_does_not_wait_for_what_is_under_way():
    begin = time.monotonic()
    with pytest.raises(ZeroDivisionError), processes(1) as pool:
        pool.submit(os.getpid).result()
        pool.submit(time.sleep, 100)
        raise ZeroDivisionError
    assert time.monotonic() - begin < 50
