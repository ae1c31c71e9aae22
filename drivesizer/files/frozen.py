"""Frozen records: the standard library's ``dataclass``, whose functions are not compiled before they are needed.

``dataclasses`` writes six functions for each frozen class and compiles each of them, whether it is ever called or not:
most of a millisecond a class, a tenth of ``drivesizer size``, which loads eighty of them. Here fields, slots and
defaults are the standard library's, so that ``fields``, ``replace``, ``asdict`` and pickling are as they are there;
``__init__`` is compiled when the first record of a class is made, and the other functions are the same for all classes.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError
from functools import cache
from operator import attrgetter
from reprlib import recursive_repr
from types import MemberDescriptorType
from typing import TYPE_CHECKING, Any, NoReturn

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(*, frozen: bool, eq: bool = True, **more: bool) -> Callable[[type], type]:
        """Decorator of a frozen class, as ``dataclasses.dataclass(frozen=True)``.

        Parameters
        ----------
        frozen
            Always True; a class of records that change is one of ``dataclasses``.
        eq
            Whether records with equal fields are equal; if not, each equals only itself.
        more
            ``slots`` and ``kw_only``.

        Returns
        -------
        Callable
            From the class as written to that of the records.

        Raises
        ------
        TypeError
            Where it is not frozen.
        """
        if not frozen:
            raise TypeError("expected frozen=True; records that change are of dataclasses.dataclass")

        def made(written: type) -> type:
            cls = dataclasses.dataclass(init=False, repr=False, eq=False, **more)(written)
            functions = _OF_ALL | (_OF_EQUALS if eq else {}) | (_OF_SLOTS if more.get("slots") else {})
            for name in functions.keys() - {one for one, what in vars(cls).items() if what is not None}:
                setattr(cls, name, functions[name])
            cls.__init__ = _first_init(cls)
            return cls

        return made


def _first_init(cls: Any) -> Any:
    """An ``__init__`` that puts the compiled one into its place."""

    def first(self: Any, *given: Any, **named: Any) -> None:
        cls.__init__ = _init(cls)
        cls.__init__(self, *given, **named)

    return first


_ANEW = object()  # in place of a value that each record gets anew


def _init(cls: Any) -> Any:
    """The ``__init__`` of a class, compiled."""
    fields = dataclasses.fields(cls)
    plain = [_argument(one) for one in fields if not one.kw_only]
    named = [_argument(one) for one in fields if one.kw_only]
    slots = {one.name: slot for one in fields if isinstance(slot := getattr(cls, one.name, None), MemberDescriptorType)}
    put = {one.name: f"put_{one.name}(self, " if one.name in slots else f"set_(self, {one.name!r}, " for one in fields}
    lines = [f"{put[one.name]}{_value(one)})" for one in fields]
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    known: dict[str, Any] = {"set_": object.__setattr__, "anew": _ANEW}
    known |= {f"put_{name}": slot.__set__ for name, slot in slots.items()}  # quicker: the slot need not be looked up
    for one in fields:
        known[f"of_{one.name}"] = one.default if one.default_factory is MISSING else one.default_factory
    head = ", ".join(["self", *plain, *(["*", *named] if named else [])])
    exec(f"def __init__({head}):\n " + "\n ".join(lines or ["pass"]), known)  # noqa: S102  of names of fields alone
    made = known["__init__"]
    made.__qualname__, made.__module__ = f"{cls.__qualname__}.__init__", cls.__module__
    return made


def _argument(field: dataclasses.Field[Any]) -> str:
    if field.default is not MISSING:
        return f"{field.name}=of_{field.name}"
    return field.name if field.default_factory is MISSING else f"{field.name}=anew"


def _value(field: dataclasses.Field[Any]) -> str:
    name = field.name
    return name if field.default_factory is MISSING else f"of_{name}() if {name} is anew else {name}"


@cache
def _compared(cls: Any) -> Callable[[Any], tuple[Any, ...]]:
    """Values of the fields that make records equal."""
    names = [field.name for field in dataclasses.fields(cls) if field.compare]
    if len(names) > 1:
        return attrgetter(*names)
    return lambda record: tuple(getattr(record, name) for name in names)


@recursive_repr()
def _repr(self: Any) -> str:
    values = (f"{one.name}={getattr(self, one.name)!r}" for one in dataclasses.fields(self) if one.repr)
    return f"{type(self).__qualname__}({', '.join(values)})"


def _eq(self: Any, other: Any) -> bool:
    cls: Any = type(self)
    if other.__class__ is not cls:
        return NotImplemented  # type: ignore[no-any-return]
    values = _compared(cls)
    return values(self) == values(other)


def _hash(self: Any) -> int:
    cls: Any = type(self)
    return hash(_compared(cls)(self))


def _setattr(self: Any, name: str, value: Any) -> NoReturn:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _delattr(self: Any, name: str) -> NoReturn:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _getstate(self: Any) -> list[Any]:
    return [getattr(self, field.name) for field in dataclasses.fields(self)]


def _setstate(self: Any, state: list[Any]) -> None:
    for field, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)


_OF_EQUALS: dict[str, Any] = {"__eq__": _eq, "__hash__": _hash}
_OF_ALL: dict[str, Any] = {
    "__repr__": _repr,
    "__setattr__": _setattr,
    "__delattr__": _delattr,
}
_OF_SLOTS: dict[str, Any] = {"__getstate__": _getstate, "__setstate__": _setstate}
