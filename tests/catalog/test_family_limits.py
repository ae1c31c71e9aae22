"""Permitted limits from the other parts of a family."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from drivesizer.catalog import load, shipped
from drivesizer.catalog.estimates import LIMITS, FamilyLimit, as_records, family_limits
from drivesizer.cli import app

PARTS = """
catalog: 1
manufacturer: %s
sources: {s: {document: sheet, confidence: quoted}}
motors:
  - family: A
    source: s
    columns: [part, max_speed (rpm), max_winding_temperature (degC)]
    rows: [[A1, 9000, 125], [A2, 9000, 155], [A3, ~, ~]]
  - {family: B, source: s, columns: [part, max_speed (rpm)], rows: [[B1, 9000], [B2, ~]]}
"""


@pytest.fixture
def motors(tmp_path):
    (tmp_path / "one.yaml").write_text(PARTS % "One")
    (tmp_path / "two.yaml").write_text(
        (PARTS % "Two").replace("[A", "[C").replace("[B", "[D").replace("~, ~", "7000, 90").replace("~", "7000")
    )
    return load(["one.yaml", "two.yaml"], beside=tmp_path).motors


def test_a_limit_that_all_others_share_is_the_part_s(motors):
    """A3: 9000 rpm as A1 and A2, of another maker's family A nothing; temperatures differ; B has one member only."""
    found = family_limits(motors, motors.rows["A3"])
    assert found == [FamilyLimit("max_speed", pytest.approx(9000 * 2 * np.pi / 60), 2)]
    assert family_limits(motors, motors.rows["A1"]) == [] == family_limits(motors, motors.rows["B2"])
    (record,) = (one for one in as_records(motors, motors.rows["A3"]) if one["figure"] == "max_speed")
    assert record["low"] == record["value"] == record["high"] and record["peers"] == "same family"
    assert json.dumps(record)


def test_hidden_limits_of_shipped_families_are_found_again():
    """Each printed limit that a family of three or more shares, hidden: the same comes back."""
    shelf, checked = load(list(shipped())), 0
    for section, figures in LIMITS.items():
        table = shelf.table(section)
        for row in range(0, len(table), 40):
            for figure in figures:
                columns = dict(table.columns) | {figure: table[figure].copy()}
                columns[figure][row] = np.nan
                hidden = type(table)(section, columns, table.source, table.excluded)
                for one in family_limits(hidden, row):
                    if one.figure == figure and not np.isnan(table[figure][row]):
                        same = (table["family"] == table["family"][row]) & (
                            table["manufacturer"] == table["manufacturer"][row]
                        )
                        others = same & (np.arange(len(table)) != row) & ~np.isnan(table[figure])
                        assert np.allclose(table[figure][others], one.value) and others.sum() == one.members >= 2
                        checked += 1
    assert checked > 20


def test_the_data_sheet_lists_them():
    """The RE 50 370354 beside 370355 and 370356, 9500 rpm both; in JSON beside the estimates."""
    shown = CliRunner().invoke(app, ["catalog", "show", "370354", "--catalog", "maxon"]).stdout
    assert "limits of the family" in shown and "9500 rpm" in shown
    (part,) = json.loads(CliRunner().invoke(app, ["catalog", "show", "370354", "--catalog", "maxon", "--json"]).stdout)[
        "parts"
    ]
    assert [one["figure"] for one in part["estimates"] if one["peers"] == "same family"] == ["max_speed"]
