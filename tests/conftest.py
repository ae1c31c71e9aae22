"""What all tests share: a cache folder of their own, the example spec and the shipped catalogue."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from drivesizer.catalog import Catalog, load
from drivesizer.spec.robot import RobotSpec, load_spec

ROOT = Path(__file__).resolve().parent.parent


def pytest_configure(config: pytest.Config) -> None:
    """Point the compiled catalogues to a folder of this run.

    A hook and not a fixture, because the doctests in the package load catalogues too. Parallel workers inherit the
    folder of the process that started them.
    """
    if not hasattr(config, "workerinput"):
        folder = tempfile.mkdtemp(prefix="drivesizer-tests-")
        os.environ["DRIVESIZER_CACHE"] = folder
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # else each command that a test starts compiles it all
        config.add_cleanup(lambda: shutil.rmtree(folder, ignore_errors=True))


@pytest.fixture(scope="session")
def example() -> Path:
    """The spec file of the SPS robot."""
    return ROOT / "examples" / "sps_robot.yaml"


@pytest.fixture(scope="session")
def spec(example: Path) -> RobotSpec:
    """The SPS robot."""
    return load_spec(example)


@pytest.fixture(scope="session")
def catalog() -> Catalog:
    """The shipped maxon catalogue."""
    return load(["maxon"])


@pytest.fixture(scope="session")
def example_text(example: Path) -> str:
    """The SPS robot's spec as text, to be changed by a test."""
    return example.read_text(encoding="utf-8")


@pytest.fixture
def canvas(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    """What a function of a module draws, as a matplotlib figure."""

    def of(module: Any, function: Callable[..., Any], *given: Any) -> Any:
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        from drivesizer.output.report.figures.style import STYLE

        kept: list[Any] = []
        with monkeypatch.context() as patch:
            patch.setattr(module, "drawn", lambda draw, height, form: kept.append((draw, height)))
            function(*given)
        with matplotlib.rc_context(STYLE):
            figure = Figure(figsize=(6.5, kept[0][1]))
            FigureCanvasAgg(figure)
            kept[0][0](figure)
        return figure

    return of
