"""Strict YAML: core scalars, unique keys, nothing that surprises or explodes."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource, read


def data(text):
    return YamlSource(text, "f.yaml").data


def test_core_schema_scalars():
    got = data("a: 1\nb: [2.5, x, 27:1, on, yes, ~, '5', 0123, 1_000, 0x1F, 1e5, .5, 2021-06-01, true]\nc: |\n  text\n")
    assert got == {
        "a": 1,
        "b": [2.5, "x", "27:1", "on", "yes", None, "5", "0123", "1_000", "0x1F", 1e5, 0.5, "2021-06-01", True],
        "c": "text\n",
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\na: 2", ":2: the key"),
        ("a: &x 1\nb: *x", "anchors"),
        ("b: *x", "anchors"),
        ("a: !!python/object:os.system x", "tag"),
        ("a: !mine 5", "tag"),
        ("<<: {a: 1}", "merge"),
        ("a:\n\t- 1", "not tabs"),
        ("---\na: 1\n---\nb: 2", "second document"),
        ("a: [1", "not YAML"),
        ("? [1, 2]\n: 3", "key must be plain"),
        ("a: \x00", "not allowed"),
        ("[" * 100_000, "nested deeper"),
        ("- " * 50 + "x", "nested deeper"),
        ("a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]", "anchors"),
    ],
)
@pytest.mark.timeout(60)  # what is nested or repeated without bounds would take for ever
def test_refused(text, words):
    assert words in refusal(lambda: data(text))


def test_positions():
    source = YamlSource("a: 1\nb:\n  - {c: 1}\n  - c: 5\n    d: 6\n", "f.yaml")
    assert source.where(("b", 1, "d")) == "f.yaml:5: b[2].d"
    assert source.where(("b", 1, "none")) == "f.yaml:4: b[2].none"
    assert source.where(()) == "f.yaml"


def test_a_huge_file_is_refused_unread(tmp_path):
    path = tmp_path / "big.yaml"
    with path.open("wb") as file:
        file.truncate(10**9)
    with pytest.raises(InputError, match="larger than"):
        read(path)


@given(st.text(max_size=60))
def test_any_text_is_data_or_an_input_error(text):
    try:
        data(text)
    except InputError as error:
        assert "\n" not in str(error)
