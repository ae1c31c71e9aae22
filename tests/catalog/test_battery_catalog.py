"""Discharge tables in the catalogues: as printed, read strictly, kept, joined, and checked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refusal

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.laws import Finding, check
from drivesizer.catalog.parts import Discharges, PullOuts
from drivesizer.errors import CatalogError

HOUR = 3600.0
CELLS = 6
# maker, battery, held, end voltage [V], time [h], draw [A or W] of the block; power per cell where the sheet has it so
PRINTED = [
    ("sigmastek", "SP12-7.5T1", "current", 1.75 * CELLS, 20, 0.379),
    ("sigmastek", "SP12-7.5T1", "current", 1.60 * CELLS, 1 / 12, 29.0),
    ("sigmastek", "SP12-7.5T1", "current", 1.80 * CELLS, 3, 1.88),
    ("sigmastek", "SP12-7.5T1", "power", 1.75 * CELLS, 1, 8.23 * CELLS),
    ("sigmastek", "SP12-7.5T1", "power", 1.65 * CELLS, 0.25, 25.5 * CELLS),
    ("sigmastek", "SP12-20-DZM", "current", 1.67 * CELLS, 2, 10.20),
    ("sigmastek", "SP12-20-DZM", "power", 1.60 * CELLS, 10, 5.20 * CELLS),
    ("sunnyway", "SW12140E", "current", 9.6, 1, 8.4),
    ("sunnyway", "SW12140E", "power", 10.5, 4, 30.8),
    ("sunnyway", "SW12140E", "power", 11.1, 1 / 6, 321.4),
    ("yuasa", "NP4-12", "current", 10.2, 10, 0.38),
]
COUNTS = {"sigmastek": 66 + 65 + 50 + 10, "sunnyway": 2 * 48 - 1, "yuasa": 6}


def of(catalog: Catalog, part: str) -> Discharges:
    return catalog.discharges.on(catalog.discharges.battery == catalog.batteries.rows[part])


@pytest.mark.parametrize(("maker", "part", "held", "volts", "hours", "draw"), PRINTED)
def test_as_printed(maker: str, part: str, held: str, volts: float, hours: float, draw: float) -> None:
    own = of(load([maker]), part)
    near = np.isclose(own.cutoff_voltage, volts) & np.isclose(own.time, hours * HOUR) & ~np.isnan(getattr(own, held))
    assert getattr(own, held)[near].tolist() == pytest.approx([draw])


# --- reading ---------------------------------------------------------------------------------------------------------

TEXT = Path(__file__).with_name("batteries.yaml").read_text(encoding="utf-8")


def file(folder: Path, text: str, name: str = "volta") -> str:
    path = folder / f"{name}.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_units_and_cells(tmp_path: Path) -> None:
    own = of(load([file(tmp_path, TEXT)]), "B7")
    assert own.time.tolist() == [1800.0, HOUR, 20 * HOUR, HOUR, 20 * HOUR, HOUR]
    assert own.current[:-1].tolist() == pytest.approx([7.0, 4.2, 0.35, 4.0, 0.34])
    assert own.power[-1] == pytest.approx(48.0)
    assert own.cutoff_voltage.tolist() == pytest.approx([10.5, 10.5, 10.5, 10.8, 10.8, 10.5])


def test_an_overriding_catalogue_brings_its_own_table(tmp_path: Path) -> None:
    mine = TEXT.replace("catalog: 1", "catalog: 1\noverrides: true").replace("4200, 350", "4100, 350")
    both = load([file(tmp_path, TEXT), file(tmp_path, mine, "mine"), "yuasa"])
    own = of(both, "B7")
    assert own.current[:3].tolist() == pytest.approx([7.0, 4.1, 0.35])
    assert len(own.time) == 6
    assert len(of(both, "NP4-12").time) == 6
    assert {both.sources[number].document for number in of(both, "NP4-12").source} == {
        "Yuasa data sheet NP4-12 (paperzz.com/doc/9488465)"
    }


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("- battery: B7\n  source: sheet\n  held: current", "- battery: B8\n  source: sheet\n  held: current",
         'volta.yaml:14: discharges[1].battery: "B8" is not a battery of this file'),
        ("held: current (mA)", "held: torque (N*m)",
         'discharges[1].held: "torque (N*m)" is not known; expected current (A) or power (W)'),
        ("held: current (mA)", "held: current (W)", "discharges[1].held: "),
        ("held: current (mA)", "held: current", 'discharges[1].held: "current" is not known'),
        ("cells: 6", "cells: 0", 'discharges[2].cells: "0" is not a number of cells in series'),
        ("cutoff_voltage (V), 30 min, 1 h, 20 h]", "cutoff_voltage (V), 30, 1 h, 20 h]", "discharges[1].columns[2]: "),
        ("[cutoff_voltage (V), 30 min, 1 h, 20 h]", "[30 min, 1 h, 20 h, 30 h]",
         "discharges[1].columns: expected cutoff_voltage (V) and then times"),
        ("7000, 4200, 350", "7000, 4200", "discharges[1].rows[1]: expected 4 cells as in `columns`, found 3"),
        ("- [10.8, ~", "- [10.5, ~", "discharges[1].rows[2][3]: this end voltage and time are given twice"),
    ],
)  # fmt: skip
def test_a_wrong_table_is_one_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in TEXT
    assert said in refusal(lambda: load([file(tmp_path, TEXT.replace(old, new))]), CatalogError)


# --- what contradicts itself -----------------------------------------------------------------------------------------


def changed(catalog: Catalog, part: str, held: str, volts: float, hours: float, draw: float) -> Catalog:
    """The catalogue with another draw at one place of a table."""
    d = catalog.discharges
    column = getattr(d, held).copy()
    near = (d.battery == catalog.batteries.rows[part]) & np.isclose(d.cutoff_voltage, volts)
    near &= np.isclose(d.time, hours * HOUR) & ~np.isnan(column)
    assert near.sum() == 1
    column[near] = draw
    return replace(catalog, discharges=d._replace(**{held: column}))


def tables(findings: list[Finding]) -> list[Finding]:
    return [f for f in findings if "discharges" in f.fields]


def test_the_shipped_tables_have_one_contradiction_which_is_found() -> None:
    found = [f for maker in sorted(COUNTS) for f in tables(check(load([maker])))]
    assert [(f.part, f.identity, bool(f.accepted)) for f in found] == [("SP12-7.5T1", "mean voltage", True)]
    assert found[0].found == pytest.approx(34.2 / 14.3 * CELLS)


@pytest.mark.parametrize(
    ("maker", "part", "held", "volts", "hours", "draw", "identity"),
    [
        ("sunnyway", "SW12140E", "current", 10.5, 3, 33.8, "current falls with time"),  # as at 10.8 V
        ("sigmastek", "SP12-7.5T1", "power", 1.75 * CELLS, 20, 0.66 * CELLS, "energy and rate"),
        ("sigmastek", "SP12-7.5T1", "power", 1.75 * CELLS, 1 / 6, 26.0 * CELLS, "mean voltage"),
        ("sigmastek", "SP12-7.5T1", "current", 1.75 * CELLS, 2, 2.62, "current and end voltage"),
        ("sigmastek", "SP12-20-DZM", "current", 1.75 * CELLS, 20, 1.16, "charge and rate"),
        ("sigmastek", "SP12-20-DZM", "current", 1.75 * CELLS, 5, 4.60, "capacity 5h in the table"),
        ("yuasa", "NP4-12", "current", 10.2, 20, 0.22, "capacity in the table"),
    ],
)  # fmt: skip
def test_one_wrong_figure_is_found(
    maker: str, part: str, held: str, volts: float, hours: float, draw: float, identity: str
) -> None:
    catalog = load([maker])
    catalog = replace(catalog, notes=())
    before = {(f.identity, f.meaning) for f in tables(check(catalog))}
    new = [f for f in tables(check(changed(catalog, part, held, volts, hours, draw)))
           if (f.identity, f.meaning) not in before]  # fmt: skip
    assert identity in {f.identity for f in new}
    assert all(f.part == part and f.unexplained for f in new)


# --- curves of steppers

RPM = np.pi / 30.0
STEPS = Path(__file__).with_name("pull_outs.yaml").read_text(encoding="utf-8")


def curve_of(catalog: Catalog, part: str) -> PullOuts:
    return catalog.pull_outs.on(catalog.pull_outs.stepper == catalog.steppers.rows[part])


def written(folder: Path, text: str, name: str = "steps.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_chart_of_the_maker() -> None:
    """StepperOnline's chart of 17HS19-2004S1 at 24 V with a DM320T: 0.232 N*m at 1000 rpm, 0.172 at 1200."""
    own = curve_of(load(["stepperonline"]), "17HS19-2004S1")
    assert own.voltage.tolist() == [24.0] * 12
    assert own.current[0] == 2.2
    assert own.torque[np.isclose(own.speed, 1000 * RPM) | np.isclose(own.speed, 1200 * RPM)].tolist() == [0.232, 0.172]


def test_read_and_joined_with_other_catalogues(tmp_path: Path) -> None:
    path = written(tmp_path, STEPS)
    alone = curve_of(load([str(path)]), "S2")
    assert alone.torque == pytest.approx([0.9, 0.5])
    assert np.isnan(alone.current).all()
    for _ in range(2):  # read, then out of the compiled file
        both = load(["stepperonline", str(path)])
        own = curve_of(both, "S2")
        assert own.speed == pytest.approx([60 * RPM, 600 * RPM])
        assert {both.sources[number].document for number in own.source} == {"sheet"}
        assert own.curve[0] not in curve_of(both, "17HS19-2004S1").curve


def test_the_curve_of_a_replaced_part_is_the_last(tmp_path: Path) -> None:
    first = written(tmp_path, STEPS)
    other = STEPS.replace("catalog: 1", "catalog: 1\noverrides: true").replace("900", "800")
    found = curve_of(load([str(first), str(written(tmp_path, other, "own.yaml"))]), "S2")
    assert found.torque.tolist() == pytest.approx([0.8, 0.5])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("stepper: S2", "stepper: S9", "is not a stepper of this file"),
        ("voltage: 24 V", "voltage: 0 V", '"0 V" is not above 0'),
        ("voltage: 24 V", "voltage: 24", "unit"),
        ("[speed (rpm), torque (mN*m)]", "[speed (rpm), force (N)]", "expected [speed (rpm), torque (N*m)]"),
        ("[600, 500]", "[60, 500]", "speed 60 is not above that of the row before"),
        ("[600, 500]", "[600, -5]", "is not a speed and a torque of 0 or more"),
        ("[[60, 900], [600, 500]]", "[[60, 900]]", "found 1 points; expected at least 2"),
    ],
)
def test_bad_curves_are_refused_in_a_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = written(tmp_path, STEPS.replace(old, new))
    line = refusal(lambda: load([str(path)]), CatalogError)
    assert said in line
    assert "steps.yaml:" in line
