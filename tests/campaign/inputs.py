"""Kinds of input: each makes files and commands by chance, always the same of one seed."""

from __future__ import annotations

import json
from collections.abc import Callable
from random import Random
from typing import Any

import yaml
from case import Case
from changes import ODD, as_yaml, changed, damaged, damaged_bytes, moderately, odd
from documents import CYCLE, MJCF, TRACK, WAY, arm, catalogues, descriptions, of_load, parts_of, specs, studies
from small_catalogue import CATALOGUE, MAP, TABLE

__all__ = ["KINDS", "made"]

_JOBS = ("answer", "sweep", "rejected", "compare", "export", "catalogues", "parts", "part", "beside", "choose")
_BESIDE = {"own.yaml": CATALOGUE.encode(), "cycle.csv": CYCLE.encode(), "way.csv": WAY.encode()}
_OWN = ["--catalog", "own.yaml"]
_TABLES = (
    ("motors", TABLE, MAP),
    ("gearheads", "No,Ratio,T,Eff\n,,Nm,%\ng1,5:1,8,90\ng2,27:1,30,80\n",
     "source: {document: d, confidence: quoted}\ncommon: {kind: planetary, family: G}\n"
     "columns: {No: part, Ratio: reduction, T: continuous_torque, Eff: efficiency}\n"),
    ("encoders", "No;CPR;f\n;;kHz\ne1;500;200,5\n",
     "source: {document: d, confidence: recalled}\nfamily: E\n"
     "columns: {No: part, CPR: counts_per_turn, f: max_frequency}\n"),
)  # fmt: skip


def made(kind: str, seed: int) -> Case:
    """The input of a kind with a seed."""
    return KINDS[kind](Random(f"{kind} {seed}"))


# --- specs ------------------------------------------------------------------------------------------------------------


def spec(chance: Random) -> Case:
    """A spec with fields changed, sized with a small catalogue."""
    data = changed(chance.choice(specs()), chance, specs())
    return Case({"robot.yaml": as_yaml(data, chance), **_BESIDE}, [_sizing(chance)])


def figures(chance: Random) -> Case:
    """A spec with a few figures changed as much as machines differ: most of them are sized."""
    data = moderately(chance.choice(specs()), chance, specs())
    return Case({"robot.yaml": as_yaml(data), **_BESIDE}, [_sizing(chance)])


def text(chance: Random) -> Case:
    """The text of a spec, damaged."""
    whole = as_yaml(chance.choice(specs())).decode()
    return Case({"robot.yaml": damaged(whole, chance), **_BESIDE}, [_sizing(chance)])


def robot(chance: Random) -> Case:
    """A machine whose axes are the joints of a description, with fields changed, or the description damaged."""
    data = chance.choice((changed, moderately))(arm(), chance, [arm()])
    whole = damaged(MJCF, chance) if chance.random() < 0.3 else MJCF.encode()
    return Case({"robot.yaml": as_yaml(data, chance), "arm.xml": whole, **_BESIDE}, [_sizing(chance)])


def whole(chance: Random) -> Case:
    """A flywheel with a few figures changed, sized with all catalogues that ship; more takes too long."""
    data = moderately(of_load("flywheel"), chance, specs())
    data["select"] = {"catalogs": ["all"], "objective": "mass"}
    return Case({"robot.yaml": as_yaml(data), **_BESIDE}, [["size", "robot.yaml", *chance.choice(([], ["--json"]))]])


def _sizing(chance: Random) -> list[str]:
    words = ["size", "robot.yaml"]
    if chance.random() < 0.4:
        words.append("--json")
    if chance.random() < 0.25:
        words += chance.choice((
            ["-v"], ["-q"], ["--checks"], ["--derivation"], ["--paper"], ["--csv", "out.csv"],
            ["--pareto", "mass,price"],
            ["--objective", _word(chance)], ["--objective", "mass=2,energy=1"], ["--pareto", _word(chance)],
            ["--top", chance.choice(("0", "1", "1000", "x"))], ["--axis", "x"], ["--catalog", _word(chance)],
            ["--samples", "8"],
            ["--samples", "8", "--confidence", chance.choice(("0.9", "nan", "1", "0", "-1", "1e-300"))],
        ))  # fmt: skip
    return words


def further(chance: Random) -> Case:
    """A spec that is explained, driven, exported, reported or simulated."""
    data = chance.choice((changed, moderately))(chance.choice(specs()), chance, specs())
    words = chance.choices(_FURTHER, (30, 6, 20, 20, 10, 4, 8))[0]
    more = ["--json"] if words[0] in ("explain", "drive", "validate") and chance.random() < 0.5 else []
    return Case({"robot.yaml": as_yaml(data, chance), "track.csv": TRACK.encode(), **_BESIDE},
                [[*map(chance.choice, map(_choices, words)), *more]])  # fmt: skip


_FURTHER: tuple[tuple[str | tuple[str, ...], ...], ...] = (
    ("explain", "robot.yaml", "--motor", ("m1", "m2", "x"), "--gearhead", ("g1", "g2", "direct", "x")),
    ("validate", "robot.yaml", "--profile", ("trapezoid", "s-curve", "cycle.csv", "x")),
    ("drive", "robot.yaml", ("track.csv", "way.csv"), "--csv", "out.csv"),
    ("export", "robot.yaml", "--format", ("mjcf", "urdf", "sdf", "ros2_control", "json"), "-o", "out.xml"),
    ("report", "robot.yaml", "-o", ("out.csv", "out.json", "out.xlsx")),
    ("size", "robot.yaml", "--samples", "16", "--confidence", ("0.9", "0.5")),
    ("equations", ("1", "13", "20", "26", "33", "50", "52", "59"), "robot.yaml"),
)


def _choices(word: str | tuple[str, ...]) -> tuple[str, ...]:
    return (word,) if isinstance(word, str) else word


# --- what a spec reads ------------------------------------------------------------------------------------------------


def recording(chance: Random) -> Case:
    """A recorded load cycle, a speed profile or a trajectory, damaged."""
    recorded = {"name": "r", "load": {"kind": "recorded", "file": "cycle.csv"}, "supply": {"nominal": "24 V"},
                "select": {"catalogs": ["own.yaml"]}}  # fmt: skip
    kind = chance.randrange(3)
    platforms = [one for one in specs() if "platform" in one]
    base, name, words = (
        (CYCLE, "cycle.csv", ["size", "robot.yaml", *chance.choice(([], ["--json"], ["-v"]))]),
        (TRACK, "track.csv", ["drive", "robot.yaml", "track.csv", *chance.choice(([], ["--json"]))]),
        (WAY, "way.csv", ["drive", "robot.yaml", "way.csv", *chance.choice(([], ["--json"]))]),
    )[kind]
    data = recorded if kind == 0 else chance.choice(platforms)
    files = {"robot.yaml": as_yaml(data), **_BESIDE, name: damaged(base, chance)}
    return Case(files, [words])


def catalogue(chance: Random) -> Case:
    """A catalogue with cells changed: checked, shown, listed, compared, exported, predicted with, sized with."""
    base = chance.choice(catalogues()) if chance.random() < 0.6 else catalogues()[0]
    content = as_yaml(changed(base, chance), chance) if chance.random() < 0.9 else damaged(CATALOGUE, chance)
    flywheel = of_load("flywheel")
    part = chance.choice(parts_of(base))
    words = chance.choice((
        ["catalog", "check", *_OWN], ["catalog", "show", part, *_OWN], ["catalog", "show", part, *_OWN, "--source"],
        ["catalog", "show", part, *_OWN, "--json"], ["catalog", "search", part, *_OWN], ["catalog", "stats", *_OWN],
        ["catalog", "compare", part, chance.choice(parts_of(base)), *_OWN],
        ["catalog", "list", *_OWN], ["catalog", "export", "-o", "out.json", *_OWN],
        ["catalog", "export", "motors", "-o", "out.csv", *_OWN], ["predict", part, *_OWN],
        ["predict", part, *_OWN, "--json"], ["size", "robot.yaml", "--json"], ["size", "robot.yaml", "-v"],
        ["size", "robot.yaml"], ["explain", "robot.yaml", "--motor", "m1", "--gearhead", "g1"],
    ))  # fmt: skip
    return Case({**_BESIDE, "own.yaml": content, "robot.yaml": as_yaml(flywheel)}, [words])


def bench(chance: Random) -> Case:
    """Options of ``predict`` and ``explain``: quantities of every sort."""
    options = ("--voltage", "--load", "--hold", "--inertia", "--ambient", "--warm", "--resistance", "--minutes")
    given = [w for option in chance.sample(options, chance.choice((1, 1, 2, 3))) for w in (option, _word(chance))]
    words = ["predict", chance.choice(("m1", "m2", _word(chance))), *_OWN, *given]
    words += chance.choice(([], ["--gearhead", "g1"], ["--controller", "c1"]))
    return Case(_BESIDE, [words + chance.choice(([], ["--json"]))])


def table(chance: Random) -> Case:
    """A maker's table that is imported; its map, or itself, changed. What comes out is read."""
    section, rows, mapping = chance.choice(_TABLES)
    data = changed(_plain(mapping), chance) if chance.random() < 0.7 else _plain(mapping)
    content = damaged(rows, chance) if chance.random() < 0.5 else rows.encode()
    files = {"parts.csv": content, "map.yaml": as_yaml(data, chance)}
    words = ["catalog", "import", "parts.csv", "--section", section, "-o", "new.yaml"]
    words += ["--map", "map.yaml"] if chance.random() < 0.85 else ["--document", "d", "--confidence", "quoted"]
    if chance.random() < 0.2:
        words += [f"--{chance.choice(('manufacturer', 'family', 'name', 'document', 'confidence', 'date', 'url'))}"]
        words += [_word(chance)]
    return Case(files, [words, ["catalog", "check", "--catalog", "new.yaml"]])


def _word(chance: Random) -> str:
    """An odd value as one types it behind an option: a terminal passes no null character on."""
    return str(odd(chance)).replace("\0", "") or "x"


def _plain(text_: str) -> Any:
    return yaml.safe_load(text_)


def description(chance: Random) -> Case:
    """A robot's description, damaged: a first spec out of it, which is read."""
    suffix, whole = chance.choice(descriptions())
    words = ["init", "--from-urdf", f"robot{suffix}", "-o", "robot.yaml"]
    if chance.random() < 0.3:
        words += ["--joint", chance.choice(("tilt", "left_wheel", "shoulder", "joint_2", "x", _word(chance)))]
    commands = [words]
    if chance.random() < 0.05:
        commands.append(["size", "robot.yaml", "-q", *_OWN])
    return Case({f"robot{suffix}": damaged(whole, chance), "own.yaml": CATALOGUE.encode()}, commands)


def study(chance: Random) -> Case:
    """A study over a small spec, its file changed."""
    data = changed(chance.choice(studies()), chance) if chance.random() < 0.9 else chance.choice(studies())
    spec_ = of_load("wheeled_vehicle")
    files = {"study.yaml": as_yaml(data, chance), "robot.yaml": as_yaml(spec_), **_BESIDE}
    return Case(files, [["study", "study.yaml", "-o", "out", "--processes", "1", "--no-maps"]])


# --- what is kept, and the page ---------------------------------------------------------------------------------------


def cache(chance: Random) -> Case:
    """A compiled catalogue that was damaged: the answer stays as it is."""
    flywheel = of_load("flywheel")
    damage = json.dumps([chance.randrange(10**9), chance.choice(("bytes", "layout"))])
    return Case({"robot.yaml": as_yaml(flywheel), **_BESIDE}, [["damaged cache", damage]])


def live(chance: Random) -> Case:
    """A request of the live page: of its form, or as somebody else may send it."""
    whole = as_yaml(chance.choice(specs())).decode()
    job = chance.choice(_JOBS)
    request: Any = {
        "text": whole, "path": ["load", "mass"], "values": ["1 kg", "2 kg"], "motor": "m1", "gearhead": "g1",
        "sets": [["m1", "g1"]], "form": "json", "section": "motors", "catalogues": ["own.yaml"], "part": "m1",
        "catalogue": "own.yaml", "parts": [["own.yaml", "m1"], ["own.yaml", "m2"]], "options": {},
        "where": ["mass < 1 kg"],
        "edits": [[["load", chance.choice(("mass", "inertia", "kind", "x"))], chance.choice(ODD), None]],
    }  # fmt: skip
    if job == "choose":
        request["part"] = ["own.yaml", "motors", "m1"]
    if chance.random() < 0.4:
        del request["edits"]
    if chance.random() < 0.5:
        request = changed(request, chance)
    body = json.dumps(request, default=str)
    raw = damaged_bytes(body.encode(), chance) if chance.random() < 0.1 else body.encode()
    return Case({**_BESIDE, "robot.yaml": whole.encode(), "request.json": raw}, [["live request", job]])


KINDS: dict[str, Callable[[Random], Case]] = {
    one.__name__: one
    for one in (
        spec,
        figures,
        text,
        robot,
        whole,
        further,
        recording,
        catalogue,
        bench,
        table,
        description,
        study,
        cache,
        live,
    )
}
