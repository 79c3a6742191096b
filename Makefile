# Everything here runs in environments of the project's own, made on first use from the locks in .ci/requirements/.
PYTHON  ?= python3
VENV    ?= .venv
BIN     := $(VENV)/bin
INSTALL := python -m pip install --quiet --disable-pip-version-check --no-compile
LOCKED  := $(INSTALL) --require-hashes
HERE    := $(INSTALL) --no-deps --no-build-isolation --editable .

# Processes share the cores; a library that takes all of them for each makes every one slower.
export OPENBLAS_NUM_THREADS ?= 1

# As many processes as there are cores to run on; on one core none beside pytest's own.
WORKERS ?= $(shell $(PYTHON) -c 'import os; n = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(); print(n if n > 1 else 0)')
PYTEST  := python -m pytest --quiet --numprocesses $(WORKERS) --dist worksteal

.DEFAULT_GOAL := help
.PHONY: help demo test test-slow test-oldest test-newest lint fuzz bench completeness coverage corpora wheel audit docs playground site site-check lock clean

help:            ## what can be made
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*##/\t/' | expand -t 14

# What a user needs; what developers need beside it; what releases need beside that.
$(VENV)/user: .ci/requirements/user.txt .ci/requirements/build.txt pyproject.toml hatch_build.py $(wildcard robokin/kernel/native/*)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/$(LOCKED) -r .ci/requirements/user.txt -r .ci/requirements/build.txt
	$(BIN)/$(HERE)
	@touch $@

$(VENV)/dev: $(VENV)/user .ci/requirements/dev.txt
	$(BIN)/$(LOCKED) -r .ci/requirements/dev.txt
	@touch $@

$(VENV)/release: $(VENV)/dev .ci/requirements/release.txt
	$(BIN)/$(LOCKED) -r .ci/requirements/release.txt
	@touch $@

demo:            ## the pose of the PUMA 560, which needs nothing but Python; then install
	$(PYTHON) -m robokin fk puma560 --q home
	@$(MAKE) --no-print-directory $(VENV)/user
	@echo "installed: $(BIN)/robokin --help"

test: $(VENV)/dev ## the tests, without the slow laws: some ten minutes on two cores
	$(BIN)/$(PYTEST) -m 'not slow'

test-slow: $(VENV)/dev ## the slow laws: whole sweeps over the library and over random arms
	$(BIN)/$(PYTEST) -m slow

$(VENV)-oldest/installed: .ci/requirements/oldest.txt pyproject.toml
	$(PYTHON) -m venv $(VENV)-oldest
	$(VENV)-oldest/bin/$(LOCKED) -r .ci/requirements/oldest.txt
	$(VENV)-oldest/bin/$(HERE)
	@touch $@

PART := $(addprefix tests/,spatial formats test_imports.py test_installation.py test_fuzz.py mobility/test_screws.py \
  pictures/test_drawings.py cli/test_bad_input.py cli/test_fk.py cli/test_frame.py cli/test_help.py)
test-oldest: $(VENV)-oldest/installed ## three minutes' part of the tests with the lowest versions that pyproject.toml permits
	$(VENV)-oldest/bin/$(PYTEST) $(PART)

test-newest: $(VENV)/release ## the tests with the newest versions that there are today, without the lock
	$(PYTHON) -m venv --clear $(VENV)-newest
	$(BIN)/uv pip install --quiet --python $(VENV)-newest --upgrade --editable '.[plot,cluster]' --group test
	$(VENV)-newest/bin/$(PYTEST)

lint: $(VENV)/dev ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

fuzz: $(VENV)/dev ## hostile calls of every command for five minutes; FUZZ_SECONDS=30, FUZZ_SEED=7
	$(BIN)/python tests/fuzz.py

bench: $(VENV)/dev ## speed, as ratios against peers and limits, in one run; what got worse; make bench PEERS=SITE-PACKAGES
	PEERS=$(PEERS) $(BIN)/python -m benchmarks

completeness: $(VENV)/dev ## whether all solutions are all, counted; make completeness FULL=1 takes hours
	FULL=$(FULL) $(BIN)/python -m benchmarks.completeness

coverage: $(VENV)/dev ## whether the bounds of sizes hold as often as they say; make coverage FULL=1 takes hours
	FULL=$(FULL) $(BIN)/python -m benchmarks.coverage

corpora: $(VENV)/dev ## whether descriptions from the wild are read right; make corpora DIR='DIR …' PEERS=SITE-PACKAGES
	PYTHONPATH=$(PEERS) $(BIN)/python -m benchmarks.corpora $(DIR)

wheel: $(VENV)/release ## build the wheel and the list of what it stands on (CycloneDX) in dist/, and run it alone
	PYTHON=$(BIN)/python tests/wheel.sh

audit: $(VENV)/release ## known vulnerabilities of what the locks install
	$(BIN)/python tests/audit.py

docs: $(VENV)/dev ## rerun every command of README.md and docs/, and write what it prints now
	$(BIN)/python tests/documentation.py

playground: $(VENV)/dev ## robokin in the browser, as files that any server serves, in build/playground
	$(BIN)/python docs/playground/build.py build/playground

# The site's generator stands apart from what the project needs.
$(VENV)-site/installed: .ci/requirements/user.txt .ci/requirements/build.txt .ci/requirements/site.txt pyproject.toml
	$(PYTHON) -m venv $(VENV)-site
	$(VENV)-site/bin/$(LOCKED) -r .ci/requirements/user.txt -r .ci/requirements/build.txt -r .ci/requirements/site.txt
	$(VENV)-site/bin/$(HERE)
	@touch $@

# What stands in this folder is served as playground/ of the site.
PLAYGROUND ?= $(wildcard build/playground)
site: $(VENV)-site/installed ## docs/ and a gallery of the library as a static site in build/site, its links looked at
	PYTHONPATH=docs $(VENV)-site/bin/python -m website $(if $(PLAYGROUND),--playground $(PLAYGROUND))

# axe and a driver for the browser from npm, as the lock beside the check has them.
build/site-check: docs/website/accessibility/package-lock.json docs/website/accessibility/check.mjs
	mkdir -p $@ && cp docs/website/accessibility/*.json docs/website/accessibility/check.mjs $@
	cd $@ && npm ci --silent --no-audit --no-fund
	@touch $@

site-check: build/site-check ## the built site in chromium: accessibility, both themes, three widths; needs node and chromium
	node build/site-check/check.mjs build/site $(PICTURES)

# One resolution for all: what is pinned for developers is what users and releases get.
COMPILE := uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --upgrade --custom-compile-command 'make lock'
lock: $(VENV)/release ## renew the locks in .ci/requirements/ with today's versions
	$(BIN)/$(COMPILE) -o .ci/requirements/dev.txt pyproject.toml --extra plot --extra cluster --extra pandas --group dev
	$(BIN)/$(COMPILE) -o .ci/requirements/user.txt pyproject.toml --constraint .ci/requirements/dev.txt
	$(BIN)/$(COMPILE) -o .ci/requirements/build.txt --group build --constraint .ci/requirements/dev.txt
	$(BIN)/$(COMPILE) -o .ci/requirements/release.txt --group release --constraint .ci/requirements/dev.txt
	$(BIN)/$(COMPILE) -o .ci/requirements/site.txt --group site --constraint .ci/requirements/dev.txt
	$(BIN)/$(COMPILE) -o .ci/requirements/oldest.txt pyproject.toml --extra plot --group test --resolution lowest-direct

clean:           ## remove the environments and what was built
	rm -rf $(VENV) $(VENV)-oldest $(VENV)-newest $(VENV)-site dist build
