"""Mutation run: small faults put into physics, kernel, checks, search and controllers; the tests should find each.

    python tests/tools/mutants.py [--tree CHECKOUT] [--count 60] [--seed 1] [--room ROOM] [--time 600]

Works on a copy of the checkout. A mutant is one change of a comparison, an arithmetic or boolean operator, a number or
a returned value, drawn at random with a fixed seed, as many in each room. It is killed when a test of its room, or of
the few across rooms, fails. Compiled kernels are named by the digest of their sources, so that a mutant of theirs is
compiled anew and not found in a cache.
"""

from __future__ import annotations

import argparse
import ast
import copy
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("physics", "kernel", "results", "search", "control")
ACROSS = ("tests/test_sps_robot.py", "tests/test_equations.py", "tests/against/test_brute_force.py")
ALSO = {"control": ("tests/test_simulate.py", "tests/against/test_servo.py")}
COMPARED = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
COMPUTED = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}


class Mutant(NamedTuple):
    """One change: the node's place in the order of ``ast.walk``."""

    path: Path
    node: int
    line: int
    what: str


def mutated(node: ast.AST) -> str:
    """Change a node in place; what was done, or nothing where it is none of those that are changed."""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARED:
        old = node.ops[0]
        node.ops[0] = COMPARED[type(old)]()
        return f"{type(old).__name__} -> {type(node.ops[0]).__name__}"
    if isinstance(node, ast.BinOp) and type(node.op) in COMPUTED and not isinstance(node.left, ast.Constant):
        old_op = node.op
        node.op = COMPUTED[type(old_op)]()
        return f"{type(old_op).__name__} -> {type(node.op).__name__}"
    if isinstance(node, ast.BoolOp):
        node.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        return "and <-> or"
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        node.value = node.value + 1 if isinstance(node.value, int) else node.value * 1.01 + 1e-3
        return f"constant {node.value:g}"
    if isinstance(node, ast.Return) and isinstance(node.value, (ast.BinOp, ast.Name)):
        node.value = ast.UnaryOp(ast.USub(), node.value)
        return "return -x"
    return ""


def passed_over(tree: ast.Module) -> set[int]:
    """Nodes that no test can see changed: annotations, slots of decorators, messages of errors."""
    found: set[int] = set()
    for node in ast.walk(tree):
        parts: list[ast.AST | None] = []
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            parts += node.decorator_list
        if isinstance(node, ast.FunctionDef):
            parts += [node.returns, *(a.annotation for a in ast.walk(node.args) if isinstance(a, ast.arg))]
        if isinstance(node, ast.AnnAssign):
            parts.append(node.annotation)
        if isinstance(node, (ast.Raise, ast.JoinedStr)):
            parts.append(node)
        found |= {id(child) for part in parts if part for child in ast.walk(part)}
    return found


def mutants(room: Path) -> Iterator[Mutant]:
    """All mutants of a room."""
    for path in sorted(room.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        hidden = passed_over(tree)
        for n, node in enumerate(ast.walk(tree)):
            what = "" if id(node) in hidden else mutated(copy.deepcopy(node))
            if what:
                yield Mutant(path, n, getattr(node, "lineno", 0), what)


def source_of(mutant: Mutant) -> str:
    """The module with the change."""
    tree = ast.parse(mutant.path.read_text(encoding="utf-8"))
    mutated(list(ast.walk(tree))[mutant.node])
    return ast.unparse(ast.fix_missing_locations(tree))


def tests_of(tree: Path, room: str) -> list[str]:
    """Tests of a room and those across, each that is there."""
    return [t for t in (f"tests/{room}", *ACROSS, *ALSO.get(room, ())) if (tree / t).exists()]


def killed(tree: Path, room: str, limit: float) -> bool:
    """Whether a test fails; a mutant that runs beyond the time is killed too."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-o", "addopts="]
    if "slow:" in (tree / "pyproject.toml").read_text(encoding="utf-8"):
        command += ["-m", "not slow"]
    surroundings = os.environ | {"PYTHONPATH": str(tree), "HYPOTHESIS_STORAGE_DIRECTORY": str(tree / ".hypothesis")}
    try:
        done = subprocess.run(
            [*command, *tests_of(tree, room)],
            cwd=tree,
            env=surroundings,
            capture_output=True,
            timeout=limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def main() -> None:
    """Copy, draw, run, count."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tree", type=Path, default=ROOT, help="the checkout; this one")
    parser.add_argument("--count", type=int, default=60, help="mutants in all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", choices=ROOMS, action="append", help="only this one")
    parser.add_argument("--time", type=float, default=900.0, help="limit for one mutant [s]")
    options = parser.parse_args()
    rooms = options.room or list(ROOMS)
    with tempfile.TemporaryDirectory() as scratch:
        tree = Path(scratch) / "tree"
        without = shutil.ignore_patterns(".git", ".venv", "__pycache__", "site", "build", ".mypy_cache")
        shutil.copytree(options.tree, tree, ignore=without)
        total = 0
        for room in rooms:
            if killed(tree, room, 10 * options.time):
                sys.exit(f"{room}: its tests fail without a mutant")
            found = list(mutants(tree / "drivesizer" / room))
            drawn = random.Random(options.seed).sample(found, options.count // len(rooms))
            count = 0
            for mutant in drawn:
                before, start = mutant.path.read_text(encoding="utf-8"), time.monotonic()
                mutant.path.write_text(source_of(mutant), encoding="utf-8")
                dead = killed(tree, room, options.time)
                mutant.path.write_text(before, encoding="utf-8")
                count += dead
                where = f"{mutant.path.relative_to(tree)}:{mutant.line}: {mutant.what}"
                print(f"{'killed  ' if dead else 'SURVIVED'} {time.monotonic() - start:5.0f} s  {where}", flush=True)
            print(f"{room}: {count} of {len(drawn)} killed ({len(found)} mutants in all)", flush=True)
            total += count
        print(f"{total} killed")


if __name__ == "__main__":
    main()
