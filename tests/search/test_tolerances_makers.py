"""A maker's own tolerances: out of its catalogue, before the default class and behind the spec's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from refusals import refusal
from scipy import stats

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.catalog_file import parse
from drivesizer.catalog.tables import joined
from drivesizer.catalog.tolerances import maker_tolerances_of
from drivesizer.catalog.view import split_actuators
from drivesizer.errors import CatalogError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.search.search import search
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.probabilities import SampledDrives, sample_drives, subject, uncertainty
from drivesizer.search.uncertainty.uncertain_figures import holding
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

# A motor without friction, whose nominal current is all that it can fail by. The makers' motors are alike but for the
# number and, so that the order is known, the mass.
MAKER = Path(__file__).with_name("tolerances_makers.yaml").read_text(encoding="utf-8")
SPEC = """\
name: hoist
load: {kind: hoist, mass: 0.3 kg, drum_diameter: 80 mm}
motion: {speed: 0.5 m/s, acceleration_time: 0.5 s, cruise_time: 1 s, rest_time: 1 s}
supply: {nominal: 36 V, regeneration: 100 %}
"""
# but for the torque constant
ALONE = "resistance: none, friction: none, dry_friction: none, rotor_inertia: none, thermal_resistance: none"
ACME = "tolerances:\n- {source: sheet, motor: {torque_constant: +- 5 %}}\n"
BOLT = "tolerances:\n- {source: bench, motor: {torque_constant: normal(3 %)}}\n"


def _maker(name: str, tolerances: str = "", mass: int = 320, *, overrides: bool = False) -> Catalog:
    text = MAKER.replace("NAME", name).replace("MASS", str(mass)) + tolerances
    text = text.replace("catalog: 1\n", "catalog: 1\noverrides: true\n") if overrides else text
    return parse(YamlSource(text, f"{name.lower()}.yaml"), name.lower(), "0")


def _spec(torque_constant: str = "") -> RobotSpec:
    own = f", torque_constant: {torque_constant}" if torque_constant else ""
    return read_spec(
        YamlSource(f"{SPEC}tolerances: {{motor: {{{ALONE}{own}}}, controller: {{losses: none}}}}\n", "hoist.yaml")
    )


@pytest.fixture(scope="module")
def makers() -> Catalog:
    """Three: two that say how far their torque constants may be off, and one that does not."""
    return joined([_maker("Acme", ACME, 320), _maker("Bolt", BOLT, 330), _maker("Coil", "", 340)])


def _sampled(spec: RobotSpec, catalog: Catalog, processes: int = 1) -> tuple[SampledDrives, dict[str, int]]:
    """All sets of a catalogue over samples, with their rows by the motor's number."""
    given = problem(spec, catalog)
    found = search(given, top=9, misses=0).evaluation
    rows = range(len(found.candidates.motor))
    result = sample_drives(given, {row: subject(found, row) for row in rows}, Sampling(4096, 1, None, processes))
    return result, {str(catalog.motors["part"][found.candidates.motor[row]]): row for row in rows}


def _needed(spec: RobotSpec, catalog: Catalog) -> float:
    """The least factor of the torque constant with which the motor's current is permitted: it falls as 1 / k_t."""
    found = search(problem(spec, catalog), top=1, misses=0).evaluation
    check = next(one for one in found.checks if one.name == "motor_nominal_current")
    return float(check.demand[0] / check.limit[0])


def _chance(result: SampledDrives, row: int) -> float:
    return result.examined([row])[row].reliability.probability


# --- sampling ----------------------------------------------------------------------------------------------------


def test_each_makers_motor_is_off_as_its_maker_says(makers: Catalog) -> None:
    """By how much of its class each passes is known in closed form: two of their own, one of the default class."""
    spec = _spec()
    result, row = _sampled(spec, makers)
    needed = _needed(spec, makers)
    assert 0.96 < needed < 0.99
    exact = {
        "Acme-1": (1.05 - needed) / 0.1,
        "Bolt-1": 1.0 - stats.norm.cdf((needed - 1.0) / 0.03),
        "Coil-1": (1.10 - needed) / 0.2,
    }
    for part, chance in exact.items():
        assert _chance(result, row[part]) == pytest.approx(chance, abs=1e-3), part
    assert max(exact.values()) - min(exact.values()) > 0.05  # one class for all would not do


def test_what_is_uncertain_names_maker_and_document(makers: Catalog) -> None:
    said = uncertainty(_sampled(_spec(), makers)[0])
    assert [(one.name, one.title, one.text, one.source) for one in said.assumptions] == [
        ("motor.torque_constant", "Motor torque constant", "+- 10 %", said.assumptions[0].source),
        ("motor.torque_constant (Acme)", "Motor torque constant, Acme", "+- 5 %", "Acme: Acme data sheet, 2026-05"),
        (
            "motor.torque_constant (Bolt)",
            "Motor torque constant, Bolt",
            "normal(3 %)",
            "Bolt: Bolt test bench, derived",
        ),
    ]
    assert "measured here" in said.assumptions[0].source  # and no class of a gearhead: there is none


def test_the_specs_class_counts_before_any_makers(makers: Catalog) -> None:
    spec = _spec("+- 4 %")
    result, row = _sampled(spec, makers)
    chances = {_chance(result, number) for number in row.values()}
    assert len(chances) == 1
    assert chances.pop() == pytest.approx((1.04 - _needed(spec, makers)) / 0.08, abs=1e-3)
    assert [(one.name, one.source) for one in uncertainty(result).assumptions] == [
        ("motor.torque_constant", "given in the spec")
    ]


def test_a_maker_that_takes_its_figures_as_printed_has_no_class() -> None:
    exact = _maker("Acme", ACME.replace("+- 5 %", "none"))
    result, row = _sampled(_spec(), exact)
    assert result.ready.assumptions == () and _chance(result, row["Acme-1"]) == 1.0


# --- gearheads, actuators, families ----------------------------------------------------------------------------------

WHOLE = Path(__file__).with_name("tolerances_makers_whole.yaml").read_text(encoding="utf-8")


def _held(catalog: Catalog, part: str, number: str) -> dict[str, str]:
    table = catalog.gearheads if part == "gearhead" else catalog.motors
    return {one.figure: one.text for one in holding(catalog, {}, part, table.rows[number])}


def test_a_statement_of_families_counts_before_one_of_all() -> None:
    catalog = split_actuators(parse(YamlSource(WHOLE, "whole.yaml"), "whole", "0"))
    assert _held(catalog, "gearhead", "G10") == {"efficiency": "-5 %..20 %", "inertia": "+- 8 %"}
    assert _held(catalog, "gearhead", "H10") == {"efficiency": "none", "inertia": "+- 8 %"}
    assert _held(catalog, "gearhead", "A20") == {"efficiency": "+- 30 %", "inertia": "+- 8 %"}  # inside the actuator
    assert _held(catalog, "motor", "A10")["resistance"] == "+- 3 %"
    assert _held(catalog, "motor", "A10")["torque_constant"] == "+- 10 %"  # of which nothing is said
    names = {one.name for one in holding(catalog, {}, "gearhead", catalog.gearheads.rows["A10"])}
    assert names == {"gearhead.efficiency (Whole A)", "gearhead.inertia (Whole)"}
    assert holding(catalog, {}, "gearhead", -1) == ()
    given = {("gearhead", "efficiency"): "+- 1 %"}
    texts = [one.text for one in holding(catalog, given, "gearhead", catalog.gearheads.rows["H10"])]
    assert texts == ["+- 1 %", "+- 8 %"]


# --- the file --------------------------------------------------------------------------------------------------------

_LINE = MAKER.count("\n") + 1
WRONG = [
    ("no list", "tolerances: 5\n", f"{_LINE}: tolerances", "expected a list"),
    ("no figure", "tolerances:\n- {source: sheet}\n", f"{_LINE + 1}: tolerances[1]",
     "expected motor or gearhead or controller, e.g. motor: {resistance: +- 10 %}"),
    ("no source", "tolerances:\n- {motor: {resistance: +- 5 %}}\n", f"{_LINE + 1}: tolerances[1]",
     '"source" is missing'),
    ("unknown source", "tolerances:\n- {source: shet, motor: {resistance: +- 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].source", '"shet" is not one of the file\'s sources (sheet, bench)'),
    ("unknown part", "tolerances:\n- {source: sheet, motors: {resistance: +- 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].motors", 'unknown key "motors"; did you mean "motor"?'),
    ("unknown figure", "tolerances:\n- source: sheet\n  motor: {resistence: +- 5 %}\n",
     f"{_LINE + 2}: tolerances[1].motor.resistence", 'unknown key "resistence"; did you mean "resistance"?'),
    ("figure of the other part", "tolerances:\n- {source: sheet, gearhead: {resistance: +- 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].gearhead.resistance", "expected one of efficiency, inertia"),
    ("no figures", "tolerances:\n- {source: sheet, motor: {}}\n", f"{_LINE + 1}: tolerances[1].motor",
     "expected resistance, torque_constant"),
    ("no tolerance", "tolerances:\n- {source: sheet, motor: {resistance: 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].motor.resistance",
     '"5 %" is no tolerance of a catalogue figure; expected +- 7 %, -10 %..30 %, 0.5..1.1 times, normal(5 %) or none'),
    ("in ohms", "tolerances:\n- {source: sheet, motor: {resistance: +- 5 ohm}}\n",
     f"{_LINE + 1}: tolerances[1].motor.resistance", '"ohm" is not per cent'),
    ("all of it", "tolerances:\n- {source: sheet, motor: {resistance: +- 100 %}}\n",
     f"{_LINE + 1}: tolerances[1].motor.resistance", "reaches 0 and below"),
    ("nothing", "tolerances:\n- {source: sheet, motor: {resistance: ~}}\n",
     f"{_LINE + 1}: tolerances[1].motor.resistance", '"" is no tolerance'),
    ("unknown family", "tolerances:\n- {source: sheet, families: [Acme 41], motor: {resistance: +- 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].families", '"Acme 41" is no family with a motor in this file; expected Acme 40'),
    ("family of another part", "tolerances:\n- {source: sheet, families: [Acme C], motor: {resistance: +- 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].families", '"Acme C" is no family with a motor in this file'),
    ("no families", "tolerances:\n- {source: sheet, families: [], motor: {resistance: +- 5 %}}\n",
     f"{_LINE + 1}: tolerances[1].families", "without the field it is of all of them"),
    ("twice",
     "tolerances:\n- {source: sheet, motor: {resistance: +- 5 %}}\n- {source: bench, motor: {resistance: +- 6 %}}\n",
     f"{_LINE + 2}: tolerances[2].motor.resistance", "motor resistance is given twice"),
    ("twice of a family", "tolerances:\n- {source: sheet, families: [Acme 40], motor: {resistance: +- 5 %}}\n"
     "- {source: bench, families: [Acme 40], motor: {resistance: +- 6 %}}\n",
     f"{_LINE + 2}: tolerances[2].motor.resistance", "motor resistance of Acme 40 is given twice"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "place", "said"), [w[1:] for w in WRONG], ids=[w[0] for w in WRONG])
def test_a_wrong_section_is_one_line_with_its_place(text: str, place: str, said: str) -> None:
    message = refusal(lambda: _maker("Acme", text), CatalogError)
    assert len(message) < 300
    assert message.startswith(f"acme.yaml:{place}: "), message
    assert said in message


# --- several catalogues ----------------------------------------------------------------------------------------------


def _documents(catalog: Catalog) -> list[tuple[str, str, str]]:
    return [(one.maker, one.tolerance, catalog.sources[one.source].document) for one in catalog.tolerances]


def _mine(tolerances: str, *, overrides: bool, rows: bool = True) -> Catalog:
    """Another file of the maker Acme."""
    text = MAKER.replace("NAME", "Acme").replace("MASS", "300").replace("data sheet", "letter") + tolerances
    if not rows:
        text = text[: text.index("motors:")] + tolerances
    text = text.replace("catalog: 1\n", f"catalog: 1\noverrides: {str(overrides).lower()}\n")
    return parse(YamlSource(text, "mine.yaml"), "mine", "1")


def test_an_overriding_catalogue_states_anew() -> None:
    first = _maker("Acme", ACME.replace("5 %}}", "5 %, resistance: +- 6 %}}"))
    mine = _mine(ACME.replace("5 %", "2 %"), overrides=True, rows=False)
    both = joined([first, mine])
    assert sorted(_documents(both)) == [("Acme", "+- 2 %", "Acme letter"), ("Acme", "+- 6 %", "Acme data sheet")]
    assert both.replaced == ("tolerance of Acme motor torque constant: mine in place of acme",)
    found = maker_tolerances_of(both.tolerances, "motor", "Acme", "Acme 40").values()
    assert {one.figure: one.tolerance for one in found} == {
        "torque_constant": "+- 2 %", "resistance": "+- 6 %"
    }  # fmt: skip
    with pytest.raises(
        CatalogError, match="tolerance of Acme motor torque constant is in two catalogues: acme and mine;"
    ):
        joined([first, _mine(ACME.replace("5 %", "2 %"), overrides=False, rows=False)])


def test_what_overrides_some_families_leaves_the_others() -> None:
    of_40 = ACME.replace("sheet,", "sheet, families: [Acme 40],")
    general = joined([_maker("Acme", ACME), _mine(of_40.replace("5 %", "2 %"), overrides=True)])
    for family, tolerance in (("Acme 40", "+- 2 %"), ("Acme 50", "+- 5 %")):
        (one,) = maker_tolerances_of(general.tolerances, "motor", "Acme", family).values()
        assert one.tolerance == tolerance
    special = joined([_maker("Acme", of_40), _mine(ACME.replace("5 %", "2 %"), overrides=True)])
    (one,) = maker_tolerances_of(special.tolerances, "motor", "Acme", "Acme 40").values()
    assert one.tolerance == "+- 2 %" and len(special.tolerances) == 1


# --- what ships, and how it is shown ---------------------------------------------------------------------------------


def test_what_ships_names_maker_and_document() -> None:
    catalog = load(["beckhoff", "robstride", "xiaomi", "maxon"])
    said = {(one.maker, one.figure): (one.tolerance, catalog.sources[one.source]) for one in catalog.tolerances}
    assert {key: tolerance for key, (tolerance, _) in said.items()} == {
        ("Beckhoff", "resistance"): "+- 10 %", ("Beckhoff", "torque_constant"): "+- 10 %",
        ("Beckhoff", "rotor_inertia"): "+- 10 %", ("RobStride", "resistance"): "+- 10 %",
        ("RobStride", "torque_constant"): "+- 10 %", ("Xiaomi", "resistance"): "+- 10 %",
        ("Xiaomi", "torque_constant"): "+- 2.7 %",
    }  # fmt: skip
    assert said["Beckhoff", "resistance"][1].url.endswith("am8100/1333724939.html")
    printed = np.array([0.054, 0.057])  # V rms per rpm, of which the mean stands in the file
    assert printed / printed.mean() == pytest.approx([0.973, 1.027], abs=5e-4)
    catalog = split_actuators(catalog)
    row = catalog.motors.rows["CyberGear"]
    assert [one.text for one in holding(catalog, {}, "motor", row)][:2] == ["+- 10 %", "+- 2.7 %"]
    assert {one.whose for one in holding(catalog, {}, "motor", catalog.motors.rows["118752"])} == {""}
