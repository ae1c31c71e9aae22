"""What another program sees of the package, and what importing it costs."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from importlib import import_module, resources
from inspect import ismodule
from pathlib import Path

import pytest

import drivesizer
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.robot import read_spec

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def modules_after(code: str) -> set[str]:
    """The names of all modules that a fresh interpreter has loaded after some code."""
    script = f"import sys\n{code}\nsys.stderr.write('\\n'.join(sys.modules))"
    run = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=dict(os.environ)
    )
    return set(run.stderr.split())


HEAVY = {"control", "matplotlib", "typst", "pint", "scipy.signal", "scipy.linalg", "scipy.integrate", "scipy.sparse"}


def test_importing_the_package_loads_nothing_but_itself() -> None:
    loaded = modules_after("import drivesizer")
    assert loaded & (HEAVY | {"numpy", "pydantic", "typer", "rich", "yaml"}) == set()


@pytest.mark.parametrize(
    "code",
    [
        "from drivesizer import load_spec, size; size(load_spec({spec!r}))",
        "import drivesizer.cli; sys.argv = ['drivesizer', 'size', {spec!r}]\n"
        "try: drivesizer.cli.main()\nexcept SystemExit: pass",
    ],
    ids=["sizing", "drivesizer size"],
)
def test_sizing_loads_neither_control_nor_figures(code: str, example: Path) -> None:
    """What is loaded stays, so that importing the command line or the names loads none of it either."""
    assert modules_after(code.format(spec=str(example))) & HEAVY == set()


def test_the_public_names() -> None:
    assert drivesizer.__all__ == [
        "CatalogError",
        "DrivesizerError",
        "InputError",
        "LoadCycle",
        "MachineSizing",
        "Prediction",
        "RobotSpec",
        "SizingResult",
        "Validation",
        "catalog",
        "design",
        "equations",
        "explain",
        "load_catalog",
        "load_machine",
        "load_spec",
        "predict",
        "size",
        "size_machine",
        "size_variants",
        "tables",
        "units",
        "validate",
    ]


@pytest.mark.parametrize("name", drivesizer.__all__)
def test_every_public_name_is_there_and_described(name: str) -> None:
    assert getattr(drivesizer, name).__doc__
    assert name in dir(drivesizer)


@pytest.mark.slow
def test_the_examples_of_the_manual_are_typed(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    for number, block in enumerate(re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)):
        assert not re.search(r"^(from|import) drivesizer\.", block, re.MULTILINE)  # no internal module is needed
        (tmp_path / f"example_{number}.py").write_text(block, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", f"--cache-dir={ROOT / '.mypy_cache'}", *tmp_path.glob("*.py")]
    run = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert run.returncode == 0, run.stdout


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'sise'"):
        drivesizer.sise  # noqa: B018


def _modules() -> list[str]:
    package = Path(drivesizer.__file__).parent
    paths = (path.relative_to(package.parent).with_suffix("") for path in package.rglob("*.py"))
    return sorted(".".join(path.parts).removesuffix(".__init__") for path in paths if path.name != "__main__")


def test_every_module_says_what_it_offers() -> None:
    modules = [import_module(name) for name in _modules()]
    assert len(modules) > 200
    assert not [module.__name__ for module in modules if not module.__doc__]
    offered = [(module, public) for module in modules for public in getattr(module, "__all__", ())]
    assert not [f"{module.__name__}.{public}" for module, public in offered if not hasattr(module, public)]


def test_what_ships_beside_the_code() -> None:
    package = resources.files("drivesizer")
    assert (package / "py.typed").is_file()  # type checkers read our types
    assert (package / "units" / "units.txt").is_file()
    assert PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]["catalogs"] == "drivesizer/catalogs"


def test_errors_that_the_user_can_mend_are_value_errors() -> None:
    assert issubclass(drivesizer.InputError, drivesizer.DrivesizerError) and issubclass(
        drivesizer.InputError, ValueError
    )
    assert issubclass(drivesizer.CatalogError, drivesizer.DrivesizerError)
    assert issubclass(drivesizer.CatalogError, ValueError)
    assert not issubclass(drivesizer.CatalogError, drivesizer.InputError)


# --- what the README promises --------------------------------------------------------------------------------------

README = (ROOT / "README.md").read_text(encoding="utf-8")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def test_the_spec_in_the_readme_finds_a_drive() -> None:
    (text,) = _blocks("yaml")
    assert drivesizer.size(read_spec(YamlSource(text, "README.md"))).sets[0].status == "pass"


def test_every_command_is_listed_and_every_listed_command_is_there() -> None:
    from drivesizer.cli import app

    there = {command.name or command.callback.__name__ for command in app.registered_commands if command.callback}
    there |= {str(group.name) for group in app.registered_groups}
    (listed,) = re.findall(r"^```sh\n(.*?)^```", (ROOT / "docs" / "commands.md").read_text(), re.MULTILINE | re.DOTALL)
    assert set(re.findall(r"^drivesizer ([a-z]+)", listed, re.MULTILINE)) == there


def test_the_output_in_the_readme_is_what_the_program_prints() -> None:
    (shown,) = _blocks("text")
    command = [sys.executable, "-m", "drivesizer", "size", "examples/sps_robot.yaml", "--quiet"]
    environment = {**os.environ, "COLUMNS": "80", "PYTHONIOENCODING": "utf-8"}
    run = subprocess.run(command, capture_output=True, check=True, cwd=ROOT, env=environment, encoding="utf-8")
    assert [line.rstrip() for line in run.stdout.splitlines()] == shown.splitlines()


# --- benchmarks

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
SOURCES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.py"))}


def imports(source: str) -> list[tuple[str, str]]:
    """Module and name of all that a script imports of the program."""
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ImportFrom))
    return [(node.module, alias.name) for node in nodes if (node.module or "").startswith("drivesizer")
            for alias in node.names]  # fmt: skip


def attributes(source: str, of: str) -> set[str]:
    """What a script takes of a name by a dot."""
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Attribute))
    return {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id == of}


@pytest.mark.parametrize("name", [name for name, source in SOURCES.items() if imports(source)])
def test_what_a_benchmark_imports_exists(name):
    for module, taken in imports(SOURCES[name]):
        there = import_module(module)
        found = getattr(there, taken) if hasattr(there, taken) else import_module(f"{module}.{taken}")
        assert [name for name in attributes(SOURCES[name], taken) if ismodule(found) and not hasattr(found, name)] == []


def test_every_goal_is_measured_by_a_benchmark_of_the_table(monkeypatch):
    monkeypatch.syspath_prepend(FOLDER)
    goals, scripts = import_module("goals").GOALS, import_module("table").SCRIPTS
    run = "".join(SOURCES[script] for script in scripts)
    assert [name for name in goals if f'"{name}"' not in run] == []


def test_a_release_has_one_version_in_every_place():
    """Program, citation, the newest heading of the changelog, the tag to set, and how far the project says to be."""
    text = {
        name: (ROOT / name).read_text(encoding="utf-8") for name in ("CITATION.cff", "CHANGELOG.md", "CONTRIBUTING.md")
    }
    version = drivesizer.__version__
    assert re.search(r"^version: (.+)$", text["CITATION.cff"], re.MULTILINE)[1] == version
    assert re.findall(r"^## (.+)$", text["CHANGELOG.md"], re.MULTILINE)[0] in (version, "Unreleased")
    assert f'git tag -a v{version} -m "drivesizer {version}"' in text["CONTRIBUTING.md"]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert ("Development Status :: 5 - Production/Stable" in project["classifiers"]) == (int(version[0]) > 0)
