"""Frozen records against those of the standard library: the same class, made by either."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from dataclasses import FrozenInstanceError, asdict, field, fields, replace
from typing import Any

import pytest

from drivesizer.files.frozen import dataclass

MADE: list[int] = []


def listed() -> list[int]:
    MADE.append(1)
    return []


def classes(decorator: Any, **options: bool) -> Any:
    """A class with a field of each sort."""

    @decorator(frozen=True, **options)
    class Drive:
        """A drive."""

        name: str
        mass: float = 1.5
        note: str = field(default="none", compare=False, repr=False)
        stages: list[int] = field(default_factory=listed)

        @property
        def heavy(self) -> bool:
            return self.mass > 2.0

    return Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaft:
    """A shaft, which is pickled."""

    diameter: float
    keyed: bool = False

    def __post_init__(self) -> None:
        if self.diameter < 0.0:
            raise ValueError("expected a diameter")


@dataclass(frozen=True, slots=True, kw_only=True)
class HollowShaft(Shaft):
    """One with a bore."""

    bore: float


@dataclass(frozen=True, slots=True)
class Nothing:
    """A record without fields."""


BOTH = [
    (classes(dataclass, **options), classes(dataclasses.dataclass, **options))
    for options in ({}, {"slots": True}, {"slots": True, "kw_only": True}, {"eq": False}, {"slots": True, "eq": False})
]
CALLS: list[tuple[list[Any], dict[str, Any]]] = [
    ([], {"name": "a"}),
    ([], {"name": "a", "mass": 3.0, "note": "b", "stages": [1]}),
    (["a"], {}),
    (["a", 2.0, "c", []], {}),
    ([], {}),
    (["a"], {"name": "b"}),
    ([], {"name": "a", "length": 1.0}),
    ([1, 2, 3, 4, 5], {}),
]


def outcome(make: Any) -> Any:
    try:
        return repr(make())
    except (TypeError, AttributeError, ValueError) as error:
        return type(error), str(error)


@pytest.mark.parametrize(("ours", "theirs"), BOTH)
@pytest.mark.parametrize(("given", "named"), CALLS)
def test_made_and_shown_and_refused_as_by_the_standard_library(ours, theirs, given, named):
    for _ in range(2):  # the first one compiles
        assert outcome(lambda: ours(*given, **named)) == outcome(lambda: theirs(*given, **named))


@pytest.mark.parametrize(("ours", "theirs"), BOTH)
def test_equal_and_hashed_as_by_the_standard_library(ours, theirs):
    values = [{"name": "a", "stages": ()}, {"name": "a", "stages": (), "note": "x"}, {"name": "b", "stages": ()}]
    for one in values:
        for other in values:
            assert (ours(**one) == ours(**other)) is (theirs(**one) == theirs(**other))
    assert ours(**values[0]) != theirs(**values[0]) and ours(**values[0]) != 1
    if ours(**values[0]) == ours(**values[0]):  # else each is only itself
        assert hash(ours(**values[0])) == hash(ours(**values[1])) == hash(theirs(**values[0]))
        with pytest.raises(TypeError, match="unhashable"):
            hash(ours(name="a"))


@pytest.mark.parametrize(("ours", "theirs"), BOTH)
def test_nothing_is_changed_later(ours, theirs):
    for name in ("mass", "length"):
        changes = [lambda one, name=name: setattr(one, name, 1.0), lambda one, name=name: delattr(one, name)]
        for change in changes:
            both = [outcome(lambda cls=cls, change=change: change(cls(name="a"))) for cls in (ours, theirs)]
            assert both[0][0] is FrozenInstanceError and (both[0] == both[1] or name == "length")


def test_fields_and_what_the_standard_library_does_with_them():
    ours, theirs = BOTH[2]
    one = ours(name="a", stages=[1])
    assert [f.name for f in fields(ours)] == [f.name for f in fields(theirs)]
    assert asdict(one) == asdict(theirs(name="a", stages=[1])) and replace(one, mass=3.0).heavy
    assert ours.__match_args__ == theirs.__match_args__ and not hasattr(one, "__dict__")
    before = len(MADE)
    assert ours(name="a").stages is not ours(name="a").stages and len(MADE) == before + 2


def test_copied_and_pickled():
    shaft = HollowShaft(diameter=0.02, bore=0.01)
    for same in (copy.copy(shaft), copy.deepcopy(shaft), pickle.loads(pickle.dumps(shaft))):
        assert same == shaft and same is not shaft
    assert repr(shaft) == "HollowShaft(diameter=0.02, keyed=False, bore=0.01)"
    assert Nothing() == Nothing() and repr(Nothing()) == "Nothing()" and hash(Nothing()) == hash(())


def test_what_is_looked_at_after_it_is_made_is_looked_at_every_time():
    for _ in range(2):
        with pytest.raises(ValueError, match="expected a diameter"):
            Shaft(diameter=-1.0)


def test_functions_of_the_class_itself_stay():
    @dataclass(frozen=True)
    class Own:
        """With its own words."""

        value: float

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return True

    assert repr(Own(1.0)) == "own" and Own(1.0) == Own(2.0) and hash(Own(1.0)) == hash((1.0,))


def test_only_frozen_classes():
    with pytest.raises(TypeError, match="expected frozen=True"):
        dataclass(frozen=False)
