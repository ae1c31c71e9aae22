"""A catalogue of a few made-up parts, a maker's table and the map that reads it, as texts to be changed."""

from pathlib import Path

__all__ = ["CATALOGUE", "MAP", "TABLE"]

CATALOGUE = Path(__file__).with_name("small_catalogue.yaml").read_text(encoding="utf-8")

TABLE = """\
Order no.,Name,Voltage,Speed,Current,R,Mass
,,V,rpm,mA,ohm,g
1001,M 16,12,8000,20,5.5,40
1002,M 16,24,8100,10,22,40
"""
MAP = """\
manufacturer: Anymaker
source: {name: sheet, document: data sheet, confidence: quoted, date: "2024-05"}
unknown: ["-", n/a]
common: {kind: brushed, diameter: 16 mm}
columns: {Order no.: part, Name: family, Voltage: nominal_voltage, Speed: no_load_speed, Current: no_load_current,
          R: resistance, Mass: mass}
"""
