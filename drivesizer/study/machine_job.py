"""Subject of a study of machines: one axis of them, or the whole machine with the names of its axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drivesizer.errors import nearest, quoted
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.several_axes.any_spec import is_machine
from drivesizer.spec.several_axes.machine_file import read_machine
from drivesizer.study.axes import Place
from drivesizer.study.schema import StudyFile

__all__ = ["is_several", "machine_job"]


def is_several(source: YamlSource) -> bool:
    """Whether a document is a machine of several axes, or of a robot's joints; one of a single axis is that spec."""
    return is_machine(source) and ("robot" in source.data or len(source.data["axes"] or ()) != 1)


def machine_job(source: YamlSource, study: StudyFile, specs: Sequence[YamlSource]) -> dict[str, Any]:
    """Fields of a study's job that are of machines."""
    names = study.specs or [study.spec or ""]
    several = [is_several(spec) for spec in specs]
    if any(several) and not all(several):
        odd = several.index(not several[0])
        kinds = ["the spec of one axis", "a machine of several axes"]
        text = f"is {kinds[several[odd]]}, and the first is {kinds[several[0]]}; expected specs of one kind"
        raise Place(source, ("specs", odd)).error(f"{quoted(names[odd])} {text}")
    if study.axis is not None:
        for name, spec in zip(names, specs, strict=True):
            _has_axis(Place(source, ("axis",)), spec, name, study.axis)
        return {"machine": several[0], "axis": study.axis}
    if not several[0]:
        return {}
    if study.top > 1:
        text = "a machine has one choice of drives; expected 1, or axis: NAME for the drives of one"
        raise Place(source, ("top",)).error(f"{quoted(study.top)}: {text}")
    members = dict.fromkeys(name for spec in specs for name in _axes(spec))
    return {"machine": True, "members": tuple(members)}


def _has_axis(place: Place, spec: YamlSource, called: str, name: str) -> None:
    """Refuse an axis that a machine does not have."""
    if not is_machine(spec):
        raise place.error(f"{quoted(called)} is a spec of one axis; leave axis out")
    known = list(spec.data.get("axes") or ())
    if name not in known and "robot" in spec.data:
        known = _axes(spec)
    if name not in known:
        hint = nearest(name, known) or f"; expected one of {', '.join(known)}"
        raise place.error(f"there is no axis {quoted(name)}{hint}")


def _axes(spec: YamlSource) -> list[str]:
    """Names of the axes, with those of a robot's joints that move."""
    if "robot" not in spec.data:
        return list(spec.data["axes"] or ())
    from drivesizer.multi_axis.joint_axes import with_joints  # what computes joints is loaded where there are any

    machine, _ = with_joints(read_machine(spec))
    return [axis.name for axis in machine.axes]
