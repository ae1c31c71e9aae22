"""A figure of the spec over a range: where the best drive changes, and what rejects the one before it."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.errors import DrivesizerError
from drivesizer.files.yaml_edit import Edit, edited
from drivesizer.live.held import EngineMemory, Piece, StoppedError
from drivesizer.live.reading import text_of, whole

__all__ = ["rejected", "sweep"]


def sweep(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``point`` for each value, in the order of the request."""
    text, path = text_of(held, request), tuple(request["path"])
    for number, value in enumerate(request["values"]):
        held.go_on()
        yield {
            "kind": "point",
            "number": number,
            "value": value,
            **_best(held, edited(text, [Edit(path, value)], held.name)),
        }


def _best(held: EngineMemory, text: str) -> Piece:
    """The best drive of a spec, or why there is none."""
    from drivesizer.output.json.loops import number
    from drivesizer.results.check import worst

    try:
        result = whole(held, text, top=1, brief=True)
    except StoppedError:
        raise
    except DrivesizerError as error:
        return {"status": "wrong", "said": str(error)}
    if hasattr(result, "axes"):
        best = [one.best for one in result.axes]
        labels = [f"{one.name}: {one.best.label if one.best else 'none'}" for one in result.axes]
        parts = [[one.motor.part, one.gearhead.part] if one else [] for one in best]
        return {"status": result.status, "label": "; ".join(labels), "parts": parts}
    one = result.shown
    tight = worst(one.deciding) if one else None
    said = {"tight": tight.title, "margin": number(tight.margin)} if tight else {}
    found = bool(result.sets)
    label, parts = (one.label, [one.motor.part, one.gearhead.part]) if one else ("", [])
    return {"status": one.status if found and one else "fail", "label": label, "parts": parts, **said,
            "mass": number(one.mass) if one else None, "price": number(one.price) if one else None}  # fmt: skip


def rejected(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``rejected``: whether a set still passes, and its check of the smallest margin."""
    from drivesizer.files.yaml_source import YamlSource
    from drivesizer.output.text import margin
    from drivesizer.results.check import worst
    from drivesizer.sizing import explained
    from drivesizer.spec.robot import read_spec

    spec = read_spec(YamlSource(text_of(held, request), held.name))
    found = explained(spec, request["motor"], request["gearhead"]).sets
    tight = worst(found[0].deciding) if found else None
    yield {"kind": "rejected", "status": found[0].status if found else "fail", "tight": tight.title if tight else "",
           "said": margin(tight.margin) if tight else ""}  # fmt: skip
