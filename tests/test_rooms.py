"""The rooms of the package: what each may import, and that each says what it is for."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from functools import cache
from graphlib import TopologicalSorter
from importlib import import_module
from pathlib import Path

import drivesizer

PACKAGE = Path(drivesizer.__file__).parent
ROOT = PACKAGE.parent

# A room imports only rooms above its own line; those of one line do not import one another.
ORDER = (
    ("errors", "version"),
    ("units",),
    ("files",),
    ("physics",),
    ("kernel",),
    ("equations",),
    ("platform", "catalog", "loads"),
    ("spec",),
    ("results",),
    ("load_cases",),
    ("machine", "control", "joints"),
    ("simulate",),
    ("search",),
    ("sizing", "prediction", "identification"),
    ("multi_axis", "output"),
    ("study",),
    ("codesign",),
    ("commands",),
    ("live",),
    ("cli",),
    ("__main__",),
)
RANK = {room: rank for rank, line in enumerate(ORDER) for room in line}
# above it, and yet not to be imported: commands join them
APART = {"output": {"search", "sizing", "simulate", "prediction", "identification"}}
FILES = {
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__"): path
    for path in PACKAGE.rglob("*.py")
}
ROOMS = sorted({str(path.parent.relative_to(PACKAGE)) for path in FILES.values()} - {"."})


def imported(name: str) -> set[tuple[str, str]]:
    """Modules of the package that one of them imports, also inside functions, each with the name taken from it."""
    found: set[tuple[str, str]] = set()
    for node in ast.walk(ast.parse(FILES[name].read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                found.add((whole, "") if whole in FILES else (node.module, alias.name))
        elif isinstance(node, ast.Import):
            found |= {(alias.name, "") for alias in node.names}
    return {(module, taken) for module, taken in found if module in FILES and module not in {name, "drivesizer"}}


@cache
def graph() -> dict[str, set[tuple[str, str]]]:
    """What each module imports; at the first test that wants it, for reading all of them takes seconds."""
    return {name: imported(name) for name in FILES if name != "drivesizer"}


def top(name: str) -> str:
    """The room of a module on the first floor; a file there is a room of its own."""
    return name.split(".")[1]


def folder(name: str) -> str:
    """The folder of a module: rooms within rooms apart from the files beside them."""
    return str(FILES[name].parent.relative_to(PACKAGE)) if FILES[name].parent != PACKAGE else top(name)


def test_every_room_has_its_place_in_the_order() -> None:
    assert {top(name) for name in graph()} == set(RANK)


def test_rooms_import_one_way() -> None:
    against = [
        f"{name} imports {module}"
        for name, found in graph().items()
        for module, _ in found
        if top(module) != top(name)
        and (RANK[top(module)] >= RANK[top(name)] or top(module) in APART.get(top(name), set()))
    ]
    assert not against


def test_no_circle_of_modules_nor_of_folders() -> None:
    """Also within ``output``, ``search`` and ``control``, whose folders are rooms of their own."""
    modules = {name: {module for module, _ in found} for name, found in graph().items()}
    assert modules["drivesizer.sizing"] >= {"drivesizer.search.search", "drivesizer.search.columns.paper"}
    list(TopologicalSorter(modules).static_order())  # raises CycleError
    folders: dict[str, set[str]] = defaultdict(set)
    for name, found in modules.items():
        folders[folder(name)] |= {folder(module) for module in found} - {folder(name)}
    assert folders["search/uncertainty"] >= {"search/columns"}
    list(TopologicalSorter(folders).static_order())


def test_nothing_private_crosses_a_door() -> None:
    taken = [
        f"{name} takes {private} from {module}"
        for name, found in graph().items()
        for module, private in found
        if private.startswith("_") and not private.startswith("__")
    ]
    assert not taken


def test_every_room_says_what_it_is_for() -> None:
    told = {room: import_module("drivesizer." + room.replace("/", ".")).__doc__ or "" for room in ROOMS}
    assert not [
        room for room, text in told.items() if not text.strip() or ("/" not in room and "May import: " not in text)
    ]


def test_the_map_names_every_room_and_its_ways_lead_somewhere() -> None:
    page = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    lacking = [room for room in ROOMS if "/" not in room and f" {room}/" not in page]
    assert not lacking
    found = page.split("## Found in half a minute", 1)[1].split("\n## ", 1)[0]
    ways = re.findall(r"`(drivesizer/[\w/.]+)(?:::(\w+))?`", found)
    assert len(ways) >= 4
    for file, name in ways:
        text = (ROOT / file).read_text(encoding="utf-8")
        assert not name or re.search(rf"^(def|class) {name}\b", text, re.MULTILINE), (file, name)


def test_no_test_imports_another_test() -> None:
    """What two of them need is a helper or a fixture."""
    tests = {path.stem for path in (ROOT / "tests").rglob("test_*.py")}
    assert len(tests) > 100
    for path in (ROOT / "tests").rglob("*.py"):
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        taken = {str(node.module).split(".")[-1] for node in nodes if isinstance(node, ast.ImportFrom)}
        taken |= {alias.name.split(".")[-1] for node in nodes if isinstance(node, ast.Import) for alias in node.names}
        assert not taken & tests, path.name
