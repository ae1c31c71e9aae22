"""Packages that the project needs: their pinned versions, and their licences on the page."""

from __future__ import annotations

import re
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest

pytest.importorskip("packaging", reason="comes with the tools of developers")
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests" / "tools"), str(ROOT / "docs" / "generated")]

import constraints  # noqa: E402
import licence_page  # noqa: E402

LINES = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
PINNED = dict(line.split("==") for line in LINES if not line.startswith("#"))
ROW = re.compile(r"^\| ([\w.-]+) \| ([\w.]+) \| (.+) \| <https?://[^>]+> \|$", re.MULTILINE)
PAGE = {
    name: (version, words) for name, version, words in ROW.findall((ROOT / "docs" / "licences.md").read_text("utf-8"))
}
FAMILIES = {"GPL": "GPL", "MPL": "MPL", "Mozilla": "MPL", "Apache": "Apache", "BSD": "BSD", "MIT": "MIT", "ISC": "ISC",
            "PSF": "PSF", "Python Software": "PSF"}  # fmt: skip


# --- pinned versions


@pytest.mark.parametrize("extra", constraints.declared())
def test_what_is_declared_is_pinned_within_its_bounds(extra):
    """After a change of pyproject.toml: make constraints."""
    for one in constraints.declared()[extra]:
        assert one.specifier.contains(PINNED[canonicalize_name(one.name)]), one


def test_the_file_is_nothing_but_packages_and_versions():
    assert all(re.fullmatch(r"[a-z0-9][a-z0-9-]*==[0-9][\w.]*", line) for line in LINES if not line.startswith("#"))
    assert list(PINNED) == sorted(PINNED) and "drivesizer" not in PINNED


def test_what_a_package_brings_is_pinned_too_and_extras_that_nobody_named_are_not():
    found = constraints.pinned(
        one for one in constraints.declared()["dev"] if one.name in ("mkdocstrings", "jsonschema")
    )
    assert {"mkdocstrings-python", "referencing", "attrs"} <= set(found)  # of the extra [python]; of the first; of that
    assert not {"webcolors", "fqdn"} & set(found)  # jsonschema[format]


# --- licences


def test_every_direct_dependency_is_on_the_page_of_licences():
    """After a change of pyproject.toml: python docs/generate.py docs/licences.md."""
    declared = {one.name for group in constraints.declared().values() for one in group}
    assert set(PAGE) == declared == {name for names in licence_page.groups().values() for name in names}


def families(words: str) -> set[str]:
    return {family for word, family in FAMILIES.items() if word in words}


@pytest.mark.parametrize("name", PAGE)
def test_its_licence_is_that_of_the_page(name):
    """Of the page's version to the letter; of another by its family, for packages word it anew from time to time."""
    try:
        installed = distribution(name)
    except PackageNotFoundError:
        pytest.skip("not installed")
    version, words = PAGE[name]
    now = licence_page.licence(installed)
    assert families(now) and (now == words if installed.version == version else families(now) & families(words)), now


def test_what_is_always_installed_and_the_extras_are_free_of_copyleft():
    groups = licence_page.groups()
    ours = [name for title, names in groups.items() if title != "Tools of developers" for name in names]
    assert len(ours) > 20
    assert [name for name in ours if families(PAGE[name][1]) & {"GPL", "MPL"}] == []
    assert [n for n in groups["Tools of developers"] if families(PAGE[n][1]) & {"GPL", "MPL"}] == ["hypothesis"]
