"""Docstrings: a noun phrase or an imperative first; parameters and results of public functions."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import drivesizer

PACKAGE = Path(drivesizer.__file__).parent
ROOMS = sorted(p.name for p in PACKAGE.iterdir() if (p.is_dir() and p.name != "__pycache__") or p.suffix == ".py")
WORDY = re.compile(r"(What|How|Which|Where|When|Why|That|As)\b")
FORMULAS = ("equations.py", "errors.py", "loads", "physics", "platform/equations.py")  # each public function
MANUAL = "\n".join(path.read_text(encoding="utf-8") for path in (PACKAGE.parent / "docs").rglob("*.md"))
IN_MANUAL = set(re.findall(r"^::: (drivesizer[\w.]+)", MANUAL, re.MULTILINE))


def lacking(path: Path) -> list[str]:
    """Printed formulas and functions of the manual without Parameters, or Returns where they return something."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    place = path.relative_to(PACKAGE)
    module = ".".join(("drivesizer", *place.with_suffix("").parts)).removesuffix(".__init__")
    named = {name.rpartition(".")[2] for name in IN_MANUAL if name.rpartition(".")[0] == module}
    found, formulas = [], place.as_posix().startswith(FORMULAS)
    for function in tree.body:
        if not isinstance(function, ast.FunctionDef):
            continue
        if function.name not in named and (not formulas or function.name.startswith("_")):
            continue
        arguments = function.args
        if len([*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]) < 2:
            continue
        returns = not (isinstance(function.returns, ast.Constant) and function.returns.value is None)
        text = ast.get_docstring(function) or ""
        sections = [s for s in ("Parameters", "Returns") if s == "Parameters" or returns]
        absent = [s for s in sections if f"{s}\n---" not in text and not (s == "Returns" and "Yields\n---" in text)]
        if absent:
            found.append(f"{path.relative_to(PACKAGE)}:{function.lineno}: {function.name} lacks {', '.join(absent)}")
    return found


@pytest.mark.parametrize("room", ROOMS)
def test_public_functions_and_formulas_have_parameters_and_returns(room: str) -> None:
    place = PACKAGE / room
    assert not [
        line for path in ([place] if place.is_file() else sorted(place.rglob("*.py"))) for line in lacking(path)
    ]


def wordy(path: Path) -> list[str]:
    """Docstrings of a module that begin with a question or a clause."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
    found = (n for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, documented))
    firsts = [(getattr(n, "lineno", 1), (ast.get_docstring(n) or "-").splitlines()[0]) for n in found]
    return [f"{path.relative_to(PACKAGE)}:{line}: {text}" for line, text in firsts if WORDY.match(text)]


@pytest.mark.parametrize("room", ROOMS)
def test_docstrings_begin_with_a_noun_phrase_or_an_imperative(room: str) -> None:
    place = PACKAGE / room
    assert not [line for path in ([place] if place.is_file() else sorted(place.rglob("*.py"))) for line in wordy(path)]
