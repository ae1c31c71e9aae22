"""A maker's table and the map that reads it."""

from __future__ import annotations

SHEET = """\
Order no.,Series,Nominal voltage,Speed,Torque,Weight,Remark,Colour
,,V,1/min,oz-in,oz,,
A1,X 10,24,9560,3.72,1.9,,red
A2,X 10,12,-,3.9,,"a ""note"", here",
,,,,,,,
A:3,Y: 2,24,~,,2,x,
"""

MAP = """\
manufacturer: Other & Sons
source: {name: web, document: "price list: 2024", confidence: secondary, date: "2024-05", url: "https://example.org/a#b"}
unknown: ["-"]
common: {kind: brushed, diameter: 10 mm, pole_pairs: 1}
columns:
  Order no.: part
  Series: family
  Nominal voltage: nominal_voltage
  Speed: no_load_speed
  Torque: nominal_torque
  Weight: mass
  Remark: ~
"""
