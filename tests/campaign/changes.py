"""Changes by chance: of data (a spec, a catalogue), and of text (YAML, CSV, XML) as it comes to be damaged."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from random import Random
from typing import Any

import yaml

__all__ = ["ODD", "as_yaml", "changed", "damaged", "damaged_bytes", "moderately", "odd"]

# in place of a field: other types, figures at the ends, units of another kind or as vendors spell them, characters
ODD: tuple[Any, ...] = (
    0, -0.0, -1, 1, 3, 1e300, -1e300, 5e-324, 1e18, 1e-30, float("inf"), float("-inf"), float("nan"), 10**400, 2**63,
    None, True, False, [], {}, [1], [[]], {"a": 1}, {1: 2}, [None], "", " ", "~", "x", "nan", "inf", "-inf", "1e999",
    "0 m", "-0 m", "1e-7 s", "1e9 s", "1e300 kg", "5 kg", "-3 rpm", "100 %", "+- 10 %", "24 V +- 5 %", "24 V +- 200 %",
    "5e-324 kg*cm^2", "nan V", "inf N*m", "1e400 W", "0 V", "1e-300 s", "1e12 rpm", "0.5 deg", "5e5 rpm", "1e5 N*m",
    "1e-9 W", "3,5 mm", "1.000,5 kg", "10 Nm", "16 oz-in", "10 N-m", "5 kgcm", "25 degC", "25 °C", "77 °F", "3 lb-ft",
    "100 1/min", "100 min-1", "12V", "12 v", "12 Volt", "½ m", "１２ V", "٣ kg", "1_000 rpm", "0x10 V", "1e V", "+5 V",
    "5 V 5 V", "5 / 2 V", "3249/121", "1:1", "1:0", "0:0", "direct", "mass", "none", "all", "auto",
    "../x.yaml", "/dev/null",
    "9" * 400, "x" * 3000, "\u202ex", "a\x1b[31mb", "\x85", "\ud800", "\x00", "\ufeff", "Ω", "µm", "𝟙 V", "a\nb",
    "a\tb",
    "2024-05-06", "12:30:45", "0o17", "yes", "=", "<<", "*", "&", "!!python/object:os.system", "${HOME}", "%s%n", "{0}",
)  # fmt: skip
_FACTORS = (0.0, -0.0, -1.0, 1e-9, 1e-6, 1e-3, 0.01, 0.1, 0.5, 0.9, 0.99, 1.01, 1.5, 2.0, 10.0, 100.0, 1e3, 1e6, 1e9,
            1e30)  # fmt: skip
_MODERATE = (0.01, 0.1, 0.3, 0.5, 0.8, 0.95, 1.05, 1.3, 2.0, 3.0, 10.0, 100.0)
_UNITS = ("m", "mm", "kg", "N*m", "mN*m", "rpm", "rad/s", "V", "A", "s", "ms", "deg", "%", "kg*cm^2", "W", "Hz", "degC",
          "K/W", "m/s", "m/s^2", "A*h", "ohm", "N", "")  # fmt: skip
_ENDS = ("s", "_", " ", "\x85", "é", "x" * 200, ".", "[0]", "\u200b")
_SIGNS = ("", "", "'", '"', "[", "{", "}", "]", ":", ": ", "- ", "\t", "\x85", "\u2028", "|", "#", "&a ", "*a",
          "!!x ", ",",
          "\r", "\n", "\n\n", "\x00", "\x1b[2J", "\ufeff", "---\n", "...\n", "<<: *a\n", "? ", "%YAML 9.9\n",
          "!!binary ",
          "<", ">", "&amp;", "<!--", "]]>", "/>", ";", "nan", "1e309", "-", "e", ".", "9" * 30, "\u202e",
          "é", "🤖")  # fmt: skip


def leaves(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all fields, groups among them."""
    if path:
        yield path
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield from leaves(value, (*path, key))


def odd(chance: Random) -> Any:
    """A value that stands for a field of no kind."""
    return copy.deepcopy(chance.choice(ODD))


def changed(data: Any, chance: Random, others: Any = ()) -> Any:
    """Data with one to four fields changed; a section may come out of another document."""
    data = copy.deepcopy(data)
    for _ in range(chance.choice((1, 1, 1, 1, 2, 2, 3, 4))):
        paths = list(leaves(data))
        if not paths:
            break
        *above, last = chance.choice(paths)
        owner = _at(data, above)
        chance.choices(_CHANGES, _WEIGHTS)[0](owner, last, chance, data)
        if others and chance.random() < 0.12:
            _grafted(data, chance.choice(others), chance)
    return data


def moderately(data: Any, chance: Random, others: Any = ()) -> Any:
    """Data with one to three figures changed by a factor that machines have, so that most of it is computed."""
    data = copy.deepcopy(data)
    figures = [path for path in leaves(data) if str(_at(data, path))[:1].isdigit()]
    for *above, last in chance.sample(figures, min(chance.choice((1, 1, 2, 3)), len(figures))):
        owner = _at(data, above)
        digits, blank, unit = str(owner[last]).partition(" ")
        factor = chance.choice(_MODERATE)
        if isinstance(owner[last], int | float):
            owner[last] = owner[last] * factor if isinstance(owner[last], float) else max(int(owner[last] * factor), 1)
        elif digits.replace(".", "", 1).isdigit():
            owner[last] = f"{float(digits) * factor:.6g}{blank}{unit}"
    if others and chance.random() < 0.25:
        _grafted(data, chance.choice(others), chance)
    return data


def _at(data: Any, path: Sequence[Any]) -> Any:
    for step in path:
        data = data[step]
    return data


def _scaled(owner: Any, last: Any, chance: Random, _: Any) -> None:
    """A figure, with its unit where it has one, times some factor; what is none becomes something odd."""
    value, factor = owner[last], chance.choice(_FACTORS)
    if isinstance(value, int | float) and not isinstance(value, bool):
        owner[last] = value if abs(value) > 10**300 else value * factor
        return
    digits, _, unit = str(value).partition(" ")
    try:
        owner[last] = f"{float(digits) * factor:g} {unit}"
    except ValueError:
        owner[last] = odd(chance)


def _replaced(owner: Any, last: Any, chance: Random, _: Any) -> None:
    owner[last] = odd(chance)


def _other_unit(owner: Any, last: Any, chance: Random, _: Any) -> None:
    owner[last] = f"{str(owner[last]).partition(' ')[0]} {chance.choice(_UNITS)}"


def _moved(owner: Any, last: Any, chance: Random, data: Any) -> None:
    """The value of another field, which may be of the same kind."""
    *above, other = chance.choice(list(leaves(data)))
    owner[last] = copy.deepcopy(_at(data, above)[other])


def _dropped(owner: Any, last: Any, *_: Any) -> None:
    del owner[last]


def _doubled(owner: Any, last: Any, chance: Random, _: Any) -> None:
    if isinstance(owner, list):
        owner.append(copy.deepcopy(owner[last]))
    else:
        owner[f"{last}{chance.choice(_ENDS)}"] = owner[last]


def _misspelt(owner: Any, last: Any, chance: Random, data: Any) -> None:
    if isinstance(owner, dict):
        name = str(last)
        at = chance.randrange(len(name) + 1)
        owner[chance.choice((name[:at] + name[at + 1 :], name.upper(), name + chance.choice(_ENDS)))] = owner.pop(last)
    else:
        _replaced(owner, last, chance, data)


def _many(owner: Any, last: Any, chance: Random, _: Any) -> None:
    owner[last] = [copy.deepcopy(owner[last]) for _ in range(chance.choice((2, 3, 50, 400)))]


def _nested(owner: Any, last: Any, chance: Random, _: Any) -> None:
    value, wrap = owner[last], chance.choice((lambda v: [v], lambda v: {"a": v}, lambda v: {"kind": v}))
    for _ in range(chance.choice((1, 1, 2, 30, 90))):
        value = wrap(value)
    owner[last] = value


def _toleranced(owner: Any, last: Any, chance: Random, _: Any) -> None:
    text = chance.choice(("+- 10 %", "+- 3 mm", "-5 % +10 %", "+- 0 %", "normal 5 %", "+- 1e9 %", "-10 % +-5 %"))
    owner[last] = f"{owner[last]} {text}"


def _grafted(data: Any, other: Any, chance: Random) -> None:
    """A field of another document, at the same place or at the top."""
    if isinstance(data, dict) and isinstance(other, dict) and other:
        key = chance.choice(list(other))
        if isinstance(data.get(key), dict) and isinstance(other[key], dict) and chance.random() < 0.6:
            _grafted(data[key], other[key], chance)
        else:
            data[key] = copy.deepcopy(other[key])


_Change = Callable[[Any, Any, Random, Any], None]
_CHANGES: tuple[_Change, ...] = (
    _scaled, _replaced, _other_unit, _moved, _dropped, _doubled, _misspelt, _many, _nested, _toleranced
)  # fmt: skip
_WEIGHTS = (40, 22, 5, 8, 9, 4, 4, 2, 3, 3)


# --- texts ------------------------------------------------------------------------------------------------------------


def as_yaml(data: Any, chance: Random | None = None) -> bytes:
    """Data as YAML; by chance some of it is damaged behind that."""
    try:
        text = yaml.dump(data, Dumper=yaml.CSafeDumper, sort_keys=False, allow_unicode=True, width=200)
    except (UnicodeEncodeError, yaml.YAMLError, RecursionError):
        text = repr(data)
    return damaged(text, chance) if chance and chance.random() < 0.15 else text.encode("utf-8", "surrogatepass")


def damaged(text: str, chance: Random) -> bytes:
    """A text as hands and programs spoil it, one to three times over."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        text = chance.choice(_SPOILT)(text, chance) if text else "\n"
    raw = text.encode("utf-8", "surrogatepass")
    return damaged_bytes(raw, chance) if chance.random() < 0.1 else raw


def damaged_bytes(raw: bytes, chance: Random) -> bytes:
    """Bytes with some of them changed, cut off, or in another encoding."""
    at = chance.randrange(len(raw) + 1)
    put = bytes(chance.randrange(256) for _ in range(chance.choice((1, 1, 4, 40))))
    return chance.choice((
        raw[:at], raw[:at] + put + raw[at:], raw[:at] + put + raw[at + len(put) :], b"\xef\xbb\xbf" + raw,
        raw.decode("utf-8", "replace").encode("utf-16"), raw.decode("utf-8", "replace").encode("latin-1", "replace"),
        raw + b"\0" * 9, b"",
    ))  # fmt: skip


def _cut(text: str, chance: Random) -> str:
    at, size = chance.randrange(len(text)), chance.choice((0, 1, 1, 2, 8, 200))
    return text[:at] + chance.choice(_SIGNS) + text[at + size :]


def _figure(text: str, chance: Random) -> str:
    """Another figure in place of one: what stands between signs that part words."""
    at = chance.randrange(len(text))
    ends = " ,;\n\t\"':[]{}<>="
    first, last = at, at
    while first and text[first - 1] not in ends:
        first -= 1
    while last < len(text) and text[last] not in ends:
        last += 1
    return text[:first] + str(chance.choice(ODD)) + text[last:]


def _lines(text: str, chance: Random) -> str:
    """Lines doubled, exchanged, taken away, indented."""
    lines = text.split("\n")
    a, b = chance.randrange(len(lines)), chance.randrange(len(lines))
    match chance.randrange(6):
        case 0:
            lines.insert(b, lines[a])
        case 1:
            lines[a], lines[b] = lines[b], lines[a]
        case 2:
            del lines[min(a, b) : max(a, b)]
        case 3:
            lines[a] = chance.choice((" ", "  ", "\t")) + lines[a]
        case 4:
            lines[a] = lines[a].lstrip()
        case _:
            lines[a:a] = [lines[a]] * chance.choice((3, 300))
    return "\n".join(lines)


def _line_ends(text: str, chance: Random) -> str:
    return text.replace("\n", chance.choice(("\r\n", "\r", "\n\r", " \n", "\u2028", "\x0b")))


def _marked(text: str, chance: Random) -> str:
    heads = ("\ufeff", "%TAG ! x\n", "# é\n", "\n\n\n", "sep=;\n", "<?xml version='1.0'?>", "--- \n")
    return chance.choice(heads) + text


def _deep(text: str, chance: Random) -> str:
    at, times = chance.randrange(len(text)), chance.choice((10, 100, 5000))
    return text[:at] + chance.choice(("[", "{a: ", "- ", "<a>", "((", "!!x ", "&a ", "'")) * times + text[at:]


def _anchored(text: str, chance: Random) -> str:
    """An anchor at one line and its alias at another."""
    lines = text.split("\n")
    for sign in ("&a", chance.choice(("*a", "*b", "!!str", "!!float", "!x", "<<: *a"))):
        at = chance.randrange(len(lines))
        key, colon, value = lines[at].partition(":")
        lines[at] = f"{key}{colon} {sign}{value}" if sign.startswith(("&", "!")) else f"{key}{colon} {sign}"
    return "\n".join(lines)


_SPOILT: tuple[Callable[[str, Random], str], ...] = (
    _cut, _cut, _cut, _figure, _figure, _figure, _lines, _lines, _line_ends, _marked, _deep, _anchored
)  # fmt: skip
