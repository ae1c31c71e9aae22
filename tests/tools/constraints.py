"""Exact versions of all that drivesizer, its extras and its developers' tools install, as constraints for pip.

    .venv/bin/python tests/tools/constraints.py > constraints.txt     # or: make constraints

Begins at pyproject.toml and follows what each installed package requires on this Python and system; pip and setuptools
come with Python. ``make CONSTRAINTS=constraints.txt test`` installs these versions.
"""

from __future__ import annotations

import platform
import tomllib
from collections.abc import Iterable
from importlib.metadata import distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

__all__ = ["declared", "pinned", "text"]

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def declared() -> dict[str, list[Requirement]]:
    """Requirements of pyproject.toml by extra; under the empty name those that are always installed."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    groups = {"": project["dependencies"]} | project["optional-dependencies"]
    return {extra: [Requirement(line) for line in lines] for extra, lines in groups.items()}


def pinned(requirements: Iterable[Requirement]) -> dict[str, str]:
    """Installed version of each package that the requirements bring, by its canonical name."""
    versions: dict[str, str] = {}
    seen, left = set(), [(one, "") for one in requirements]
    while left:
        one, of_extra = left.pop()
        if one.marker and not one.marker.evaluate({"extra": of_extra}):
            continue
        name = canonicalize_name(one.name)
        for extra in {"", *one.extras} - {extra for known, extra in seen if known == name}:
            seen.add((name, extra))
            found = distribution(name)
            versions[name] = found.version
            left += [(Requirement(line), extra) for line in found.requires or ()]
    return versions


def text() -> str:
    """The file: a package a line, by name."""
    versions = pinned(one for group in declared().values() for one in group)
    head = (
        "# Versions of an environment of developers: make constraints writes them, "
        "make CONSTRAINTS=constraints.txt test\n"
        f"# installs them. Python {platform.python_version()}, {platform.system()}: another one may need others.\n"
    )
    return head + "".join(f"{name}=={versions[name]}\n" for name in sorted(versions))


if __name__ == "__main__":
    print(text(), end="")
