"""Files of single axes joined to one: names with the axis before them, so that none is there twice."""

from __future__ import annotations

from collections.abc import Collection
from xml.etree.ElementTree import Comment, Element

from drivesizer.errors import InputError, quoted
from drivesizer.output.export.markup import identifier

__all__ = ["Adding", "free_name"]

_NAMES = ("name", "joint", "link", "actuator", "site", "tendon")  # attributes that name something


def free_name(wanted: str, taken: Collection[str]) -> str:
    """A name that is not taken, with underscores behind it where it is.

    Parameters
    ----------
    wanted, taken
        A name, and those that are there.

    Returns
    -------
    str
        The name.

    Examples
    --------
    >>> free_name("payload", {"payload"})
    'payload_'
    """
    while wanted in taken:
        wanted += "_"
    return wanted


class Adding:
    """A document to which those of single axes are added."""

    def __init__(self, root: Element, tags: Collection[str]) -> None:
        self.tags = tags
        self.taken = set(self._names(root))

    def _names(self, root: Element) -> list[tuple[str, str]]:
        return [
            (str(one.tag), one.attrib["name"]) for one in root.iter() if one.tag in self.tags and "name" in one.attrib
        ]

    def add(self, axis: str, tree: Element, target: Element, *, kept: str = "", instead: str = "") -> None:
        """Add what is in the document of one axis.

        Parameters
        ----------
        axis
            Its name.
        tree
            The document, or a part of it.
        target
            Element that gets its children.
        kept, instead
            A name that all axes share, and the one in its place.

        Raises
        ------
        InputError
            When a name is there already.
        """
        before = identifier(axis)
        for element in tree.iter():
            for attribute in _NAMES:
                name = element.attrib.get(attribute)
                if name is not None:
                    element.attrib[attribute] = instead if name == kept else f"{before}_{name}"
        children = [one for one in tree if not (kept and one.attrib.get("name") == instead)]
        for key in [name for one in children for name in self._names(one)]:
            if key in self.taken:
                raise InputError(f"axis {quoted(axis)}: a {key[0]} {quoted(key[1])} is there already; rename the axis")
            self.taken.add(key)
        target.append(Comment(f" Axis {before}. "))
        target.extend(children)
