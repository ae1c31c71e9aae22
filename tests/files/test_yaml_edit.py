"""Fields of a YAML text are set, added and removed; the rest stays, comments too."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import Edit, YamlSource, edited

TEXT = """\
# the machine
name: Wägelchen   # ü
load:
  kind: hoist
  mass: 45 kg      # with the hook

  # of steel
  drum_diameter: 0.2 m
motion: {speed: 1 m/s, rest_time: 0 s}  # in one line
transmission:
  - kind: gearhead
  - {kind: belt, ratio: 1.1}   # pulleys
  - kind: gear
    ratio: 2   # two
    efficiency: 0.9
needs:
select:
  catalogs: [maxon, 'my parts.yaml']
  note: |
    two
    lines
supply:
    nominal: 24 V
"""


def data(text: str) -> Any:
    return YamlSource(text, "spec").data


@pytest.mark.parametrize(
    ("path", "value", "before", "after"),
    [
        (("load", "mass"), "50 kg", "mass: 45 kg      # with", "mass: 50 kg      # with"),
        (("name",), "a: b", "name: Wägelchen   # ü", 'name: "a: b"   # ü'),
        (("motion", "speed"), "2 m/s", "{speed: 1 m/s, rest", "{speed: 2 m/s, rest"),
        (("motion", "cruise_time"), "3 s", "rest_time: 0 s}", "rest_time: 0 s, cruise_time: 3 s}"),
        (("motion", "rest_time"), None, ", rest_time: 0 s}  #", "}  #"),
        (("motion", "speed"), None, "{speed: 1 m/s, rest", "{rest"),
        (("load", "falls"), 2, "0.2 m\nmotion", "0.2 m\n  falls: 2\nmotion"),
        (("load", "mass"), None, "  mass: 45 kg      # with the hook\n", ""),
        (("transmission", 1, "ratio"), "1.2", "ratio: 1.1}", "ratio: 1.2}"),
        (("transmission", 2, "ratio"), None, "    ratio: 2   # two\n", ""),
        (("transmission", 2, "kind"), None, "- kind: gear\n    ratio", "- ratio"),
        (("transmission", 1), None, "  - {kind: belt, ratio: 1.1}   # pulleys\n", ""),
        (("transmission", 3), {"kind": "direct"}, "0.9\nneeds", "0.9\n  - {kind: direct}\nneeds"),
        (("needs", "life"), "9 h", "needs:\n", "needs:\n  life: 9 h\n"),
        (("environment", "ambient"), "40 degC", "24 V\n", "24 V\nenvironment:\n  ambient: 40 degC\n"),
        (("supply", "nominal"), None, "supply:\n    nominal: 24 V\n", ""),
        (("supply", "min"), "22 V", "24 V\n", "24 V\n    min: 22 V\n"),
        (("select", "note"), "one", "note: |\n    two\n    lines\n", "note: one\n"),
        (("select", "catalogs"), ["all"], "  catalogs: [maxon, 'my parts.yaml']", "  catalogs:\n    - all"),
    ],
)  # fmt: skip
def test_one_place_of_the_text_changes(path: Any, value: Any, before: str, after: str) -> None:
    assert TEXT.count(before) == 1
    assert edited(TEXT, [Edit(path, value)]) == TEXT.replace(before, after)


def test_what_is_no_group_of_fields_or_no_yaml_is_refused() -> None:
    with pytest.raises(InputError, match=r'spec: load\.mass\.x: "45 kg" is no group of fields'):
        edited(TEXT, [Edit(("load", "mass", "x"), "1")])
    with pytest.raises(InputError, match="spec:1: not YAML"):
        edited("a: b: c", [Edit(("a",), "1")])
    assert data(edited("", [Edit(("load", "mass"), "1 kg")])) == {"load": {"mass": "1 kg"}}


KEYS = st.sampled_from(["a", "b", "c d", "é"])
TREES = st.recursive(
    st.sampled_from(["45 kg", "x: y", 3, True, "", "# no"]),
    lambda below: st.one_of(st.dictionaries(KEYS, below, min_size=1), st.lists(below, min_size=1, max_size=3)),
    max_leaves=8,
)


def paths(tree: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    steps = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    return [found for step, below in steps for found in ((*at, step), *paths(below, (*at, step)))]


def without(tree: Any, path: tuple[Any, ...]) -> Any:
    """The tree without a field, and without groups that are empty then."""
    *above, last = path
    place = tree
    for step in above:
        place = place[step]
    if len(place) == 1 and above:
        return without(tree, tuple(above))
    del place[last]
    return tree


@settings(max_examples=120, deadline=None)
@given(tree=st.dictionaries(KEYS, TREES, min_size=1), flow=st.booleans(), draw=st.data())
def test_random_documents_read_as_changed(tree: Any, flow: bool, draw: Any) -> None:
    import yaml

    text = yaml.safe_dump(tree, default_flow_style=flow, allow_unicode=True, sort_keys=False)
    path = draw.draw(st.sampled_from(paths(tree)))
    changed = copy.deepcopy(tree)
    place = changed
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = "7 mm"
    assert data(edited(text, [Edit(path, "7 mm")])) == changed
    if len(tree) > 1:
        assert data(edited(text, [Edit(path, None)])) == without(copy.deepcopy(tree), path)
    new = ("new", "field")
    assert data(edited(text, [Edit(new, "1 s")])) == {**tree, "new": {"field": "1 s"}}


def test_texts_stay_texts_in_groups_that_are_new() -> None:
    assert data(edited("", [Edit(("select", "motor", "part"), "110117", text=True)])) == {
        "select": {"motor": {"part": "110117"}}
    }
    assert data(edited("a: 1", [Edit(("c",), {"d": ["5"]}, text=True)])) == {"a": 1, "c": {"d": ["5"]}}


@pytest.mark.parametrize("path", [(), (0,), ("l", "a"), ("l", -1), ("l", 3), ("m", 0), ("m", "x", 5), ("t", "u")])
def test_a_path_that_is_none_is_refused(path: Any) -> None:
    text = "l: [1, 2]\nm: {x: 1}\nt: one\n"
    with pytest.raises(InputError, match=r"^spec: "):
        edited(text, [Edit(path, "x", text=True)])
    if path:
        assert edited(text, [Edit(path, None)]) == text
    else:
        with pytest.raises(InputError, match="names no field"):
            edited(text, [Edit(path, None)])


HOSTILE = [
    "? a\n: 1\nb: 2\n", "a: |\n  x\n  y\nb: 2\n", "a: >-\n  x\n\nb: 2", "'a b': \"c\\nd\"\nb: 'x\n  y'\n",
    "a: x\n  y\nb: 2\n", "%YAML 1.2\n---\na: 1\n...\n", "{a: 1, b: {c: 2}}\n", "[1, [2, {a: 3}]]\n",
    "a: 1 # x\x85b: 2\n",
    "a: ~\nb:\nc: ''\n", "a:\n- 1\n-\n  b: 2\n", "- a: 1\n  b: 2\n- {c: 3}\n", "1: 2\ntrue: 3\n",
    "a: 1   \n\n\n# end", "", "5", "a: [\n  1, # one\n]",
]  # fmt: skip
VALUES = [
    "x",
    5,
    None,
    True,
    ["x", 1],
    {"k": {"l": [1]}},
    "a: b",
    "# c",
    "",
    " x ",
    "x\ny",
    '"',
    "- 1",
    "{",
    "\u2028",
    "5",
]


@settings(max_examples=400, deadline=None)
@given(
    text=st.sampled_from(HOSTILE), value=st.sampled_from(VALUES), as_text=st.booleans(),
    path=st.lists(st.sampled_from(["a", "b", "c", "1", "x: y", "", 0, 1, 2]), max_size=3),
)  # fmt: skip
def test_whatever_the_text_no_other_field_changes(text: str, path: Any, value: Any, as_text: bool) -> None:
    """It reads as it was but for the field, by the paths of all others; or nothing is done."""
    before = data(text)
    try:
        after = data(edited(text, [Edit(tuple(path), value, as_text)]))
    except InputError:
        return
    if value is None:
        return  # what follows a removed entry of a list moves up: the laws above are of that
    kept = {at for at in paths(before) if at[: len(path)] != tuple(path) and tuple(path)[: len(at)] != at}
    assert {at: found(before, at) for at in kept} == {at: found(after, at) for at in kept}
    new = {at for at in paths(after) if at[: len(path)] != tuple(path) and tuple(path)[: len(at)] != at}
    assert new == kept
    if as_text:
        assert found(after, path) == value


def found(tree: Any, path: Any) -> Any:
    for step in path:
        tree = tree[step]
    return tree
