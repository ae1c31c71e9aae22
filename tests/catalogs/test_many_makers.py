"""All shipped catalogues at once: sets mix nothing that no source puts together, and each part keeps its maker."""

import math
from functools import cache
from importlib import resources

import pytest

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")


@pytest.fixture(scope="module")
def everything():
    return load(["all"])


@pytest.fixture(scope="module")
def starter():
    """A starter with the catalogues of other makers."""

    def of(name, catalogs):
        text = (resources.files("drivesizer.spec") / "starters" / f"{name}.yaml").read_text(encoding="utf-8")
        return read_spec(YamlSource(text.replace("catalogs: [maxon]", f"catalogs: [{catalogs}]"), "all.yaml"))

    return of


@pytest.fixture(scope="module")
def sized(everything, starter):
    """A starter with all makers, once each."""

    @cache
    def of(name):
        with pytest.MonkeyPatch.context() as patch:  # of hundreds of drives a figure that is irrelevant here
            patch.setattr("drivesizer.search.set_record.overload_time", lambda *_: math.nan)
            return size(starter(name, "all"), catalog=everything, top=120, detail="drives")

    return of


@pytest.mark.slow
@pytest.mark.parametrize("name", ["conveyor", "fan", "hoist", "rotary_table"])
def test_sets_of_all_makers_fit_together(name, everything, sized):
    result = sized(name)
    listed = listed_pairs(everything)
    makers = set()
    for s in (*result.sets, *result.misses):
        assert fits_together(s, everything, listed), s.label
        makers.add(s.motor.manufacturer)
    assert "maxon" in makers
    if name == "fan":
        assert "Faulhaber" in makers
        assert any(s.actuator for s in result.sets)


def listed_pairs(catalog):
    """Part numbers of motors and gearheads that a source puts together."""
    motors, gearheads = catalog.motors["part"], catalog.gearheads["part"]
    return set(zip(motors[catalog.motor_gearhead.left].tolist(), gearheads[catalog.motor_gearhead.right].tolist(),
                   strict=True))  # fmt: skip


def fits_together(s, catalog, listed):
    """By the catalogues' own lists, the hub that holds the shaft, or as one actuator; nothing of another's inside."""
    inside = {part.inside for part in (s.motor, s.gearhead) if part}
    if s.actuator:
        assert inside == {s.actuator.part} == {s.motor.part}
        assert s.gearhead.ratio == catalog.actuators["ratio"][catalog.actuators.rows[s.actuator.part]]
    else:
        assert inside == {""}
    for part in (s.encoder, s.controller):
        assert part is None or part.inside in ("", s.motor.inside)
    if s.controller:
        assert s.controller.drives in ("", "both", s.motor.kind) or not s.motor.kind
    hub = s.gearhead.mounting == "clamping hub" and s.motor.shaft_diameter <= s.gearhead.max_motor_shaft
    return bool(s.actuator) or hub or (s.motor.part, s.gearhead.part) in listed


def test_what_lacks_figures_does_not_pass(starter):
    """Faulhaber gives no input speed of its gearheads, and of most no inertia: such drives are unknown."""
    geared = [s for s in size(starter("fan", "faulhaber"), top=15, detail="drives").sets if s.gearhead.kind != "direct"]
    assert len(geared) > 5
    for s in geared:
        assert (s.motor.manufacturer, s.status) == ("Faulhaber", "unknown")
        assert {c.name: c.status for c in s.checks}["gearhead_continuous_speed"] == "unknown"
