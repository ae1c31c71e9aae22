"""What all tests share: a cache folder of their own, the example spec and the shipped catalogue."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

import pytest

from drivesizer.catalog import Catalog, load
from drivesizer.spec import RobotSpec, load_spec

ROOT = Path(__file__).resolve().parent.parent


def pytest_configure(config: pytest.Config) -> None:
    """Point the compiled catalogues to a folder of this run.

    A hook and not a fixture, because the doctests in the package load catalogues too. Parallel workers inherit the
    folder of the process that started them.
    """
    if not hasattr(config, "workerinput"):
        folder = tempfile.mkdtemp(prefix="drivesizer-tests-")
        os.environ["DRIVESIZER_CACHE"] = folder
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
