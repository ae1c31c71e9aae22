"""Every command with something amiss around it: full disks, closed pipes, odd terminals, kills at any moment.

    python tests/campaign/faults.py                  # every command with every fault
    python tests/campaign/faults.py kill --count 300 # kills at random moments; another --seed, other moments
    python tests/campaign/faults.py --only report    # commands whose name begins so

Each fault must end in an answer or in one line and exit status 2, with files whole or untouched, no traceback and no
waiting. What is wrong is printed with command and fault; the exit status is 1 then. Full and read-only file systems
are mounted in a name space of this process alone (``unshare``); where that is not allowed they are left out, and said.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent))
from faults_bench import (
    COMMANDS,
    INPUTS,
    Run,
    complaints,
    ended,
    fresh,
    outputs,
    program,
    references,
    started,
    surroundings,
)  # fmt: skip

Found = dict[str, bytes]


class Fault(NamedTuple):
    """Something amiss: changes of the environment, of the process, and a shell line around the command."""

    env: Mapping[str, str | None] = MappingProxyType({})
    shell: str = ""  # {command} is the command
    limit: tuple[int, int] | None = None  # of the process's resources
    spoil: Callable[[Path], None] | None = None  # what is done to the folder before
    files: bool = False  # concerns only commands that write files


def _limited(size: int) -> tuple[int, int]:
    return (resource.RLIMIT_FSIZE, size)


def _dated(seconds: int) -> Callable[[Path], None]:
    def date(folder: Path) -> None:
        for path in [*folder.iterdir(), folder]:
            os.utime(path, (seconds, seconds))

    return date


MOUNT = "unshare --mount --map-root-user sh -c "
SMALL = "cp -a . ../copy && mount -t tmpfs -o size=40k none . && cd . && cp -a ../copy/. . && "  # some blocks are left
ENVIRONMENTS: dict[str, dict[str, str | None]] = {
    "no HOME": {"HOME": None, "XDG_CACHE_HOME": None},
    "HOME is a file": {"HOME": "/dev/null", "XDG_CACHE_HOME": None, "DRIVESIZER_CACHE": None},
    "cache is a file": {"DRIVESIZER_CACHE": "/dev/null/cache"},
    "cache has no name": {"DRIVESIZER_CACHE": "/" + "x" * 300},
    "no TMPDIR": {"TMPDIR": "/nowhere/at/all"},
    "no TERM": {"TERM": None},
    "TERM dumb": {"TERM": "dumb"},
    "no PATH": {"PATH": ""},
    **{f"COLUMNS {n}": {"COLUMNS": n} for n in ("0", "1", "-5", "abc", "7", "100000")},
    **{f"LC_ALL {n}": {"LC_ALL": n} for n in ("C", "POSIX", "tr_TR.UTF-8", "de_DE.ISO-8859-1", "nonsense")},
    "ASCII alone": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    **{f"PYTHONIOENCODING {n}": {"PYTHONIOENCODING": n} for n in ("ascii", "latin-1", "cp1252", "utf-16")},
    "warnings are errors": {"PYTHONWARNINGS": "error::ResourceWarning"},
    "Python optimised": {"PYTHONOPTIMIZE": "2"},
}
FAULTS: dict[str, Fault] = {
    **{name: Fault(env=env) for name, env in ENVIRONMENTS.items()},
    "stdout closed": Fault(shell="{command} >&-"),
    "stderr closed": Fault(shell="{command} 2>&-"),
    "stdin closed": Fault(shell="{command} <&-"),
    "all closed": Fault(shell="{command} <&- >&- 2>&-"),
    "stdout full": Fault(shell="{command} > /dev/full"),
    "both full": Fault(shell="{command} > /dev/full 2>&1"),
    "reader gone": Fault(shell="{command} | true; exit ${{PIPESTATUS[0]}}"),
    "one line read": Fault(shell="{command} | head -n 1; exit ${{PIPESTATUS[0]}}"),
    "folder removed": Fault(shell="mkdir gone && cd gone && rmdir ../gone && {command}"),
    "no byte may be written": Fault(limit=_limited(0), files=True),
    "1000 bytes may be written": Fault(limit=_limited(1000), files=True),
    "20 files may be open": Fault(limit=(resource.RLIMIT_NOFILE, 20)),
    "files of 1970": Fault(spoil=_dated(0)),
    "files of 2100": Fault(spoil=_dated(4_102_444_800)),
    "disk nearly full": Fault(
        shell=f"{MOUNT}'{SMALL}{{command}}'",
        files=True,
    ),
    "disk read-only": Fault(shell=f"{MOUNT}'mount --bind . . && mount -o remount,bind,ro . && cd . && {{command}}'"),
    "cache read-only": Fault(
        env={"DRIVESIZER_CACHE": "cache"},
        shell=f"{MOUNT}'mkdir cache && mount -t tmpfs -o ro none cache && {{command}}'",
    ),
    "cache full": Fault(
        env={"DRIVESIZER_CACHE": "cache"},
        shell=f"{MOUNT}'mkdir cache && mount -t tmpfs -o size=8k none cache && {{command}}'",
    ),
    "clock of 1970": Fault(shell="faketime -f '@1970-01-02 00:00:00' {command}"),
    "clock of 2100": Fault(shell="faketime -f '@2100-01-01 00:00:00' {command}"),
}  # fmt: skip


def _full_device(path: Path) -> None:
    """A link to a device as /dev/full, of its own: what replaces it by a file must not spoil the machine's."""
    try:
        os.mknod(path.with_name("full"), 0o20666, os.makedev(1, 7))
    except PermissionError:
        path.symlink_to("/dev/full")
    else:
        path.symlink_to("full")


TARGETS: dict[str, Callable[[Path], None]] = {
    "is a folder": lambda path: (path.mkdir(parents=True), (path / "kept").touch())[0],
    "is in a loop of links": lambda path: path.symlink_to(path.name),
    "is a pipe": lambda path: os.mkfifo(path),
    "is a device": lambda path: (os.mknod(path.with_name("full"), 0o20666, os.makedev(1, 7)), path.symlink_to("full"))[
        1
    ],
    "leads nowhere": lambda path: path.symlink_to("nothing/there"),
}


def _an_input_of(command: str) -> Callable[[Path], None]:
    """The first file that a command names, else its default, under the name of its output."""
    first = next((word for word in COMMANDS[command].words.split() if word in INPUTS), "robot.yaml")
    return lambda path: path.hardlink_to(first)


def with_fault(name: str, command: str, folder: Path, cache: Path) -> Run:
    """A command with one fault of ``FAULTS``."""
    fault = FAULTS[name]
    if fault.spoil:
        fault.spoil(folder)
    words = program(command)
    if fault.shell:
        words = ["bash", "-c", fault.shell.format(command=shlex.join(words))]

    def limited() -> None:
        if fault.limit:
            resource.setrlimit(fault.limit[0], (fault.limit[1], fault.limit[1]))

    env = surroundings(cache, **fault.env)
    return ended(started(command, folder, env, words, preexec_fn=limited))


def every_fault(commands: list[str], cache: Path, only: str) -> list[str]:
    """Each command with each fault, and with each odd target; lines about what is wrong."""
    said, whole = [], references(cache, commands)
    usable = {name for name in FAULTS if name.startswith(only)} - _left_out()
    for command in commands:
        for name in [name for name in FAULTS if name in usable]:
            if FAULTS[name].files and not COMMANDS[command].outputs:
                continue
            with fresh() as folder:
                run = with_fault(name, command, folder, cache)
                files = {} if "disk" in name or "folder removed" in name else whole[command][1]
                said += _said(command, name, complaints(command, run, folder, files, {}), run)
        for name, make in {**TARGETS, "is an input": _an_input_of(command)}.items():
            if COMMANDS[command].outputs and name.startswith(only):
                said += _odd_target(command, name, make, cache)
    return said


def _odd_target(command: str, name: str, make: Callable[[Path], None], cache: Path) -> list[str]:
    """A command whose file, the first, is no place for one: refused, and nothing is written."""
    with fresh() as folder:
        target = folder / COMMANDS[command].outputs[0]
        target.parent.mkdir(exist_ok=True)
        os.chdir(folder)
        make(target)
        run = ended(started(command, folder, surroundings(cache)))
        os.chdir("/")
        wrong = complaints(command, run, folder, {}, outputs(command, folder), lambda status: status == 2)
        return _said(command, f"its file {name}", wrong, run)


def _left_out() -> set[str]:
    """Faults that this machine cannot make."""
    mounts = subprocess.run(["unshare", "--mount", "--map-root-user", "true"], check=False).returncode == 0
    out = {n for n, f in FAULTS.items() if MOUNT in f.shell and not mounts}
    out |= {n for n, f in FAULTS.items() if "faketime" in f.shell and not shutil.which("faketime")}
    if out:
        print(f"left out, this machine cannot make them: {', '.join(sorted(out))}")
    return out


def _said(command: str, fault: str, wrong: list[str], run: Run) -> list[str]:
    lines = [f"{command}, {fault}: {one}" for one in wrong]
    for line in lines:
        print(f"{line} | {run.err.decode('utf-8', 'replace')[-300:]!r}", flush=True)
    return lines


# --- kills, and two at once -------------------------------------------------------------------------------------------


def kills(commands: list[str], cache: Path, count: int, seed: int) -> list[str]:
    """Signals at random moments, a third of them in the first 0.15 s; then the same command once more."""
    chance, said = random.Random(seed), []
    whole, lasts = references(cache, commands), {}
    for number in range(count):
        command = commands[number % len(commands)]
        if command not in lasts:
            with fresh() as folder:
                start = time.monotonic()
                ended(started(command, folder, surroundings(cache)))
                lasts[command] = time.monotonic() - start
        sent = chance.choice((signal.SIGINT, signal.SIGINT, signal.SIGTERM, signal.SIGKILL))
        wait = chance.uniform(0.0, 0.15 if chance.random() < 0.33 else 1.1 * lasts[command])
        with fresh() as folder:
            process = started(command, folder, surroundings(cache))
            time.sleep(wait)
            os.killpg(process.pid, sent)
            run = ended(process, 20.0)
            said += _after_kill(command, sent, wait, run, folder, whole[command][1])
            if "new.yaml" in COMMANDS[command].outputs:  # is never replaced
                (folder / "new.yaml").unlink(missing_ok=True)
            again = ended(started(command, folder, surroundings(cache)))
            if (again.out, outputs(command, folder)) != (whole[command][0].out, whole[command][1]):
                said += _said(command, f"{sent.name} after {wait:.3f} s", ["the next run differs"], again)
    return said


def _after_kill(command: str, sent: signal.Signals, wait: float, run: Run, folder: Path, whole: Found) -> list[str]:
    """What is wrong after a signal; a killed process may leave its temporary file, which the others must not."""
    may = {0, 1, -sent, 130 if sent == signal.SIGINT else 128 + sent}
    wrong = complaints(command, run, folder, whole, {}, lambda status: status in may)
    if run.status not in (0, 1) or sent == signal.SIGKILL:
        wrong = [line for line in wrong if "missing" not in line]
    if sent == signal.SIGKILL:
        wrong = [line for line in wrong if not line.startswith("leaves")]
    if b"Fatal Python error: init" in run.err or (b"Traceback" in run.err and b"drivesizer" not in run.err):
        wrong = []  # Python itself had not started: no program can be quiet there
    return _said(command, f"{sent.name} after {wait:.3f} s", wrong, run)


def at_once(commands: list[str], cache: Path) -> list[str]:
    """Each command by two processes that share a cache, empty at first, and the file that is written."""
    said, whole = [], references(cache, commands)
    for command in commands:
        for shared in (cache, Path(tempfile.mkdtemp(prefix="faults-cache-"))):
            with fresh() as folder:
                both = [started(command, folder, surroundings(shared)) for _ in range(2)]
                for run in [ended(one, 300.0) for one in both]:  # one may be refused: the other's file is whole
                    wrong = complaints(command, run, folder, whole[command][1], {})
                    said += _said(command, f"two at once, {'warm' if shared == cache else 'cold'}", wrong, run)
    return said


def main() -> int:
    """What the words of the command line say; 1 where something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", default="all", choices=("all", "fault", "kill", "two"))
    parser.add_argument("--only", default="", help="commands whose name begins so")
    parser.add_argument("--fault", default="", help="faults whose name begins so")
    parser.add_argument("--count", type=int, default=100, help="kills")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it, and so would all
    commands = [name for name in COMMANDS if name.startswith(given.only)]
    cache = Path(tempfile.mkdtemp(prefix="faults-cache-"))
    said = []
    if given.what in ("all", "fault"):
        said += every_fault(commands, cache, given.fault)
    if given.what in ("all", "kill"):
        said += kills([name for name in commands if name not in ("help", "doctor")], cache, given.count, given.seed)
    if given.what in ("all", "two"):
        said += at_once(commands, cache)
    shutil.rmtree(cache, ignore_errors=True)
    print(f"{len(said)} wrong")
    return bool(said)


if __name__ == "__main__":
    sys.exit(main())
