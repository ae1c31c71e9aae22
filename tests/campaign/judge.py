"""What is no good end of a command: each find is a class by which it is counted, and what was seen."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

from program import Ended, HangError, origin

from drivesizer.errors import DrivesizerError

__all__ = ["Find", "finds"]

_LINES, _LONG = 5, 1200  # of a refusal: lines, and characters of one
_STRANGE = re.compile(  # words of Python and of libraries that say nothing to an engineer
    r"<class |object at 0x|hould be a |NoneType|could not convert|object is not|has no attribute|Traceback|"
    r"unsupported operand|must be real number|pydantic|numpy|np\.float|list index|invalid literal|positional arg|"
    r"\bnot subscriptable|codec can|unhashable|Errno|\bstr\b.*\bint\b|dtype"
)
_OTHERS = ("drivesizer: a request of the page",)  # of no user
_PLACED = re.compile(
    r'\.(yaml|csv|urdf|xml|json)|--?[a-z]|: (?:[a-z]+ )?"|(parts of one|objective) |/dev/|'
    r"a request of the page|memory"
)


class Find(NamedTuple):
    """A class of finds, and one of them."""

    kind: str
    seen: str


def finds(one: Ended, schema: bool = False) -> list[Find]:
    """Everything that is wrong with how a command ended.

    Parameters
    ----------
    one
        The command.
    schema
        Whether JSON is also held against its printed schema, which takes as long as a sizing.

    Returns
    -------
    list[Find]
        Empty where all is well.
    """
    if isinstance(one.error, HangError):
        return [Find(f"hangs in {origin(one.error).rpartition(' ')[0].partition(':')[0]}", str(one.error))]
    if one.status not in (0, 1, 2):
        where = origin(one.error) if one.error else f"status {one.status}"
        return [Find(where, str(one.error)[:300])]
    return [*_streams(one), *(_refusal(one) if one.status == 2 else _answer(one, schema))]


def _streams(one: Ended) -> Iterator[Find]:
    """Characters that work on a terminal, warnings of libraries, lines of nobody."""
    for name, text in (("stdout", one.out), ("stderr", one.err)):
        strange = {c for c in text if not c.isprintable() and c != "\n"}
        if strange:
            yield Find(f"unprintable characters on {name} of {one.words[0]}", repr(sorted(strange)))
    for line in one.leaked:
        yield Find(f"a warning reaches the user: {line.partition(':')[0]}", line[:300])
    for line in one.err.splitlines():
        if not line.startswith(("drivesizer: ", "note: ")):
            yield Find(f"a line of nobody on stderr of {one.words[0]}", line[:300])


def _refusal(one: Ended) -> Iterator[Find]:
    said = [line for line in one.err.splitlines() if line.startswith("drivesizer: ")]
    where = origin(one.error) if one.error else one.words[0]
    if one.out:
        yield Find(f"output and a refusal: {where}", one.out[:200])
    if one.before != one.after:
        yield Find(f"files written and refused: {where}", str(sorted(one.after.keys() ^ one.before.keys())))
    if not said or len(said) > _LINES:
        yield Find(f"a refusal of {len(said)} lines: {where}", "; ".join(said)[:300])
    for line in said:
        if len(line) > _LONG:
            yield Find(f"a refusal of {len(line) // 1000 + 1} thousand characters: {where}", line[:300])
        if _STRANGE.search(_unquoted(line)) and not line.startswith(_OTHERS):
            yield Find(f"a refusal in a programmer's words: {where}", line[:300])
        if not _PLACED.search(line):
            yield Find(f"a refusal without a place: {where}", line[:300])
    if isinstance(one.error, MemoryError) and not isinstance(one.error, DrivesizerError):
        yield Find(f"memory: {where}", str(one.error)[:300])


def _unquoted(line: str) -> str:
    """A message without the user's own text."""
    return re.sub(r'"[^"]*"', '""', line)


def _answer(one: Ended, schema: bool) -> Iterator[Find]:
    for name, content in one.after.items():
        if name.endswith(".json") and one.before.get(name) != content:
            yield from _json(content.decode(), one, f"the file of {one.words[0]}")
    if "--json" in one.words and (one.out or not one.status) and "live" not in one.words[0]:
        yield from _json(one.out, one, one.words[0])
        if schema and one.words[0] in _SCHEMAS:
            yield from _of_schema(one)


def _json(text: str, one: Ended, of: str) -> Iterator[Find]:
    def never(word: str) -> Any:
        raise ValueError(f"{word} in JSON")

    try:
        document = json.loads(text, parse_constant=never)
    except ValueError as error:
        yield Find(f"no JSON: {of}", str(error)[:200])
        return
    for check in _checks(document):
        figures = check.get("demand"), check.get("limit")
        if check["status"] == "pass" and None in figures and check.get("margin", 0) is not None:
            yield Find(f"passes with an unknown figure: {check.get('name')}", json.dumps(check)[:300])


def _checks(document: Any) -> Iterator[dict[str, Any]]:
    """Checks anywhere in a document."""
    if isinstance(document, dict):
        if {"status", "demand", "limit"} <= document.keys():
            yield document
        document = list(document.values())
    for below in document if isinstance(document, list) else ():
        yield from _checks(below)


def _of_schema(one: Ended) -> Iterator[Find]:
    document = json.loads(one.out)
    error = next(_validator(one.words[0]).iter_errors(document), None)
    if error is not None:
        place = ".".join(str(step) for step in error.absolute_path if isinstance(step, str))
        yield Find(f"{one.words[0]} --json is not of its schema at {place}", error.message[:300])


_SCHEMAS = {"size", "predict"}


@cache
def _validator(of: str) -> Any:
    import jsonschema

    from drivesizer.output.json.schema import record_schema, report_schema
    from drivesizer.results.prediction import Prediction

    return jsonschema.Draft202012Validator(report_schema() if of == "size" else record_schema(Prediction))
