"""What all tests share: a cache folder of their own, the example, its sizing and the shipped catalogue."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: workers fill the cores, more threads only wait

import gc
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from specs import estimates_off

from drivesizer import catalog as catalogues
from drivesizer import cli
from drivesizer.catalog import Catalog, load
from drivesizer.files.cache import digest_of
from drivesizer.files.machine_code import translate_all
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, load_spec

ROOT = Path(__file__).resolve().parent.parent


CACHE = ROOT / ".pytest_cache" / "compiled"

# how long an example takes says how busy the machine is; other examples at every run, so that fewer of them do
settings.register_profile("suite", deadline=None, max_examples=60)
settings.load_profile("suite")


def pytest_configure(config: pytest.Config) -> None:
    """Point compiled catalogues to a folder of the tests, kept between runs, and translate what has changed.

    A hook and not a fixture, because the doctests in the package load catalogues too. Parallel workers inherit the
    folder of the process that started them.
    """
    gc.set_threshold(50_000, 20, 50)  # what is imported and collected stays: to look through it is a sixth of the time
    if hasattr(config, "workerinput"):
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it, with all it starts
    os.environ["DRIVESIZER_CACHE"] = str(CACHE)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # else each command that a test starts compiles it all
    _drop_outdated()
    translate_all()


def pytest_collection(session: pytest.Session) -> None:
    """Keep all catalogues in memory, which tests load by turns, not the last few."""
    catalogues._REMEMBERED = 256


def pytest_collection_finish() -> None:
    """Leave what is imported by now out of garbage collections: 7 % of the time of two files of tests."""
    gc.collect()
    gc.freeze()


def _drop_outdated() -> None:
    """Remove what other sources of the package made: the name of a compiled catalogue has its version in it.

    Edits change no version.
    """
    package = ROOT / "drivesizer"
    sources = sorted(path for path in package.rglob("*.*") if "__pycache__" not in path.parts)
    digest = digest_of(*(path.read_bytes() for path in sources))
    stamp = CACHE / "sources.txt"
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != digest:
        CACHE.mkdir(parents=True, exist_ok=True)
        for old in (path for path in CACHE.iterdir() if path.is_file()):
            old.unlink(missing_ok=True)
        stamp.write_text(digest, encoding="utf-8")


@pytest.fixture(scope="session")
def example() -> Path:
    """The spec file of the SPS robot."""
    return ROOT / "examples" / "sps_robot.yaml"


@pytest.fixture(scope="session")
def spec(example: Path) -> RobotSpec:
    """The SPS robot by what its data sheets give alone: textbooks and other programs know of no estimates."""
    return estimates_off(load_spec(example))


@pytest.fixture(scope="session")
def catalog() -> Catalog:
    """The shipped maxon catalogue."""
    return load(["maxon"])


@pytest.fixture(scope="session")
def sized() -> SizingResult:
    """The sizing of the SPS robot; frozen records, so that all tests of a process share it."""
    return size(estimates_off(load_spec(ROOT / "examples" / "sps_robot.yaml")))


@pytest.fixture(scope="session")
def result(sized: SizingResult) -> SizingResult:
    """The same, where a module has no result of its own."""
    return sized


@pytest.fixture(scope="module")
def no_further_searches(sized: SizingResult) -> Iterator[None]:
    """Sizing without its further searches: what would have to change (sixty), and the whole catalogue's best drive.

    For modules that read neither. The shared sizing is made before, with both.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("drivesizer.sizing.relaxations", lambda *_: ())
        patch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
        patch.setattr("drivesizer.sizing._unrestricted", lambda *_: None)
        yield


@pytest.fixture(scope="session")
def example_text(example: Path) -> str:
    """The SPS robot's spec as text, to be changed by a test."""
    return example.read_text(encoding="utf-8")


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[Any, str, str]]:
    """A function that runs the program as a user would: exit status, stdout and stderr."""

    def call(*words: object) -> tuple[Any, str, str]:
        monkeypatch.setattr(sys, "argv", ["drivesizer", *map(str, words)])
        with pytest.raises(SystemExit) as end:
            cli.main()
        told = capsys.readouterr()
        return end.value.code, told.out, told.err

    return call


@pytest.fixture
def canvas() -> Callable[..., Any]:
    """What a figure's function draws, as a matplotlib figure."""

    def of(function: Callable[..., Any], *given: Any) -> Any:
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        from drivesizer.output.report.figures.style import house_style

        with matplotlib.rc_context(house_style()):
            figure = Figure(figsize=(6.5, 6.5))
            FigureCanvasAgg(figure)
            function(*given).draw(figure)
        return figure

    return of
