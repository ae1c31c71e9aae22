"""Retired words stay out: of what users read, and of docstrings, comments and names.

``RETIRED`` is the glossary: a pattern, and the field's own words instead. A false alarm is reworded; a public name
goes into ``ALLOWED`` with its reason.
"""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import drivesizer

PACKAGE = Path(drivesizer.__file__).parent
ROOT = PACKAGE.parent

RETIRED = {
    r"for ever": "continuous, in periodic steady state",
    r"on end": "uninterrupted, longest continuous",
    r"without end": "unbounded, thermal runaway",
    r"march(es|ed|ing)?": "simulate, step",
    r"com(e|es|ing) back|came back": "regenerated, returned",
    r"strings side by side": "parallel strings",
    r"whole reduction": "total ratio",
    r"gets? worn": "aged",
    r"taken apart|takes? apart": "split, decomposed",
    r"as heavy as its own": "including the drive's own mass",
    r"worth knowing": "informational",
    r"(passed )?by choice": "selected",
    r"(un)?sure(ly|ness)?|surest": "probability, confidence, certain",
    r"ask(s|ed|ing)?": "require, demand, load, request",
    r"t(old|ell|ells|elling)": "report, known, give, show, state",
    r"falls? or stands?|stands? (or|nor) falls?|those that f(ell|all)": "pass or fail",
    r"(sets?|drives?) (that )?f(ell|alls?|allen)": "fail on, rejected",
    r"f(ell|alls?) by (a|the|its|which|this|that|one) (check|limit|budget)s?": "fail on, rejected",
    r"bears?": "withstands, is rated for",
    r"(sets?|drives?|none|many|nothing|that|which|still) stands?(?! for\b)|standing sets?": "meets all limits",
    r"pairs? of (a )?(motors?|gearheads?)|motor[- ]gearhead pairs?": "combination",
    r"(?-i:([Mm]otor|[Dd]rive) sets?)": "drive",
    r"(best|better|each|every|another|other|these|those|many|all|some|such) sets?(?! of\b)": "drive",
    r"ways? (left|ahead|behind|travelled)|on (its|their) way": "path, travel, distance, route",
}  # fmt: skip
WORDS = {re.compile(rf"\b(?:{pattern})\b", re.I): instead for pattern, instead in RETIRED.items()}
ANY = re.compile(rf"\b(?:{'|'.join(RETIRED)})\b", re.I)  # most texts have none: one look at them instead of twenty
NAMES = re.compile(
    r"(?:^|_)(?:asked|asks|told|tells?|sure|surely|unsure|fell|fallen|bears|march|marched|stands|standing|on_end"
    r"|for_ever|whole_reduction)(?:_|$)"
)
PRONOUNS = {
    "one", "some", "each", "every", "both", "again", "found", "said", "told", "felt", "made", "wanted", "taken",
    "looked",
}  # fmt: skip
NO_NAMES = PRONOUNS | {  # alone, of a function, a class, a field or a constant; with a noun they may say enough
    "beside", "chosen", "given", "held", "hit", "kept", "moved", "shown", "taken", "tried",
}  # fmt: skip
ALLOWED = {  # names that are right as they are: why
    "beside": "a key in JSON: checks of the other method; the live page's request",
    "each": "a key in JSON: the mass of one",
    "found": "a key in JSON of `catalog check`: the figure that contradicts",
    "given": "the spec behind a report; a key of the live page's request",
    "held": "a field of robot.yaml; wheels and platforms",
    "said": "a key in JSON: a line of the parts list in words",
    "shown": "a requirement in the unit of the trade",
    "tried": "a key in JSON: what was simulated or computed beside the result",
    "unsure": "a public attribute of a sizing's result, and its key in JSON",
    "sure": "a key of catalog stats --json",
}

ROOMS = sorted(p.name for p in PACKAGE.iterdir() if (p.is_dir() and p.name != "__pycache__") or p.suffix == ".py")
PAGES = ["docs", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "ARCHITECTURE.md"]


def retired(text: str) -> Iterator[str]:
    """Retired words of a text, each with what to say instead and its neighbourhood."""
    flat = re.sub(r"\s*\n[\s#]*", " ", re.sub(rf"`({'|'.join(ALLOWED)})`", "", text))
    for word, instead in WORDS.items() if ANY.search(flat) else ():
        for match in word.finditer(flat):
            yield f"{match[0]!r} -> {instead}: ...{flat[max(0, match.start() - 40) : match.end() + 40]}..."


def is_docstring(tree: ast.Module) -> set[int]:
    """Lines where docstrings begin."""
    owners = (n for n in ast.walk(tree) if isinstance(n, (ast.Module, ast.ClassDef, ast.FunctionDef)))
    return {n.body[0].lineno for n in owners if ast.get_docstring(n, clean=False) is not None}


@cache
def texts(path: Path) -> list[tuple[int, bool, str]]:
    """Strings, docstrings and comments of a module: line, whether users read it, text. Keys and names are none."""
    return list(_texts(path))


def _texts(path: Path) -> Iterator[tuple[int, bool, str]]:
    source = path.read_text(encoding="utf-8")
    documented = is_docstring(ast.parse(source))
    printed_help = "commands" in path.parts  # docstrings of commands are their --help
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], False, token.string
        elif token.type == tokenize.STRING or tokenize.tok_name[token.type] == "FSTRING_MIDDLE":
            docstring = token.start[0] in documented
            if docstring or not token.string.strip("rfb\"'").isidentifier():
                yield token.start[0], not docstring or printed_help, token.string


def names(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Names that a module or a function defines: functions, classes, arguments and variables."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node.lineno, node.name
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.id
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg


def modules(room: str) -> list[Path]:
    place = PACKAGE / room
    return [place] if place.is_file() else sorted(place.rglob("*.py"))


def pages(room: str) -> Iterator[Path]:
    """Texts of a room that are no Python: pages, starters, templates."""
    place = ROOT / room if room in PAGES else PACKAGE / room
    if place.is_file():
        return iter([place] if place.suffix == ".md" else [])
    found = sorted(p for p in place.rglob("*") if p.suffix in {".md", ".yaml", ".typ", ".j2", ".html", ".js"})
    return (p for p in found if p.name != "json_schema.yaml")


def in_users_texts(room: str) -> list[str]:
    found = [
        f"{path.relative_to(ROOT)}:{line}: {word}"
        for path in (modules(room) if room not in PAGES else [])
        for line, printed, text in texts(path)
        if printed
        for word in retired(text)
    ]
    for path in pages(room):
        text = path.read_text(encoding="utf-8")
        if path.name == "CHANGELOG.md":  # which quotes as code what outputs said before
            text = re.sub(r"`[^`]*`", lambda quoted: "\n" * quoted[0].count("\n"), text)
        for number, line in enumerate(text.splitlines(), 1):
            found += [f"{path.relative_to(ROOT)}:{number}: {word}" for word in retired(line)]
    return found


def in_readers_texts(room: str) -> list[str]:
    found = []
    for path in modules(room):
        place = path.relative_to(ROOT)
        found += [f"{place}:{n}: {w}" for n, printed, text in texts(path) if not printed for w in retired(text)]
        found += [
            f"{place}:{n}: name {x}"
            for n, x in names(ast.parse(path.read_text(encoding="utf-8")))
            if x not in ALLOWED and NAMES.search(x)
        ]
    return found


@pytest.mark.parametrize("room", ROOMS)
def test_arguments_and_local_names_say_what_they_hold(room: str) -> None:
    functions = [
        (path.relative_to(ROOT), node)
        for path in modules(room)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.Lambda)
    ]
    inside = [
        (place, line, name) for place, function in functions for line, name in names(function) if name in PRONOUNS
    ]
    assert not [f"{place}:{line}: {name}" for place, line, name in inside]


def definitions(tree: ast.AST, inside: bool = False) -> Iterator[tuple[int, str]]:
    """Names of functions, classes, fields and constants, and of what a class keeps in itself."""
    for node in ast.iter_child_nodes(tree):
        function = isinstance(node, ast.FunctionDef)
        if function or isinstance(node, ast.ClassDef):
            yield node.lineno, node.name
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and not inside:
            yield node.lineno, node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.attr
        yield from definitions(node, inside or function)


@pytest.mark.parametrize("room", ROOMS)
def test_functions_classes_fields_and_constants_say_what_they_hold(room: str) -> None:
    defined = [
        (f"{path.relative_to(ROOT)}:{line}: {name}", name.strip("_").lower())
        for path in modules(room)
        for line, name in definitions(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not [place for place, name in defined if name in NO_NAMES - ALLOWED.keys()]


@pytest.mark.parametrize("room", [*ROOMS, *PAGES])
def test_no_text_comment_or_name_has_a_retired_word(room: str) -> None:
    assert not in_users_texts(room)
    assert room in PAGES or not in_readers_texts(room)


def test_the_table_finds_its_words() -> None:
    found = list(retired("the motor bears what is asked for ever, and 3 sets that stand"))
    assert len(found) == 4
    assert not list(retired("a row that stands for no gearhead; the voltage falls by 2 V; sets of samples"))


if __name__ == "__main__":  # python tests/docs/test_words.py [ROOM ...]: all that is left
    import sys

    for room_ in sys.argv[1:] or [*ROOMS, *PAGES]:
        left = in_users_texts(room_) + (in_readers_texts(room_) if room_ not in PAGES else [])
        print(*left, f"{room_}: {len(left)} retired words", sep="\n")
