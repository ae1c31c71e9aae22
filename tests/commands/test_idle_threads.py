"""Threads of the linear algebra that wait for work."""

import os
import subprocess
import sys

import pytest

OTHERS = """
import resource, time
from pathlib import Path
from drivesizer.commands.idle_threads import let_idle_threads_sleep
{call}
import numpy as np
time.sleep(0.2)
whole, own = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_THREAD))
print(len(list(Path("/proc/self/task").iterdir())), whole.ru_utime + whole.ru_stime - own.ru_utime - own.ru_stime)
"""


def _others(call: str) -> tuple[int, float]:
    """Number of threads, and processor time of all but the first [s]."""
    limits = ("THREADS", "TIMEOUT")
    own = {name: value for name, value in os.environ.items() if not name.endswith(limits)}
    words = [sys.executable, "-c", OTHERS.format(call=call)]
    count, taken = subprocess.run(words, env=own, capture_output=True, text=True, check=True).stdout.split()
    return int(count), float(taken)


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted in /proc")
def test_threads_without_work_sleep():
    """They took 30 ms of each command's processor time."""
    threads, waiting = _others("pass")
    if threads == 1:
        pytest.skip("NumPy starts no threads here")
    count, asleep = _others("let_idle_threads_sleep()")
    assert count == threads  # which are as many as before
    assert 4.0 * asleep < waiting


def test_what_the_environment_says_of_threads_is_left(monkeypatch):
    from drivesizer.commands.idle_threads import let_idle_threads_sleep

    monkeypatch.setenv("OPENBLAS_THREAD_TIMEOUT", "20")
    let_idle_threads_sleep()
    assert os.environ["OPENBLAS_THREAD_TIMEOUT"] == "20"
