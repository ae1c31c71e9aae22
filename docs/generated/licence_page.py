"""Licences of the packages that drivesizer needs, as the installed packages state them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

__all__ = ["groups", "licence", "licences"]

_PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"
_EXTRA = "Extra `{}`, on request"
_TITLES = {"": "Always installed", "dev": "Tools of developers"}
_HOME = ("homepage", "home", "source", "source code", "repository", "github", "documentation")  # first that is there
_LONGEST = 40  # letters of a licence's name; a longer field is its whole text


def licences() -> str:
    """A table for each group of packages: version, licence and home page."""
    return "\n\n".join(_table(title, names) for title, names in groups().items())


def groups() -> dict[str, list[str]]:
    """Names of the direct dependencies, each in the first group that has it."""
    project = tomllib.loads(_PROJECT.read_text(encoding="utf-8"))["project"]
    found: dict[str, list[str]] = {}
    known: set[str] = set()
    for extra, lines in ({"": project["dependencies"]} | project["optional-dependencies"]).items():
        names = {Requirement(line).name for line in lines} - known
        found[_TITLES.get(extra, _EXTRA.format(extra))] = sorted(names, key=str.lower)
        known |= names
    return found


def _table(title: str, names: Iterable[str]) -> str:
    rows = [f"| {name} | {(of := distribution(name)).version} | {licence(of)} | <{_home(of)}> |" for name in names]
    return "\n".join([f"### {title}", "", "| package | version | licence | home page |", "|---|---|---|---|", *rows])


def licence(of: Distribution) -> str:
    """The licence of a package: its expression, else its name, else its classifiers, else a line of its file."""
    expression, name = (str(of.metadata.get(key) or "") for key in ("License-Expression", "License"))
    classified = (line.split(" :: ")[-1] for line in of.metadata.get_all("Classifier") or () if line[:7] == "License")
    short = name if len(name) <= _LONGEST and name != "UNKNOWN" else ""
    return expression or short or ", ".join(classified) or _of_its_file(of)


def _of_its_file(of: Distribution) -> str:
    for path in of.files or ():
        if re.match(r"licen[cs]e", path.name, re.IGNORECASE) and (
            line := re.search(r"[^\n]*\blicense\b", path.read_text(encoding="utf-8"), re.IGNORECASE)
        ):
            return line[0].strip()
    return "not stated"


def _home(of: Distribution) -> str:
    links = [line.split(", ", 1) for line in of.metadata.get_all("Project-URL") or ()]
    by_label = {label.lower(): link for label, link in links}
    found = of.metadata.get("Home-page") or next((by_label[label] for label in _HOME if label in by_label), "")
    return found or f"https://pypi.org/project/{of.metadata['Name']}/"
