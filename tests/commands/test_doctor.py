"""`drivesizer doctor`: what is found, and what is said where something does not work."""

from __future__ import annotations

import json
from importlib import metadata

import pytest
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.commands import setup

RUN = CliRunner()


def by_subject(findings):
    return {one.subject: one for one in findings}


def test_this_installation_works():
    found = by_subject(setup.examined())
    assert all(one.works for one in found.values()), [one for one in found.values() if not one.works]
    assert found["numpy"].found == metadata.version("numpy")
    assert {"Python", "cache", "catalogues", "closed loop", "figures", "PDF and fonts", "terminal"} <= found.keys()
    wanted = {line.split(">=")[0] for line in metadata.requires("drivesizer") if "extra" not in line}
    assert wanted <= found.keys()


def test_at_the_terminal_and_as_json():
    shown = RUN.invoke(app, ["doctor"])
    assert shown.exit_code == 0 and "Everything works." in shown.stdout
    document = json.loads(RUN.invoke(app, ["doctor", "--json"]).stdout)
    assert [one["subject"] for one in document["findings"]][:2] == ["drivesizer", "Python"]


def test_a_cache_that_cannot_be_written(tmp_path, monkeypatch):
    (tmp_path / "taken").write_text("a file", encoding="utf-8")
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "taken"))
    shown = RUN.invoke(app, ["doctor"])
    assert shown.exit_code == 1
    assert "cannot be written" in " ".join(shown.stdout.split()) and "DRIVESIZER_CACHE" in shown.stdout


@pytest.mark.parametrize("version", ["0.0.9", None])
def test_a_library_that_is_old_or_missing(version, monkeypatch):
    known = metadata.version

    def version_of(name):
        if name != "typst":
            return known(name)
        if version is None:
            raise metadata.PackageNotFoundError(name)
        return version

    monkeypatch.setattr(setup.metadata, "version", version_of)
    found = by_subject(setup.examined())["typst"]
    assert (found.works, found.found) == (False, version or "missing")
    assert found.remedy.startswith("pip install 'typst>=")
