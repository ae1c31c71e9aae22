"""What the command line keeps from being loaded, and that whoever asks for it gets it."""

from __future__ import annotations

import subprocess
import sys

import pytest

START = """
import sys
from drivesizer.cli import main

sys.argv = ["drivesizer", "--version"]
try:
    main()
except SystemExit:
    pass
assert "email" not in sys.modules
"""
ASKED = [
    "from importlib.metadata import version; print(version('numpy'))",
    "from importlib import metadata; print(metadata.version('numpy'))",
    "import importlib.metadata; print(importlib.metadata.version('numpy'))",
    "import importlib.metadata as records; print(records.version('numpy'), records.__name__)",
    "from importlib.metadata import entry_points; print(len(entry_points(group='pydantic')) >= 0)",
    "from importlib.metadata import entry_points, version; entry_points(); print(version('numpy'))",
]


@pytest.mark.parametrize("asked", ASKED)
def test_records_of_packages_are_there_when_they_are_asked_for(asked):
    plain = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    later = subprocess.run([sys.executable, "-c", START + asked], capture_output=True, text=True, check=True)
    assert later.stdout.split("\n")[1:] == plain.stdout.split("\n")
