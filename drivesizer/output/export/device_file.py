"""The file that a controller takes: its parameters in its own form, with what they stand for."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Comment, Element, SubElement, indent, tostring

import yaml

from drivesizer.control.devices import Device, Written
from drivesizer.errors import InputError, quoted

_SUFFIXES = {
    "json": ".json", "assignments": ".txt", "xml": ".xml", "yaml": ".yaml", "dcf": ".dcf", "sheet": ".txt",
    "ini": ".cfg",
}  # fmt: skip


def suffix_of(device: Device) -> str:
    """The end of the names of a controller's files."""
    return device.words["suffix"] or _SUFFIXES[device.words["form"]]


def accept(device: Device, path: Path) -> None:
    """Refuse a name that the controller's tool does not open."""
    suffix = suffix_of(device)
    if path.suffix.lower() != suffix:
        raise InputError(
            f"--output: {quoted(path)} is no name for {device.title}; expected a file that ends in {suffix}"
        )


def files(device: Device, rows: Sequence[Written], remarks: Sequence[str], path: Path) -> dict[Path, bytes]:
    """The controller's file; where its form takes no remarks these are a text beside it."""
    form, mark = device.words["form"], device.words["remarks"] or "#"
    if form == "xml":
        root = Element(device.words["root"])
        root.append(Comment("\n" + "\n".join(remarks).replace("--", "- -") + "\n"))
        for row in rows:
            SubElement(root, row.parameter.name).text = row.text
        indent(root)
        return {path: tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"}
    match form:
        case "json":
            body = json.dumps(_tree(rows), indent=2) + "\n"
        case "yaml":
            body = yaml.safe_dump(_tree(rows), sort_keys=False)
        case "dcf":
            body = _dcf(rows)
        case "ini":
            body = _ini(rows)
        case _:
            line, after = device.words["line"] or "{name} = {value}", device.words["after"]
            body = "".join(line.format(name=row.parameter.name, value=row.text) + "\n" for row in rows)
            body += f"{after}\n" if after else ""
    if form == "json" or mark == "beside":
        notes = "".join(f"{line}\n" for line in remarks)
        return {path: body.encode(), path.with_suffix(".read_back.txt"): notes.encode()}
    return {path: ("".join(f"{mark} {line}".rstrip() + "\n" for line in remarks) + "\n" + body).encode()}


def _tree(rows: Sequence[Written]) -> dict[str, Any]:
    """Parameters by the parts of their dotted names."""
    tree: dict[str, Any] = {}
    for row in rows:
        *parents, last = row.parameter.name.split(".")
        inner = tree
        for parent in parents:
            inner = inner.setdefault(parent, {})
        inner[last] = int(row.value) if row.parameter.rounding == "whole" else float(row.text)
    return tree


def _ini(rows: Sequence[Written]) -> str:
    """Sections of the names before the dot."""
    sections: dict[str, str] = {}
    for row in rows:
        section, _, name = row.parameter.name.rpartition(".")
        sections[section] = sections.get(section, f"[{section}]\n") + f"{name}: {row.text}\n"
    return "\n".join(sections.values())


def _dcf(rows: Sequence[Written]) -> str:
    """Sections of a device configuration file, ``[30A0sub1]``."""
    body = ""
    for row in rows:
        index, _, sub = row.parameter.name.removeprefix("0x").partition(":")
        body += f"[{index}sub{int(sub, 16):X}]\nParameterName={row.parameter.meaning}\nParameterValue={row.text}\n\n"
    return body
