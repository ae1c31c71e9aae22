"""Benchmarks are run by hand: what they take of the program is there."""

from __future__ import annotations

import ast
from importlib import import_module
from inspect import ismodule
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
SOURCES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.py"))}


def imports(source: str) -> list[tuple[str, str]]:
    """Module and name of all that a script imports of the program."""
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ImportFrom))
    return [(node.module, alias.name) for node in nodes if (node.module or "").startswith("drivesizer")
            for alias in node.names]  # fmt: skip


def attributes(source: str, of: str) -> set[str]:
    """What a script takes of a name by a dot."""
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Attribute))
    return {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id == of}


@pytest.mark.parametrize("name", [name for name, source in SOURCES.items() if imports(source)])
def test_what_a_benchmark_imports_exists(name):
    for module, taken in imports(SOURCES[name]):
        there = import_module(module)
        found = getattr(there, taken) if hasattr(there, taken) else import_module(f"{module}.{taken}")
        assert [name for name in attributes(SOURCES[name], taken) if ismodule(found) and not hasattr(found, name)] == []


def test_every_goal_is_measured_by_a_benchmark_of_the_table(monkeypatch):
    monkeypatch.syspath_prepend(FOLDER)
    goals, scripts = import_module("goals").GOALS, import_module("table").SCRIPTS
    run = "".join(SOURCES[script] for script in scripts)
    assert [name for name in goals if f'"{name}"' not in run] == []
