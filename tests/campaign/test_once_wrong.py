"""Inputs that once ended wrongly, as the campaign found them, and a few new ones of every kind."""

import pytest
from case import Case
from documents import CYCLE
from inputs import KINDS, made
from program import ran
from runner import WEIGHTS, found_by, judged
from shrinking import shrunk
from small_catalogue import CATALOGUE
from starters import STARTERS

SPEC = """\
name: once
load: {kind: flywheel, inertia: 80 kg*cm^2}
motion: {speed: 600 rpm, acceleration_time: 0.5 s, cruise_time: 1 s, rest_time: 1 s}
supply: {nominal: 24 V}
select: {catalogs: [own.yaml]}
"""
SIZE = ["size", "robot.yaml"]
TWICE = "{objective: mass, weight: 1}, {objective: mass, weight: 2}"
MANY = ", ".join(f"{{name: c{n}}}" for n in range(101))


# what was put in place of what, the command, and what it says now
@pytest.mark.parametrize(
    ("was", "put", "words", "said"),
    [
        ("rest_time: 1 s", "there_and_back: -0.0", SIZE, 'motion.there_and_back: "-0.0" is neither true nor false'),
        ("name: once", "cases: 5", SIZE, 'cases: "5" is not a list; expected entries between [ and ]'),
        ("name: once", "cases: 5 +- 10 %", SIZE, 'cases: "5" is not a list'),
        ("name: once", "cases: [5 +- 10 %]", SIZE, "robot.yaml:1: cases[1]: "),
        ("name: once", "transmission: [[5 +- 10 %, {ratio: 5 +- 10 %}]]", SIZE, "robot.yaml:1: transmission[1]: "),
        ("name: once", "cases: [{transmission: [{kind: belt, ratio: 2 +- 5 %}]}]", SIZE, "ratios of a belt are "),
        ("name: once", f"{'x' * 900}: 1", SIZE, f"robot.yaml:1: {'x' * 59}…: unknown key; expected one of name"),
        ("name: once", "name: ''", SIZE, "robot.yaml:1: name: is empty; expected text"),
        ("name: once", f"name: {'x' * 300}", SIZE, '…" is too long; expected at most 200 characters'),
        ("name: once", "name: once", [*SIZE, "--objective", "mass=1e308"], '"1e308" is not a number above 0 (1e-12'),
        ("name: once", "name: once", [*SIZE, "--objective", "mass=1,mass=2"], 'objective "mass" is given twice'),
        ("own.yaml]", f"own.yaml], objective: [{TWICE}]", SIZE, "select.objective: expected each objective once; mass"),
        ("name: once", f"cases: [{MANY}]", SIZE, 'cases: "a list of 101" is too long; expected at most 100 entries'),
    ],
)  # fmt: skip
def test_what_once_ended_wrongly_is_said_in_a_line(was, put, words, said, tmp_path):
    assert was in SPEC + CATALOGUE
    texts = {"robot.yaml": SPEC, "own.yaml": CATALOGUE, "cycle.csv": CYCLE}
    files = {name: text.replace(was, put, 1).encode() for name, text in texts.items()}
    (end,) = ran(Case(files, [words]), tmp_path)
    assert end.status == 2
    assert said in end.err


MAP_OF = "manufacturer: A\nfamily: F\ncommon: {kind: brushed}\n"
MAP_OF += "source: {document: d, confidence: quoted}\ncolumns: {No: part, V: nominal_voltage}\n"
PLATFORM = (STARTERS / "mecanum_platform.yaml").read_text(encoding="utf-8")
RECORDED = "name: r\nload: {kind: recorded, file: .}\nsupply: {nominal: 24 V}\n"
TAKEN = ["catalog", "import", "parts.csv", "--section", "motors", "--map", "map.yaml", "--dry-run"]
STUDY = ["study", "study.yaml", "-o", "out", "--no-maps"]


# files, the command, its exit status and what it says now
@pytest.mark.parametrize(
    ("files", "words", "status", "said"),
    [
        ({"robot.yaml": PLATFORM.replace("    turning_acceleration: 90 deg/s^2\n", "")}, SIZE, 2,
         "robot.yaml:28: platform.limits: turning takes both turning_speed and turning_acceleration; give both or"),
        ({"study.yaml": "spec: .\nvary: {load.mass: [1 kg]}\n"}, STUDY, 2,
         'study.yaml:1: spec: "." cannot be read (is a directory); expected a spec, its path'),
        ({"robot.yaml": RECORDED}, SIZE, 2, 'robot.yaml:2: load.file: "." cannot be read (is a directory); expected'),
        ({"parts.csv": "No,V,\x1b[2J\n,V,\nm1,24,\n", "map.yaml": MAP_OF}, TAKEN, 0,
         "left out: \\x1b[2J"),
    ],
)  # fmt: skip
def test_files_that_once_ended_wrongly(files, words, status, said, tmp_path):
    (end,) = ran(Case({name: text.encode() for name, text in files.items()}, [words]), tmp_path)
    assert said in end.out + end.err
    assert end.status == status


@pytest.mark.parametrize("seed", [20, 272])
def test_a_kept_file_of_another_layout_is_made_again(seed, tmp_path):
    """Both were estimates: one ended with status 130 and without a word, for the end of a file is Ctrl-D to typer."""
    assert judged(made("cache", seed), tmp_path)[::2] == (0, [])


# --- the campaign itself ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_inputs_changed_by_chance_end_in_a_result_or_in_one_line(kind, tmp_path):
    outcomes = [found_by(kind, seed, tmp_path) for seed in range(2 if kind in ("study", "cache") else 5)]
    assert not [outcome for outcome in outcomes if outcome.finds]
    assert kind in WEIGHTS


def test_a_seed_always_makes_the_same_input():
    assert made("spec", 5) == made("spec", 5) != made("spec", 6)


def test_an_input_is_shrunk_to_what_it_needs():
    case = Case({"a": b"one two\nthree four\nfive", "b": b"rest"}, [SIZE])
    small = shrunk(case, lambda other: b"three" in other.files.get("a", b""))
    assert small == Case({"a": b"three"}, [SIZE])


def test_a_fault_of_the_program_is_found(tmp_path, monkeypatch):
    def broken(*_: object) -> None:
        raise ZeroDivisionError("by chance")

    monkeypatch.setattr("drivesizer.spec.machine.load_any", broken)
    ((find,),) = (judged(Case({"robot.yaml": SPEC.encode()}, [SIZE]), tmp_path)[2],)
    assert find.kind.startswith("commands/common.py:") and find.kind.endswith(" load ZeroDivisionError")
    assert find.seen == "by chance"
