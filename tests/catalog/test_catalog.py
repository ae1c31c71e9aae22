"""The catalogue's schema: what a good file becomes, and what is said about a wrong one."""

# ruff: noqa: E501 - the tables of wrong files are read best with one case on a line

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refusal

from drivesizer.catalog import PARTS, Catalog, load, shipped
from drivesizer.catalog.catalog_file import parse
from drivesizer.catalog.parts import printed
from drivesizer.catalog.tables import joined
from drivesizer.catalog.view import search_view
from drivesizer.errors import CatalogError, InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import candidates

ACME = Path(__file__).with_name("acme.yaml").read_text(encoding="utf-8")


def acme(text: str = ACME, name: str = "acme") -> Catalog:
    return parse(YamlSource(text, f"{name}.yaml"), name, "0")


def changed(old: str, new: str) -> str:
    assert ACME.count(old) == 1, f"{old!r} must be in the file once"
    return ACME.replace(old, new)


def pairs(catalog: Catalog, right: str = "gearhead") -> dict[tuple[str, str], str]:
    """Which parts go together, by part number, and the document that says so."""
    found = getattr(catalog, f"motor_{right}")
    motors, others = catalog.motors["part"], catalog.table(f"{right}s")["part"]
    triples = zip(found.left, found.right, found.source, strict=True)
    return {(str(motors[m]), str(others[g])): catalog.sources[s].document for m, g, s in triples}


# --- a good file ---------------------------------------------------------------------------------------------------


def test_figures_are_si_floats() -> None:
    motor = acme().motors.record(0)
    assert (motor.part, motor.family, motor.manufacturer, motor.kind) == ("M40-24", "M40", "Acme", "brushed")
    assert motor.nominal_voltage == 24.0
    assert motor.stall_torque == pytest.approx(2.27)
    assert motor.mass == pytest.approx(0.48)
    assert motor.diameter == pytest.approx(0.04)
    assert motor.ambient_min == pytest.approx(253.15)


def test_an_unknown_figure_is_nan_and_an_unknown_text_is_empty() -> None:
    motors = acme().motors
    assert np.isnan(motors["mass"][motors.rows["M40-48"]])  # written ~
    assert np.isnan(motors["resistance"]).all()  # not in any table
    assert motors["bearing"].tolist() == ["", "", "ball bearings", ""]


def test_a_ratio_is_the_exact_fraction() -> None:
    assert acme().gearheads["ratio"].tolist() == [26 / 7, 676 / 49, 5.0]


def test_compatibility_by_family_part_and_triple() -> None:
    sheet, copy = "Acme M40, rev. C", "a table that somebody copied"
    assert pairs(acme()) == {
        ("M40-24", "4201"): sheet,  # stated twice: the first source counts
        ("M40-24", "4202"): sheet,
        ("M40-24", "6201"): copy,
        ("M40-48", "4201"): sheet,
        ("M40-48", "4202"): sheet,
        ("M60-24", "4201"): copy,
        ("M60-24", "4202"): sheet,  # left out by `without`, stated by the triple
        ("M60-24", "6201"): copy,
        ("M60-X", "4201"): copy,
        ("M60-X", "6201"): copy,
    }
    assert pairs(acme(), "encoder") == {
        ("M40-24", "E-500"): copy,
        ("M40-48", "E-500"): copy,
        ("M60-24", "E-500"): sheet,
    }


def test_confidence_is_the_sources_until_a_note_changes_it() -> None:
    catalog = acme()
    first, second = catalog.confidence("motors", 0), catalog.confidence("motors", 1)
    assert set(first.values()) == {"quoted"}
    assert {name for name, value in second.items() if value != "quoted"} == {"stall_torque"}
    assert second["stall_torque"] == "derived"
    assert "mass" in first and "mass" not in second  # unknown figures have no confidence
    assert set(catalog.confidence("motors", 2).values()) == {"secondary"}


def test_an_excluded_part_stays_in_the_file_and_is_not_offered() -> None:
    motors = acme().motors
    assert motors["part"][motors.excluded].tolist() == ["M60-X"]
    assert motors["part"][motors.named({})].tolist() == ["M40-24", "M40-48", "M60-24"]
    assert motors["part"][motors.named({"family": ["M60"]})].tolist() == ["M60-24"]


def test_no_candidate_holds_an_excluded_part(spec, catalog: Catalog) -> None:
    free = spec.model_copy(update={"select": type(spec.select)()})
    found = candidates(problem(free, catalog))
    assert len(found.motor) > 50_000
    assert not catalog.motors.excluded[found.motor].any()
    assert not catalog.gearheads.excluded[found.gearhead].any()


# --- compatibility, against sets written out in plain Python -------------------------------------------------------

NAMES = {"motors": {"F": ["f1", "f2"], "H": ["h1", "h2", "h3"]}, "gearheads": {"P": ["p1", "p2", "p3"], "S": ["s1"]}}


def _group(left: list[str], right: list[str], without: list[str]) -> str:
    out = f", without: [{', '.join(without)}]" if without else ""
    return f"  - {{source: s, motors: [{', '.join(left)}], gearheads: [{', '.join(right)}]{out}}}\n"


def _choices(section: str, least: int = 1) -> st.SearchStrategy[list[str]]:
    families = NAMES[section]
    return st.lists(
        st.sampled_from([*families, *(part for parts in families.values() for part in parts)]),
        min_size=least,
        max_size=4,
    )


@settings(max_examples=60)
@given(st.lists(st.tuples(_choices("motors"), _choices("gearheads"), _choices("gearheads", 0)), max_size=4))
def test_groups_multiply_out(groups: list[tuple[list[str], list[str], list[str]]]) -> None:
    text = 'catalog: 1\nmanufacturer: A\nsources: {s: {document: "A", confidence: quoted}}\n'
    for section, families in NAMES.items():
        text += f"{section}:\n"
        for family, parts in families.items():
            rows = ", ".join(f"[{part}]" for part in parts)
            text += f"- {{family: {family}, source: s, columns: [part], rows: [{rows}]}}\n"
    text += "compatibility:\n  motor_gearhead:\n" + "".join(_group(*g) for g in groups) if groups else ""

    def members(section: str, names: list[str]) -> set[str]:
        return {part for name in names for part in NAMES[section].get(name, [name])}

    expected = {
        (m, g)
        for left, right, without in groups
        for m in members("motors", left)
        for g in members("gearheads", right) - members("gearheads", without)
    }
    catalog = acme(text)
    assert set(pairs(catalog)) == expected
    assert len(catalog.motor_gearhead.left) == len(expected)  # each pair once


# --- several catalogues as one -------------------------------------------------------------------------------------

OTHER = """\
catalog: 1
manufacturer: Other
sources:
  page: {document: "Other, page 7", confidence: secondary}
motors:
- {family: Z, source: page, columns: [part, mass (g)], rows: [["Z1", 10], ["Z2", 20], ["Z3", 30]]}
gearheads:
- {family: Y, source: page, columns: [part, ratio], rows: [["Y1", 10], ["Y2", 20]]}
compatibility:
  motor_gearhead:
  - {source: page, motors: ["Z3"], gearheads: ["Y1"]}
  - {source: page, motors: ["Z1"], gearheads: [Y]}
"""


def test_joined_catalogues_keep_parts_pairs_and_sources() -> None:
    one, two = acme(), acme(OTHER, "other")
    for several in ([one, two], [two, one]):
        both = joined(several)
        for right in ("gearhead", "encoder"):
            assert pairs(both, right) == pairs(one, right) | pairs(two, right)
        for catalog in several:
            for row, part in enumerate(catalog.motors["part"]):
                there = both.motors.rows[str(part)]
                assert repr(both.motors.record(there)) == repr(catalog.motors.record(row))  # repr: NaN equals NaN
                assert both.confidence("motors", there) == catalog.confidence("motors", row)
                assert both.motors.excluded[there] == catalog.motors.excluded[row]
    assert both.digests == {"acme": "0", "other": "0"}


def test_a_part_that_two_catalogues_give_is_an_error() -> None:
    clash = OTHER.replace('["Z1", 10]', '["M40-24", 10]').replace('motors: ["Z1"]', 'motors: ["Z2"]')
    with pytest.raises(CatalogError, match='part "M40-24" is in two catalogues: acme and other'):
        joined([acme(), acme(clash, "other")])


def test_loading_by_name_and_by_file(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(OTHER)
    both = load(["maxon", "own.yaml"], beside=tmp_path)
    assert both.motors["part"][-3:].tolist() == ["Z1", "Z2", "Z3"]
    assert set(both.digests) == {"maxon", "own"}
    assert "maxon" in shipped()


@pytest.mark.parametrize(("name", "said"), [
    ("maxom", 'no catalogue is called "maxom"; the nearest is maxon'),
    ("Dynamixel", 'no catalogue is called "Dynamixel"; it is a maker or a family in robotis; expected'),
    ("absent.yaml", "absent.yaml: cannot be read (no such file or directory)"),
])  # fmt: skip
def test_a_catalogue_that_is_not_there(tmp_path: Path, name: str, said: str) -> None:
    assert said in refusal(lambda: load([name], beside=tmp_path))


def test_all_catalogues_that_are_not_there_are_named_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        load(["maxom", "maxon", "absent.yaml", "lost.csv"], beside=tmp_path)
    assert [line.partition(": ")[0].rpartition("/")[2] for line in caught.value.lines] == [
        'no catalogue is called "maxom"; the nearest is maxon; expected one of `drivesizer catalog stats`, such as maxon, '
        "all, a .yaml file, or a price list, .csv or .xlsx", "absent.yaml", "lost.csv",
    ]  # fmt: skip


# --- wrong files: one line with file, line, field, what was found, what is expected ---------------------------------

WRONG = [
    # what, old text, new text, place, what is said
    ("unknown key", "- family: M40", "- famly: M40", '7: motors[1].famly', 'unknown key "famly"; did you mean "family"?'),
    ("unknown section", "encoders:\n", "sensors:\n", "37: sensors", 'unknown key "sensors"; did you mean "encoders"?'),
    ("missing key", "  source: sheet\n  common", "  common", "7: motors[1]", '"source" is missing'),
    ("missing unit", "mass (g)]", "mass]", "10: motors[1].columns[4]", "mass needs its unit in brackets, e.g. mass (g)"),
    ("unit of another kind", "mass (g)]", "mass (mm)]", "10: motors[1].columns[4]", '"mm" is a unit of length, not of mass'),
    ("unit on a ratio", "ratio, reduction", "ratio (rpm), reduction", "28: gearheads[1].columns[2]", 'ratio has no unit, found "rpm"'),
    ("bare common", "diameter: 40 mm", "diameter: 40", "9: motors[1].common.diameter", '"40" has no unit; expected length'),
    ("cell too few", '24, 2270, 480]', "24, 2270]", "12: motors[1].rows[1]", "expected 4 cells as in `columns`, found 3"),
    ("text for a number", "24, 2270, 480]", "24, strong, 480]", "12: motors[1].rows[1][3]", '"strong" is not a number; unknown is written ~'),
    ("not a number", "24, 2270, 480]", "24, .nan, 480]", "12: motors[1].rows[1][3]", '".nan" is not a number'),
    ("negative", "24, 2270, 480]", "24, -2270, 480]", "12: motors[1].rows[1][3]", 'stall_torque "-2270" is below 0'),
    ("ratio of zero", "26/7", "0/7", "30: gearheads[1].rows[1][2]", "ratio"),
    ("endless fraction", "26/7", f'"{"9" * 5000}/7"', "30: gearheads[1].rows[1][2]", "ratio"),
    ("unknown source", "  source: sheet\n  common", "  source: sheat\n  common", "8: motors[1].source", '"sheat" is not one of the file\'s sources (sheet, copy)'),
    ("duplicate part", '["6201", 5]', '["4201", 5]', "36: gearheads[2].rows[1]", 'part "4201" is given twice'),
    ("part is a number with a point", '["6201", 5]', "[62.01, 5]", "36: gearheads[2].rows[1][1]", '"62.01" is not a part number; quote it'),
    ("no part column", "columns: [part, ratio]", "columns: [reduction, ratio]", "34: gearheads[2].columns", "a table needs the column `part`"),
    ("column twice", "columns: [part, ratio]", "columns: [part, part]", "34: gearheads[2].columns", "every column once"),
    ("column and common", "diameter: 40 mm", "mass: 40 g", "9: motors[1].common.mass", "mass is a column of this table as well; give it once"),
    ("family as a column", "columns: [part, ratio]", "columns: [part, family]", "34: gearheads[2].columns[2]", "family stands at the head of its table"),
    ("unknown confidence", "confidence: quoted}", "confidence: certain}", "4: sources.sheet", 'confidence "certain" is not one of measured, quoted, secondary, derived, recalled'),
    ("source without document", 'document: "Acme M40, rev. C", ', "", "4: sources.sheet", '"document" is missing'),
    ("no sources", ACME[ACME.index("  sheet:") : ACME.index("motors:\n")], "", "3: sources", "expected at least one, e.g. sheet: {document:"),
    ("note on an unknown part", 'parts: ["M40-48"], fields', 'parts: ["M40-49"], fields', "15: motors[1].notes[1].parts", '"M40-49" is not a part of this table'),
    ("note on an unknown field", "fields: [stall_torque]", "fields: [stall_torqe]", "15: motors[1].notes[1].fields", '"stall_torqe" is not a figure of this table'),
    ("exclude is not true or false", "exclude: true", "exclude: yes", "24: motors[2].notes[1].exclude", '"yes" is not true or false'),
    ("unknown name", "motors: [M40], gearheads: [G42]", "motors: [M40], gearheads: [G43]", "45: compatibility.motor_gearhead[1].gearheads[1]", '"G43" is neither a family nor a part of this catalogue; the nearest is G42'),
    ("unknown relation", "  triples:\n", "  tripels:\n", "49: compatibility.tripels", 'did you mean "triples"?'),
    ("wrong schema", "catalog: 1\n", "catalog: 2\n", "1: catalog", 'schema "2" is not known; expected 1'),
    ("rows are no list", 'rows:\n  - ["6201", 5]', "rows: 6201", "35: gearheads[2].rows", "expected a list"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "place", "said"), [w[1:] for w in WRONG], ids=[w[0] for w in WRONG])
def test_a_wrong_file_is_one_line_with_its_place(old: str, new: str, place: str | None, said: str) -> None:
    message = refusal(lambda: acme(changed(old, new)), (CatalogError, InputError))
    assert len(message) < 400
    assert message.startswith(f"acme.yaml:{place}: " if place else "acme.yaml:"), message
    assert said in message


def test_every_column_needs_its_unit() -> None:
    """No field of any part can be given as a bare number, except ratios and plain numbers."""
    for section in PARTS:
        for name, column in printed(section).items():
            if column.kind in ("text", "ratio", "dimensionless"):
                continue
            text = (
                'catalog: 1\nmanufacturer: A\nsources: {s: {document: "A", confidence: quoted}}\n'
                f"{section}:\n- {{family: F, source: s, columns: [part, {name}], rows: [[x, 1]]}}\n"
            )
            with pytest.raises(CatalogError, match=f"{name} needs its unit in brackets"):
                acme(text)


def _bomb(depth: int) -> str:
    """Nine aliases to nine aliases to nine ...: 9**depth strings, were it expanded."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, depth)]
    return "\n".join(lines) + "\n"


HOSTILE = [
    ("bomb of aliases", _bomb(30), 1, "anchors and aliases"),
    ("not UTF-8", ACME.encode().replace(b"somebody", b"somebod\xfd"), 5, "the file is not UTF-8 text"),
    ("second document", ACME.replace("\nencoders:", "\n---\nencoders:"), 37, "a second document"),
    ("nothing", "", None, "expected fields such as catalog, manufacturer, sources"),
]


@pytest.mark.parametrize(("content", "line", "said"), [h[1:] for h in HOSTILE], ids=[h[0] for h in HOSTILE])
def test_a_hostile_file_is_one_line(tmp_path: Path, content: str | bytes, line: int | None, said: str) -> None:
    path = tmp_path / "acme.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    message = refusal(lambda: load([str(path)]), (CatalogError, InputError))
    assert "\x1b" not in message
    assert len(message) < 400 + len(str(path))
    assert message.startswith(f"{path}:{line}: " if line else f"{path}: "), message
    assert said in message


@pytest.mark.parametrize("newline", ["\r\n", "\n"])
@pytest.mark.parametrize("head", ["", "\ufeff"])
def test_line_ends_and_byte_order_mark_do_not_matter(tmp_path: Path, newline: str, head: str) -> None:
    path = tmp_path / "acme.yaml"
    path.write_bytes((head + ACME.replace("\n", newline)).encode())
    assert pairs(load([str(path)])) == pairs(acme())


# --- parts of another catalogue --------------------------------------------------------------------------------------

GUEST = """
catalog: 1
manufacturer: Guest
sources: {sheet: {document: sheet, confidence: quoted}}
motors:
  - {family: GM, source: sheet, columns: [part, torque_constant (mN*m/A), shaft_diameter (mm)], rows: [[GM-1, 40, 9]]}
gearheads:
  - {family: GH, source: sheet, common: {mounting: clamping hub}, columns: [part, ratio, max_motor_shaft (mm)],
     rows: [[GH-5, 5, 11], [GH-7, 7, 8], [GH-9, 9, 19]]}
compatibility:
  motor_gearhead:
    - {source: sheet, motors: [GM], gearheads: [{maxon: GP 26 A}]}
    - {source: sheet, motors: [{maxon: "118752"}, {faulhaber: no such family}], gearheads: [GH-5]}
"""


def named(catalog: Catalog) -> set[tuple[str, str]]:
    found = catalog.motor_gearhead
    return {
        (str(catalog.motors["part"][a]), str(catalog.gearheads["part"][b]))
        for a, b in zip(found.left, found.right, strict=True)
    }


@pytest.fixture
def guest(tmp_path: Path) -> Path:
    (tmp_path / "guest.yaml").write_text(GUEST)
    return tmp_path


def test_a_list_may_name_parts_of_another_catalogue(guest: Path, catalog: Catalog) -> None:
    both = load(["maxon", "guest.yaml"], beside=guest)
    mine = {pair for pair in named(both) if pair[0] == "GM-1" or pair[1] == "GH-5"}
    family = catalog.gearheads["part"][catalog.gearheads["family"] == "GP 26 A"].tolist()
    assert mine == {("GM-1", part) for part in family} | {("118752", "GH-5")}
    assert load(["maxon", "guest.yaml"], beside=guest).motor_gearhead.left.tolist() == both.motor_gearhead.left.tolist()


def test_a_misspelt_part_of_a_catalogue_that_is_loaded_is_an_error(guest: Path) -> None:
    (guest / "guest.yaml").write_text(GUEST.replace("GP 26 A", "GP 26 AA"))
    with pytest.raises(CatalogError, match=r"GP 26 AA.*is no family or part of maxon.*GP 26 A"):
        load(["maxon", "guest.yaml"], beside=guest)


def test_a_clamping_hub_takes_the_shafts_that_it_holds(guest: Path) -> None:
    """A 9 mm shaft: the 11 mm hub with a bushing; not the 8 mm one, not the 19 mm one; unknown shafts with none."""
    found = named(search_view(load(["maxon", "guest.yaml"], beside=guest)))
    assert {pair for pair in found if pair[1].startswith("GH")} == {("GM-1", "GH-5"), ("118752", "GH-5")}
