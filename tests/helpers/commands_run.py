"""A command, run as a user would."""

from __future__ import annotations

import pytest

from drivesizer import cli


def run(capsys, monkeypatch, *words):
    monkeypatch.setattr("sys.argv", ["drivesizer", *map(str, words)])
    with pytest.raises(SystemExit) as end:
        cli.main()
    out = capsys.readouterr()
    return end.value.code, out.out, out.err
