"""What the campaign starts from: specs of the starters, examples and pages, catalogues, recordings, descriptions."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from small_catalogue import CATALOGUE

__all__ = [
    "CYCLE", "MJCF", "TRACK", "URDF", "WAY", "arm", "catalogues", "descriptions", "of_load", "parts_of", "specs",
    "studies",
]  # fmt: skip

ROOT = Path(__file__).resolve().parents[2]
_BLOCK = re.compile(r"^```yaml[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
_OWN = {"catalogs": ["own.yaml"]}
_SMALL = 6000  # bytes of a shipped catalogue that is changed

CYCLE = "time,speed,torque\ns,rpm,N*m\n0,0,0\n1,100,0.1\n2,100,0.1\n3,0,0\n"
TRACK = "t,x,y,heading\ns,m,m,deg\n0,0,0,0\n1,0.3,0,0\n2,0.9,0.1,5\n3,1.5,0.3,10\n4,1.8,0.4,10\n5,1.8,0.4,10\n"
WAY = "x,y,heading\nm,m,deg\n0,0,0\n2,0,0\n4,1,45\n"

URDF = """\
<robot name="cart">
  <link name="body"><inertial><origin xyz="0 0 0.1"/><mass value="20"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.3"/></inertial></link>
  <link name="left"><inertial><mass value="0.8"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.001"/>
    </inertial><collision><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision></link>
  <link name="right"><inertial><mass value="0.8"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.001"/>
    </inertial>
    <collision><origin rpy="1.57 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision>
  </link>
  <link name="mast"><inertial><origin xyz="0 0 0.3"/><mass value="1.5"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.001"/></inertial></link>
  <joint name="left_wheel" type="continuous"><parent link="body"/><child link="left"/><origin xyz="0 0.2 0"/>
    <axis xyz="0 1 0"/><limit effort="4" velocity="12"/><dynamics damping="0.01" friction="0.02"/></joint>
  <joint name="right_wheel" type="continuous"><parent link="body"/><child link="right"/><origin xyz="0 -0.2 0"/>
    <axis xyz="0 1 0"/><limit effort="4" velocity="12"/></joint>
  <joint name="tilt" type="revolute"><parent link="body"/><child link="mast"/><origin xyz="0 0 0.2" rpy="0 0.1 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="20" velocity="2"/></joint>
</robot>
"""
MJCF = """\
<mujoco model="arm">
  <compiler angle="degree" autolimits="true"/>
  <default><joint damping="0.1" armature="0.01"/><default class="thin"><geom density="500"/></default></default>
  <worldbody>
    <body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0" range="-90 90" frictionloss="0.2"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
      <body name="lower" pos="0.3 0 0" euler="0 10 0"><joint name="elbow" axis="0 1 0" range="-120 120"/>
        <inertial pos="0.1 0 0" mass="0.5" diaginertia="0.001 0.002 0.002"/>
        <geom class="thin" type="box" size="0.1 0.02 0.02" pos="0.1 0 0"/></body></body>
  </worldbody>
  <actuator><motor joint="shoulder" gear="50" ctrlrange="-1 1"/></actuator>
</mujoco>
"""


def _parsed(text: str) -> Any:
    return yaml.load(text, Loader=yaml.CSafeLoader)  # libyaml, as the program: the parser in Python takes less


@cache
def specs() -> tuple[dict[str, Any], ...]:
    """Specs of the starters, examples and pages as data, with few parts to choose from."""
    texts = [path.read_text(encoding="utf-8") for folder in ("drivesizer/spec/starters", "examples")
             for path in sorted((ROOT / folder).rglob("*.yaml"))]  # fmt: skip
    texts += [block for page in sorted((ROOT / "docs").rglob("*.md"))
              for block in _BLOCK.findall(page.read_text(encoding="utf-8"))]  # fmt: skip
    return tuple(_with_own(data) for text in texts if (data := _spec(text)))


def _spec(text: str) -> dict[str, Any]:
    """The data of a spec; empty of what is none, and of a robot's joints: ``arm`` is one of few joints."""
    try:
        data = _parsed(text)
    except yaml.YAMLError:
        return {}
    return data if isinstance(data, dict) and {"load", "axes"} & data.keys() else {}


def arm() -> dict[str, Any]:
    """A spec of the joints of ``MJCF``, to lie beside it as arm.xml."""
    return {
        "name": "arm",
        "robot": {
            "description": "arm.xml", "payload": {"mass": "300 g", "link": "lower", "at": ["200 mm", "0 mm", "0 mm"]},
            "waypoints": [{"positions": {"shoulder": "-30 deg", "elbow": "20 deg"}, "pause": "0.4 s"},
                          {"positions": {"shoulder": "40 deg"}}],
            "limits": {"all": {"speed": "60 deg/s", "acceleration": "5 rad/s^2"}},
            "holds": [{"name": "stretched", "positions": {"shoulder": "0 deg", "elbow": "0 deg"}, "time": "5 s"}],
        },
        "supply": {"nominal": "24 V", "current": "10 A", "accepts": "all"},
        "select": dict(_OWN),
    }  # fmt: skip


def _with_own(data: dict[str, Any]) -> dict[str, Any]:
    """The spec with the small catalogue, and with the files that the campaign lays beside it."""
    chosen = {k: v for k, v in (data.get("select") or {}).items() if k in ("objective", "ripple", "estimates")}
    data = {**data, "select": {**chosen, **_OWN}}
    if "tolerances" in data:
        data["tolerances"] = {**data["tolerances"], "samples": 16}
    if isinstance(data.get("load"), dict) and "file" in data["load"]:
        data["load"] = {**data["load"], "file": "cycle.csv"}
    if isinstance(data.get("motion"), dict) and "trajectory" in data["motion"]:
        data["motion"] = {**data["motion"], "trajectory": "way.csv"}
    for axis in (data.get("axes") or {}).values():
        if isinstance(axis, dict) and "select" in axis:
            axis["select"] = dict(_OWN)
    return data


def of_load(kind: str) -> dict[str, Any]:
    """The first spec of a kind of load."""
    return next(one for one in specs() if (one.get("load") or {}).get("kind") == kind)


@cache
def studies() -> tuple[dict[str, Any], ...]:
    """Studies: the example's, those of the page, one that samples."""
    texts = [(ROOT / "examples" / "study.yaml").read_text(encoding="utf-8")]
    texts += _BLOCK.findall((ROOT / "docs" / "studies.md").read_text(encoding="utf-8"))
    found = [data for text in texts if isinstance(data := _parsed(text), dict) and "vary" in data]
    found.append({"spec": "robot.yaml", "vary": {"supply.nominal": {"from": "20 V", "to": "28 V"}},
                  "sampling": {"latin_hypercube": 5, "seed": 1}, "objectives": ["mass"]})  # fmt: skip
    return tuple({**one, "spec": "robot.yaml"} if "spec" in one else one for one in found)


@cache
def catalogues() -> tuple[dict[str, Any], ...]:
    """Small catalogues: that of the tests, and shipped ones."""
    shipped = [path for path in sorted((ROOT / "catalogs").glob("*.yaml")) if path.stat().st_size < _SMALL]
    return (_parsed(CATALOGUE), *(_parsed(path.read_text(encoding="utf-8")) for path in shipped))


@cache
def descriptions() -> tuple[tuple[str, str], ...]:
    """Robot descriptions by suffix."""
    arm = (ROOT / "examples" / "six_joint_arm.urdf").read_text(encoding="utf-8")
    return ((".urdf", URDF), (".urdf", arm), (".xml", MJCF))


def parts_of(data: Any) -> list[str]:
    """Part numbers that a catalogue's rows begin with."""
    found = []
    for tables in data.values() if isinstance(data, dict) else ():
        for table in tables if isinstance(tables, list) else ():
            rows = table.get("rows") if isinstance(table, dict) else None
            if isinstance(rows, list):
                found += [str(row[0]) for row in rows if isinstance(row, list) and row]
    return found or ["m1"]
