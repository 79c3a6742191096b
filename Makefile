# Everything here runs in an environment of the project's own, made on first use.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin

.DEFAULT_GOAL := help
.PHONY: help demo test lint bench completeness coverage wheel docs clean

help:            ## what can be made
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*##/\t/' | expand -t 14

$(VENV)/installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

demo: $(VENV)/installed ## install, and the pose of the PUMA 560's hand
	$(BIN)/robokin fk puma560 --q home

test: $(VENV)/installed ## the tests
	$(BIN)/python -m pytest --quiet

lint: $(VENV)/installed ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/installed ## speed, as ratios against peers and limits, in one run
	$(BIN)/python -m benchmarks

completeness: $(VENV)/installed ## whether all solutions are all, counted; make completeness FULL=1 takes hours
	FULL=$(FULL) $(BIN)/python -m benchmarks.completeness

coverage: $(VENV)/installed ## whether the bounds of sizes hold as often as they say; make coverage FULL=1 takes hours
	FULL=$(FULL) $(BIN)/python -m benchmarks.coverage

wheel: $(VENV)/installed ## build the wheel and run it alone, outside this folder
	PYTHON=$(BIN)/python tests/wheel.sh

docs: $(VENV)/installed ## rerun every command of README.md and docs/, and write what it prints now
	$(BIN)/python tests/documentation.py

clean:           ## remove the environment and what was built
	rm -rf $(VENV) dist build
