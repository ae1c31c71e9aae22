"""Lowest versions that pyproject.toml allows of what drivesizer and its extras need, as constraints for pip.

    python tests/tools/lowest.py > lowest.txt
    make CONSTRAINTS=lowest.txt test

What those packages bring in turn, and the tools of developers, stay at the newest that fits. Where the tools need a
higher version of a package than drivesizer itself, theirs counts: pip would not install both.
"""

from __future__ import annotations

import sys
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

sys.path.insert(0, str(Path(__file__).parent))
from constraints import declared

__all__ = ["lowest", "text"]


def lowest() -> dict[str, Version]:
    """Lower bound of each package that drivesizer or one of its extras names, by its canonical name."""
    groups = declared()
    tools = {canonicalize_name(one.name): bound(one) for one in groups.pop("dev")}
    needed = {canonicalize_name(one.name): bound(one) for group in groups.values() for one in group}
    return {name: max(version, tools.get(name, version)) for name, version in needed.items()}


def bound(one: Requirement) -> Version:
    """Version behind the ``>=`` of a requirement."""
    return next(Version(part.version) for part in one.specifier if part.operator == ">=")


def text() -> str:
    """The file: a package a line, by name."""
    return "".join(f"{name}=={version}\n" for name, version in sorted(lowest().items()))


if __name__ == "__main__":
    print(text(), end="")
