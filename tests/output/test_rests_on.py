"""What each check rests on: figures are taken away one by one, and the checks that change must be those that say so."""

from dataclasses import fields, replace
from math import isnan
from pathlib import Path

import pytest
from specs import estimates_off, without
from starters import starter

from drivesizer.catalog import Catalog
from drivesizer.results.check import Check
from drivesizer.results.check_kinds import marked_figures, rests_on, unknown_figures
from drivesizer.results.drive_set import DriveSet
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import RobotSpec, load_spec

ROLES = ("motor", "gearhead", "encoder", "controller")


def pinned(spec: RobotSpec, one: DriveSet) -> RobotSpec:
    """A spec that takes the encoder and the controller of a set and no other."""
    parts = {role: getattr(one, role) for role in ROLES}
    choices = {role: getattr(spec.select, role).model_copy(update={"family": None, "part": [part.part]})
               for role, part in parts.items() if part}  # fmt: skip
    return spec.model_copy(update={"select": spec.select.model_copy(update=choices)})


def told(one: DriveSet) -> dict[tuple[str, str], tuple[object, ...]]:
    return {(c.method, c.name): _of(c) for c in one.every_check}


def _of(c: Check) -> tuple[object, ...]:
    return c.status, *(None if isnan(x) else round(x, 9) for x in (c.demand, c.limit))


def taken_away(spec: RobotSpec, catalog: Catalog):
    """For each known figure of the best set which checks change without it, and which say that they rest on it."""
    spec = estimates_off(spec)
    best = size(spec, catalog=catalog, top=1).sets[0]
    spec = pinned(spec, best)
    (whole,) = explain(spec, best.motor.part, best.gearhead.part, catalog=catalog)
    says = {(c.method, c.name): rests_on(c, whole) for c in whole.every_check}
    for role in ROLES:
        part = getattr(whole, role)
        for field in fields(part) if part else ():
            value = getattr(part, field.name)
            if not isinstance(value, float) or isnan(value):
                continue
            (bare,) = explain(spec, best.motor.part, best.gearhead.part,
                              catalog=without(catalog, role, part.part, field.name))  # fmt: skip
            now, then = told(whole), told(bare)
            changed = {name for name in now if now[name] != then.get(name)}
            yield (
                f"{role}.{field.name}",
                changed,
                {name for name, rests in says.items() if f"{role}.{field.name}" in rests},
            )


SPECS = ["robot", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("hoist", "arm"))]
WITHOUT_A_CONTROLLER = {"controller.supply_min", "controller.supply_max"}
WHERE_IT_BINDS = {
    *(f"controller.{name}" for name in ("full_current_ambient", "derating_slope", "ambient_max")),  # in a hot cabinet
    "controller.max_duty",  # unknown it is 0.9 at least, which most makers print
    "controller.max_encoder_frequency",
    "controller.max_speed_sine",  # unknown it is that of the slowest that print one, at least
    "gearhead.intermittent_input_speed",  # the continuous one is as large
    "gearhead.temperature_min",
    "motor.ambient_min",
    "motor.speed_constant",  # no load tells the same back-EMF constant
}  # else the other end does


@pytest.fixture(scope="module", params=SPECS)
def found(request, spec, tmp_path_factory, catalog):
    folder: Path = tmp_path_factory.mktemp("rests")
    given = spec if request.param == "robot" else starter(request.param, folder)
    with pytest.MonkeyPatch.context() as patch:  # nobody asks what would let a set pass that falls
        patch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
        return {name: both for name, *both in taken_away(given, catalog)}


@pytest.mark.slow
def test_a_check_that_changes_without_a_figure_says_that_it_rests_on_it(found):
    quiet = {name: changed - says for name, (changed, says) in found.items() if changed - says}
    for name in WITHOUT_A_CONTROLLER & set(quiet):  # then there is none to check
        assert {check for _, check in found[name][1]} >= {"controller_available"}
    assert not set(quiet) - WITHOUT_A_CONTROLLER, quiet


def test_what_a_check_says_to_rest_on_changes_something(found):
    """Each figure that is named changes one of the checks that name it; where it is known."""
    idle = {name for name, (changed, says) in found.items() if says and not changed & says}
    assert idle <= WHERE_IT_BINDS


def test_the_robots_unknown_and_estimated_figures(example):
    sized = size(load_spec(example), top=1)
    best = sized.sets[0]
    assert not unknown_figures(best)
    poorer = without(sized.catalog, "motor", "118752", "max_winding_temperature")
    (lacking,) = explain(load_spec(example), "118752", "406764", catalog=poorer)
    assert dict(unknown_figures(lacking)) == {"Winding temperature, peak": "motor max winding temperature"}
    marked = {name: (value, mark) for name, value, mark, _ in marked_figures(best)}
    assert marked["encoder max speed"] == ("24000 rpm", "recalled")
    assert marked["encoder inertia"] == ("0.7 g·cm²", "derived")
    assert "motor resistance" not in marked  # copied by others, and quoted there
    alone = replace(best, encoder=None, checks=tuple(replace(c, status="unknown") for c in best.checks))
    assert dict(unknown_figures(alone))["Encoder counts per turn"] == "any encoder"
