"""A motor that drives the load itself: no gearhead, no limit of one, and the same physics at ratio 1."""

import json
import math
from pathlib import Path

import pytest

from drivesizer.catalog import load
from drivesizer.errors import CatalogError, InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

MOTORS = Path(__file__).with_name("direct.yaml").read_text(encoding="utf-8")
FAN = """
name: a fan on the shaft
load: {kind: fan, inertia: 20 kg*cm^2, rated_torque: 0.3 N*m, rated_speed: 1500 rpm}
motion: {speed: 1200 rpm, acceleration_time: 2 s, cruise_time: 20 s}
supply: {nominal: 24 V, regeneration: 0.4, accepts: all}
select: {catalogs: [CATALOGS]}
"""


@pytest.fixture
def direct(tmp_path):
    for name in ("one", "two"):
        text = MOTORS.replace("NAME", name).replace("PART", f"{name}-90")
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    return tmp_path


def test_the_motor_alone_is_a_set(direct):
    among = FAN.replace("CATALOGS]", f"{direct}/one.yaml, maxon], motor: {{family: [D, EC-i 40, RE 40]}}")
    result = size(read_spec(YamlSource(among, "fan.yaml")), top=500)
    assert len({s.motor.family for s in result.sets}) > 1
    found = next(s for s in result.sets if s.gearhead.kind == "direct")
    assert found.label == "D one-90 without gearhead"
    assert found.total_ratio == 1.0
    assert not [c for c in found.checks if c.name.startswith("gearhead") and c.limit == math.inf]
    speed = next(c for c in found.checks if c.name == "motor_speed")
    assert speed.demand * 30 / math.pi == pytest.approx(1200, rel=1e-12)
    torque = 0.3 * (1200 / 1500) ** 2 + 20e-4 * (1200 * math.pi / 30) / 2  # at the end of the ramp, by hand
    rotor = 900e-7 * (1200 * math.pi / 30) / 2
    friction = 98e-3 * 0.3 * (0.55 + 0.45 * 1200 / 2200)  # a brushless motor's, part of it growing with speed
    peak = next(c for c in found.checks if c.name == "controller_peak_current").demand
    assert peak == pytest.approx((torque + rotor + friction) / 98e-3, rel=1e-9)


def test_direct_is_no_name_for_a_motor(direct):
    path = direct / "one.yaml"
    path.write_text(path.read_text(encoding="utf-8").replace("gearheads: [direct]", "gearheads: [direkt]"), "utf-8")
    with pytest.raises(CatalogError, match=r"direkt.* is neither a family nor a part"):
        load([str(path)])


def test_a_catalogue_of_ones_own_may_replace_parts(direct):
    mine = (direct / "one.yaml").read_text(encoding="utf-8").replace("2.3, 25, 700", "1.9, 25, 700")
    (direct / "mine.yaml").write_text(mine, encoding="utf-8")
    names = [str(direct / name) for name in ("two.yaml", "one.yaml", "mine.yaml")]
    with pytest.raises(CatalogError, match=r"one-90.* is in two catalogues: one and mine; `overrides: true`"):
        load(names)
    (direct / "mine.yaml").write_text(mine.replace("catalog: 1", "catalog: 1\noverrides: true"), encoding="utf-8")
    for _ in range(2):  # read, and from the compiled files
        both = load(names)
        assert both.replaced == ("motor one-90: mine in place of one",)
        assert both.motors["part"].tolist() == ["two-90", "one-90"]
        assert both.motors.record(1).thermal_resistance_housing == 1.9
        assert both.sources[both.motors.source[1]].document == "a sheet"
        pairs = list(zip(both.motor_gearhead.left.tolist(), both.motor_gearhead.right.tolist(), strict=True))
        assert pairs == [(0, 0), (1, 0)]
    spec = read_spec(YamlSource(FAN.replace("CATALOGS", ", ".join(names)), "fan.yaml"))
    assert "motor one-90: mine in place of one" in size(spec).warnings


def test_a_catalogue_may_be_named_at_the_command_line(direct, monkeypatch, run):
    (direct / "fan.yaml").write_text(
        FAN.replace("[CATALOGS]", "[two.yaml, maxon], gearhead: {part: direct}"), encoding="utf-8"
    )
    monkeypatch.chdir(direct)
    for more, parts in (([], {"two-90"}), (["--catalog", "one.yaml"], {"one-90", "two-90"})):
        status, out, _ = run("size", "fan.yaml", "--json", *more)
        assert status == 0
        assert {s["motor"]["part"] for s in json.loads(out)["axes"][0]["result"]["sets"]} == parts


def test_a_partner_of_a_catalogue_that_is_not_loaded_is_left_out_alone(direct):
    """The motor still drives the load directly, as the same row says; what is left out is told."""
    path = direct / "one.yaml"
    text = path.read_text(encoding="utf-8").replace("gearheads: [direct]", "gearheads: [direct, {maxon: GP 42 C}]")
    path.write_text(text, encoding="utf-8")
    alone = size(read_spec(YamlSource(FAN.replace("CATALOGS", str(path)), "fan.yaml")))
    assert [one.label for one in alone.sets] == ["D one-90 without gearhead"]
    assert any("GP 42 C of maxon, which is not among the catalogues" in said for said in alone.warnings)
    among = FAN.replace("CATALOGS]", f"{path}, maxon], motor: {{family: D}}")
    both = size(read_spec(YamlSource(among, "fan.yaml")), top=1)
    assert not any("not among the catalogues" in said for said in both.warnings)
    assert both.counts.considered > 1


UNLISTED = MOTORS.partition("compatibility:")[0]  # nobody says that this motor drives anything
ALONE = FAN.replace("supply:", "transmission: [{kind: direct}]\nsupply:")
RAMP = 1200 * math.pi / 30 / 2  # rad/s^2


@pytest.fixture
def unlisted(tmp_path):
    path = tmp_path / "one.yaml"
    path.write_text(UNLISTED.replace("NAME", "one").replace("PART", "one-90"), encoding="utf-8")
    return path


def spec_of(text, *catalogs):
    return read_spec(YamlSource(text.replace("CATALOGS", ", ".join(map(str, catalogs))), "fan.yaml"))


def peak_current(one):
    return next(c for c in one.checks if c.name == "controller_peak_current").demand


@pytest.mark.parametrize(("ratio", "efficiency"), [(1.0, 1.0), (1.5, 0.95)])
def test_any_motor_drives_the_load_or_its_belt_where_the_spec_says_so(unlisted, ratio, efficiency):
    belt = f", {{kind: belt, ratio: {ratio}, efficiency: {efficiency}}}" if ratio != 1.0 else ""
    result = size(spec_of(ALONE.replace("direct}", "direct}" + belt), unlisted))
    assert [(one.label.split(" without")[0], one.gearhead.kind) for one in result.sets] == [("D one-90", "direct")]
    one = result.sets[0]
    assert one.total_ratio == ratio
    speed = next(c for c in one.checks if c.name == "motor_speed")
    assert speed.demand * 30 / math.pi == pytest.approx(1200 * ratio, rel=1e-12)
    load = 0.3 * (1200 / 1500) ** 2 + 20e-4 * RAMP  # N*m, at the end of the ramp, by hand
    rotor = 900e-7 * RAMP * ratio
    friction = 98e-3 * 0.3 * (0.55 + 0.45 * 1200 * ratio / 2200)  # a brushless motor's, part of it by speed
    torque = load / ratio / efficiency + rotor + friction
    assert peak_current(one) == pytest.approx(torque / 98e-3, rel=1e-9)


def test_only_motors_without_gearhead_are_candidates_of_direct_drive(unlisted):
    """Every motor that is for sale, once; with a gearhead, the listed pairs as ever."""
    maxon = load(["maxon"])
    assert size(spec_of(ALONE, "maxon")).counts.considered == int((~maxon.motors.excluded).sum())
    assert size(spec_of(FAN, unlisted)).counts.considered == 0


def test_what_pulls_at_the_shaft_is_the_motors_to_carry(unlisted):
    text = ALONE + "needs: {radial_load: 50 N}\n"
    load_check = next(c for c in explain(spec_of(text, unlisted), "one-90", "direct")[0].checks if "radial" in c.name)
    assert (load_check.name, load_check.status) == ("motor_radial_load", "unknown")
    sheet = unlisted.read_text(encoding="utf-8").replace(
        "max_speed: 3000 rpm", "max_speed: 3000 rpm, max_radial_load: LOAD"
    )
    for newtons, status in (("49 N", "fail"), ("51 N", "pass")):
        unlisted.write_text(sheet.replace("LOAD", newtons), encoding="utf-8")
        found = explain(spec_of(text, unlisted), "one-90", "direct")[0].checks
        assert next(c for c in found if c.name == "motor_radial_load").status == status


def test_no_gearhead_is_chosen_where_there_is_to_be_none():
    with pytest.raises(InputError, match=r"fan.yaml:\d+: select: .*kind: direct.*; leave gearhead out"):
        spec_of(ALONE.replace("CATALOGS]", "maxon], gearhead: {family: GP 42 C}"))
    with pytest.raises(InputError, match=r"\"direct\" is in no catalogue.*transmission: \[\{kind: direct\}\]"):
        size(spec_of(FAN.replace("CATALOGS]", "maxon], gearhead: {part: direct}")))
    with pytest.raises(InputError, match="a gearhead or direct, or one of them and then a belt"):
        spec_of(ALONE.replace("kind: direct", "kind: belt, ratio: 2, efficiency: 0.9"), "maxon")
