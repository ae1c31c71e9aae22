"""Discharge tables in the catalogues: as printed, read strictly, kept, joined, and checked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refusal

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.laws import Finding, check
from drivesizer.catalog.parts import Discharges
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
