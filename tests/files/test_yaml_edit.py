"""Fields of a YAML text are set, added and removed; the rest stays, comments too."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivesizer.errors import InputError
from drivesizer.files.yaml_edit import Edit, edited
from drivesizer.files.yaml_source import YamlSource

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


def test_texts_are_quoted_where_yaml_would_read_something_else() -> None:
    assert data(edited("name: a\n", [Edit(("name",), "5", text=True)])) == {"name": "5"}
    assert data(edited("n: 1\n", [Edit(("n",), "5")])) == {"n": 5}
    for odd in ("on: off", "# no comment", "- x", "{a", " b ", "a #b", "", "é\t", "[1, 2]", "1, 2", "*a", "!x", '"'):
        assert data(edited("{name: a}", [Edit(("name",), odd, text=True)])) == {"name": odd}


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
