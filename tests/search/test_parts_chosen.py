"""Which encoder and controller go with a motor: those that are known to do, and advice where nobody asked for any."""

import re
from pathlib import Path

import pytest
from refusals import refusal
from specs import estimates_off

from drivesizer.catalog import load
from drivesizer.catalog.query import find, open_catalogs
from drivesizer.errors import CatalogError, InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.json.documents import plain
from drivesizer.output.parts import machine_parts
from drivesizer.sizing import explain, explained, size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

PARTS = Path(__file__).with_name("parts_chosen.yaml").read_text(encoding="utf-8")
FAN = """
name: a fan on the shaft
load: {kind: fan, inertia: 20 kg*cm^2, rated_torque: 0.3 N*m, rated_speed: 1500 rpm}
motion: {speed: 1200 rpm, acceleration_time: 2 s, cruise_time: 20 s}
supply: {nominal: 24 V, regeneration: 0.4, accepts: all}
select: {catalogs: [parts.yaml]}
"""


@pytest.fixture
def fan(tmp_path):
    """The fan, with encoders of the light motor and what is asked of one: 1200 rpm and 8400 electrical ones."""

    def of(light="E", needs="", catalog=PARTS, spec=FAN):
        (tmp_path / "parts.yaml").write_text(catalog.replace("LIGHT", light), encoding="utf-8")
        text = spec + (f"needs: {{{needs}}}\n" if needs else "")
        return read_spec(YamlSource(text, str(tmp_path / "fan.yaml")))

    return of


# At 1200 rpm = 20 turns/s an encoder of n lines gives 20 n Hz: 500 lines 10 kHz of 100, 4000 lines 80 kHz of 70.
@pytest.mark.parametrize(
    ("needs", "encoder"),
    [
        ("", "known"),  # the fewest are unknown, the next too slow
        ("encoder_counts: 150", "known"),
        ("encoder_counts: 501", "fine"),  # 4000 lines are too many per second
        ("encoder_counts: 8001", "finest unknown"),
        ("resolution_at_load: 0.12 deg", "fine"),  # 360 deg / 4 / 0.12 deg = 750 lines at least
        ("resolution_at_load: 0.19 deg", "known"),  # 474 at least
    ],
)
def test_the_encoder_with_the_fewest_counts_that_is_known_to_do(fan, needs, encoder):
    found = size(fan(needs=needs)).sets[0]
    assert found.encoder.part == encoder
    assert found.status == ("unknown" if "unknown" in encoder else "pass")


@pytest.mark.parametrize(
    ("inertia", "ramp", "encoder", "status"),
    [
        ("null", "2 s", "ring", "pass"),
        ("5000", "2 s", "wheel", "pass"),
        ("5000", "0.16 s", "ring", "pass"),
        ("5000", "0.14 s", "ring", "fail"),
    ],
)
def test_the_lightest_encoder_with_which_the_drive_passes(fan, inertia, ramp, encoder, status):
    """A wheel of 20 g and 5 kg·cm², behind a ring of 35 g where nobody prints its inertia.

    Of 20 A, 1.96 N·m, fan and friction take 0.22 N·m at 1200 rpm.

    20 + 0.9 kg·cm² in 0.16 s are 1.64 N·m, with the wheel 2.03; in 0.14 s they are 1.88 without it.
    """
    parts = PARTS.replace("max_frequency (kHz)]", "max_frequency (kHz), mass (g), inertia (g*cm^2)]")
    parts = re.sub(r"(?<=columns: \[part, counts_per_turn)(.*?    rows:\n).*?(?=controllers)",
                   rf"\1      - [ring, 500, 6000, 100, 35, 1]\n      - [wheel, 500, 6000, 100, 20, {inertia}]\n",
                   parts, flags=re.S).replace("      - [large, 10, 30, 50000, 5]\n", "")  # fmt: skip
    quick = FAN.replace("2 s", ramp).replace("nominal: 24 V", "nominal: 36 V")
    spec = fan(
        needs="encoder_counts: 450", catalog=parts, spec=quick.replace("yaml]", "yaml], controller: {part: known}")
    )
    (one,) = explain(spec, "light", "direct")
    assert (one.encoder.part, one.status) == (encoder, status)
    found = size(spec, top=1)
    assert [(s.encoder.part, s.status) for s in found.sets] == ([(encoder, status)] if status == "pass" else [])


def test_an_encoder_that_nobody_asked_for_decides_nothing(fan):
    """The light motor has one of unknown speed, or one that is too slow, or none: it is still the lighter."""
    for light in ("coarse unknown", "slow"):
        best = size(fan(light)).sets[0]
        assert (best.motor.part, best.status) == ("light", "pass")
        told = {check.name: check for check in best.checks if check.advice}
        assert set(told) == {"encoder_speed", "encoder_frequency"}
        assert told["encoder_speed"].status == ("unknown" if light != "slow" else "fail")
        assert "advice" in told["encoder_speed"].title and told["encoder_speed"].note
        asked = size(fan(light, "encoder_counts: 50"))
        assert (asked.sets[0].motor.part, asked.sets[0].status) == ("heavy", "pass")


@pytest.mark.parametrize(
    ("own", "controllers", "status"),
    [
        ("100", "5", "pass"),
        ("null", "5", "unknown"),
        ("100", "null", "unknown"),
        ("9.9", "null", "fail"),
        ("null", "0.0099", "unknown"),  # no controller that is listed counts so fast: it has none
        ("null", "null", "unknown"),
    ],
)
def test_one_unknown_limit_of_frequency_does_not_pass(fan, own, controllers, status):
    """500 lines at 1200 rpm are 10 000 per second, which encoder and controller must both count."""
    parts = PARTS.replace("[known, 500, 6000, 100]", f"[known, 500, 6000, {own}]").replace(", 5]", f", {controllers}]")
    spec = fan("known", "encoder_counts: 450", parts.replace("encoders: [E]", "encoders: [known]"))
    for one in explain(spec, "heavy", "direct"):
        assert one.encoder.part == "known"
        assert {check.name: check.status for check in one.checks}["encoder_frequency"] == status


@pytest.mark.parametrize(("no_load", "status"), [(2200, "pass"), (1600, "pass"), (1500, "unknown")])
def test_a_motor_of_no_permissible_speed_bears_what_its_maker_runs_it_at(fan, no_load, status):
    """1200 rpm, where 1600 without load / 1.3 are 1231, 1500 / 1.3 are 1154; of a nominal speed it would be 1500."""
    parts = PARTS.replace(", max_speed: 6000 rpm", "").replace("nominal_speed (rpm), ", "").replace(" 1500, 6,", " 6,")
    (one,) = explain(fan(catalog=parts.replace("2200, 300", f"{no_load}, 300")), "light", "direct")
    (speed,) = [check for check in one.checks if check.name == "motor_speed"]
    assert speed.status == status and "no permissible speed is printed" in speed.note
    (one,) = explain(fan(catalog=PARTS.replace(", max_speed: 6000 rpm", "")), "light", "direct")
    assert next(check.status for check in one.checks if check.name == "motor_speed") == "pass"


def test_a_stricter_demand_gives_no_lighter_set(fan):
    """What is asked for can only leave fewer sets."""
    masses = [size(fan("coarse unknown", f"encoder_counts: {n}" if n else "")).sets[0].mass for n in (0, 50, 150, 600)]
    assert masses == sorted(masses)


def test_the_controller_that_is_known_to_commutate_fast_enough(fan):
    """28 pole pairs at 1200 rpm are 33 600 rpm: 7000 are too few, and of the smallest they are not known.

    8400 rpm of 7 pole pairs are within what is assumed of it; one that prints as much goes before.
    """

    def turning(pole_pairs, large):
        without = PARTS.replace("[known, 8, 20, 50000, 5]", "[known, 8, 20, null, 5]")
        without = without.replace("[large, 10, 30, 50000, 5]", f"[large, 10, 30, {large}, 5]")
        return without.replace("pole_pairs: 7", f"pole_pairs: {pole_pairs}")

    cases = (
        (PARTS.replace("pole_pairs: 7", "pole_pairs: 28"), "known", "pass"), (PARTS, "known", "pass"),
        (turning(28, 32000), "small unknown", "unknown"), (turning(7, 8000), "small unknown", "pass"),
    )  # fmt: skip
    for text, controller, status in cases:
        found = size(fan(catalog=text)).sets[0]
        (speed,) = (check for check in found.checks if check.name == "controller_speed")
        assert (found.controller.part, found.status, speed.status) == (controller, status, status)
        assert ("no electrical speed is printed" in speed.note) == (controller == "small unknown")


@pytest.mark.parametrize(("heat", "volts"), [("155 degC, 1.1, 2.3", "pass"), ("null, null, null", "unknown")])
def test_a_controller_that_bears_its_peak_too_briefly_gives_way_to_a_larger_one(fan, heat, volts):
    """3.6 A at the end of 2 s, of which 3 A last and more 0.1 s: 10 A do, however warm the winding may be."""
    brief = PARTS.replace("peak_time: 10 s", "peak_time: 100 ms").replace("[known, 8, 20,", "[known, 3, 20,")
    brief = brief.replace("[small unknown, 5,", "[small unknown, 3,")
    limit, *resistances = heat.split(", ")
    brief = brief.replace("max_winding_temperature: 155 degC,", f"max_winding_temperature: {limit},")
    brief = brief.replace(", 98, 900, 1.1, 2.3, ", f", 98, 900, {', '.join(resistances)}, ")
    found = size(estimates_off(fan(catalog=brief)), top=1).sets[0]
    status = {check.name: check.status for check in found.checks}
    assert status["supply_voltage"] == volts  # with neither known nothing bounds the winding's resistance
    assert (found.controller.part, status["controller_peak_time"]) == ("large", "pass")


def test_a_mass_that_nobody_knows_is_not_nothing(fan):
    """Without a gearhead the motor is all there is: unknown, and ranked behind what is known."""
    unknown = PARTS.replace("25, 700, 300]", "25, 700, null]")
    result = size(fan(catalog=unknown))
    assert [one.motor.part for one in result.sets] == ["heavy", "light"]
    told = [plain(result)["sets"][n] for n in (0, 1)]
    assert [one["mass"] for one in told] == [0.4 + 0.020 + 0.045, None]  # with encoder and controller, assumed
    assert [one["objective"] for one in told] == [0.4 + 0.020 + 0.045, None]
    assert [one["objective"] for one in plain(size(fan(catalog=unknown), objective="price"))["sets"]] == [None, None]


SERVO = Path(__file__).with_name("parts_chosen_servo.yaml").read_text(encoding="utf-8")
ELBOW = """
name: elbow
load: {kind: arm, mass: 0.8 kg, length: 0.25 m}
motion: {speed: 60 deg/s, acceleration_time: 0.4 s, cruise_time: 1 s, rest_time: 2 s, there_and_back: true}
supply: {nominal: %s V, accepts: all}
select: {catalogs: [servo.yaml], estimates: off%s}
"""


@pytest.fixture
def elbow(tmp_path):
    (tmp_path / "servo.yaml").write_text(SERVO, encoding="utf-8")

    def spec(volts, select=""):
        return read_spec(YamlSource(ELBOW % (volts, select), str(tmp_path / "robot.yaml")))

    return spec


def parts_of(found):
    return sorted(one.motor.part for one in (*found.sets, *found.misses))


@pytest.mark.parametrize(
    ("volts", "row", "limit"),
    [(12, "12 V", 2.0), (15, "15 V", 2.5), (10.5, "9 V", 1.5), (13, "12 V", 2.0), (14, "15 V", 2.5), (16, "15 V", 2.5)],
)
def test_of_one_part_the_row_at_the_voltage_counts(elbow, volts, row, limit):
    """One servo with figures at three voltages is one drive, and what one buys is S-7; of two as near the lower."""
    found = size(elbow(volts), top=9)
    assert parts_of(found) == [f"S-7 {row}", "S-8"]
    (one,) = (x for x in (*found.sets, *found.misses) if x.motor.part != "S-8")
    line = machine_parts(one, found.problem)[0]
    assert (line.order_number, line.part) == ("S-7", f"S-7 {row}")
    for name in ("S-7", "S-7 15 V", "s7", "sx7-B", "SX 7 a"):
        (same,) = explained(elbow(volts), name).sets
        assert same.motor.part == f"S-7 {row}"
        assert next(c for c in same.checks if c.name == "gearhead_continuous_torque").limit == limit
        assert parts_of(size(elbow(volts, f", motor: {{part: {name}}}"))) == [f"S-7 {row}"]
    said = f"the figures of S-7 are those at {row}, of those of its maker the nearest to {volts:g} V"
    assert (said in explained(elbow(volts), "S-7").warnings) == (f"{volts:g} V" != row)
    assert parts_of(size(elbow(volts, ", motor: {part: S*}"))) == [f"S-7 {row}", "S-8"]


EIGHT = "- [S-8,      ~,   ~,              12, 60, 0.1, 2.6, 0.9, 9.4,  4.5, 9.4,  4.5, 9, 2.65]"


def test_several_parts_of_one_name_are_named(tmp_path, elbow):
    spec = elbow(12)
    text = SERVO.replace(EIGHT, f"{EIGHT.replace('S-8', 'S 8')}\n      {EIGHT}")
    (tmp_path / "servo.yaml").write_text(text, encoding="utf-8")
    assert explained(spec, "S 8").sets[0].motor.part == "S 8"
    with pytest.raises(InputError, match='motor "s8" is several parts; expected one of S 8, S-8'):
        explained(spec, "s8")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('S-7, "SX7-A; SX7-B", 15,', "S-7, ~, 12,", '"S-7 15 V" and "S-7 12 V" are "S-7" at 12 V; give one'),
        ('S-7, "SX7-A; SX7-B", 9,', "S-7, ~, ~,", 'order_number "S-7" needs nominal_voltage'),
    ],
)
def test_rows_of_one_part_have_a_voltage_each(tmp_path, old, new, said):
    file = tmp_path / "servo.yaml"
    assert old in SERVO
    file.write_text(SERVO.replace(old, new), encoding="utf-8")
    assert f"{file}:" in refusal(lambda: load([str(file)]), CatalogError, match=said)


@pytest.mark.parametrize("name", ["STS3215", "st3215", "ST-3215-C001", "sts 3215 c001"])
def test_one_servo_by_all_its_names(name):
    (hit,) = find(open_catalogs(["feetech", "robotis"]), name)
    assert (hit.part, hit["no_load_current"]) == ("ST-3215-C001", 0.15)


def test_a_servo_at_12_v_has_its_figures_of_12_v(tmp_path):
    """0.9 kg at 0.27 m: 2.38 N*m at its most; a fifth of the stall is 10.6 / 5 at 12 V and 12.9 / 5 at 14.8 V."""
    text = ELBOW.replace("0.8 kg, length: 0.25 m", "0.9 kg, length: 0.27 m, start_angle: -45 deg") % ("12", "")
    spec = read_spec(YamlSource(text.replace("servo.yaml", "robotis").replace(", estimates: off", ""), "robot.yaml"))
    best = size(spec, top=1).sets[0]
    limit = next(c for c in best.checks if c.name == "gearhead_continuous_torque")
    assert (best.motor.part, best.motor.order_number) == ("XM540-W270 12 V", "XM540-W270")
    assert limit.limit == pytest.approx(2.12) and 0.0 < limit.margin < 0.02
