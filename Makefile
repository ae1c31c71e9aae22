# make run, make test: nothing but Python 3.11 or later (with pip) and make are needed.
# Another Python: make PYTHON=python3.12 run

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# One stamp per Python: another PYTHON makes the environment anew. What only developers need comes with the second.
# make CONSTRAINTS=constraints.txt test: in the versions of that file, in place of the newest that pyproject.toml allows.
CONSTRAINTS ?=
MADE_FOR := $(notdir $(PYTHON))$(addprefix -,$(notdir $(CONSTRAINTS)))
READY := $(VENV)/.ready-$(MADE_FOR)
TOOLS := $(VENV)/.tools-$(MADE_FOR)
INSTALL := $(BIN)/pip install --quiet --disable-pip-version-check --no-compile $(addprefix -c ,$(CONSTRAINTS))
WHEEL := build/wheel

.PHONY: run test test-all lowest campaign campaign-short mutants lint docs wheel constraints bench clean

run: $(READY)
	$(BIN)/drivesizer size examples/sps_robot.yaml

# What guards right answers. Browsers, killed processes, the built site, every command of the pages and what goes through
# all starters or makers: test-all.
PARALLEL := --numprocesses auto --dist worksteal

test: $(TOOLS)
	$(BIN)/pytest $(PARALLEL) -m "not slow"

test-all: $(TOOLS)
	$(BIN)/pytest $(PARALLEL)

# The tests in the lowest versions that pyproject.toml allows, in an environment of its own; that those warn of
# newer ones is no failure. The same with another Python: make PYTHON=python3.14 VENV=build/python3.14 test
lowest: $(TOOLS)
	mkdir -p build
	$(BIN)/python tests/tools/lowest.py > build/lowest.txt
	$(MAKE) VENV=build/lowest CONSTRAINTS=build/lowest.txt PYTEST_ADDOPTS='-W ignore::DeprecationWarning' test

# Inputs changed by chance, which nothing of it may break: half an hour, and the two minutes of the gate.
campaign: $(TOOLS)
	$(BIN)/python tests/campaign --inputs 100000 --minutes 30 --processes 2

campaign-short: $(TOOLS)
	$(BIN)/python tests/campaign --inputs 20000 --minutes 2

mutants: $(TOOLS)
	$(BIN)/python tests/tools/mutants.py

lint: $(TOOLS)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# The documentation as a site; a warning is a failure (with --quiet none is counted).
docs: $(TOOLS)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# The wheel, built out of the source archive, at work in an empty environment and in another folder.
wheel: $(TOOLS)
	rm -rf dist $(WHEEL)
	$(BIN)/python -m build --outdir dist > /dev/null
	$(PYTHON) -m venv $(WHEEL)
	$(WHEEL)/bin/pip install --quiet --disable-pip-version-check --no-compile dist/*.whl
	bin="$$PWD/$(WHEEL)/bin" && spec="$$PWD/examples/sps_robot.yaml" && away=$$(mktemp -d) && \
	trap 'rm -rf "$$away"' EXIT && cd "$$away" && export DRIVESIZER_CACHE="$$away/cache" && \
	cp "$$spec" robot.yaml && "$$bin/drivesizer" size --quiet && "$$bin/drivesizer" validate && \
	"$$bin/drivesizer" report -o report.pdf -o report.html && test -s report.pdf && test -s report.html && \
	"$$bin/drivesizer" doctor

# The versions of the environment as it is now.
constraints: $(TOOLS)
	$(BIN)/python tests/tools/constraints.py > constraints.txt

bench: $(TOOLS)
	$(BIN)/python benchmarks/table.py

clean:
	rm -rf $(VENV) build dist site .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): pyproject.toml $(CONSTRAINTS)
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "drivesizer needs Python 3.11 or later; try make PYTHON=python3.12")'
	@echo "installing drivesizer and its libraries into $(VENV) (about 450 MB, a minute or more) ..."
	$(PYTHON) -m venv --clear $(VENV)
	$(INSTALL) -e .
	touch $@

$(TOOLS): $(READY)
	@echo "installing the tools of developers into $(VENV) ..."
	$(INSTALL) -e '.[dev]'
	touch $@
