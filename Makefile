# Every target does its own set-up: only Python 3.11 or newer, make and a network to the package index are needed.
# `make PYTHON=python3.12 test` takes another interpreter for the set-up.

# Python keeps what it compiles: containers that forbid it make every program start twice as slowly.
export PYTHONDONTWRITEBYTECODE :=

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# One more than the cores that the time budget counts on: a browser, a server, or a kernel that another worker is
# compiling, is waited for.
WORKERS ?= 3

# Marks of what is installed: made anew when pyproject.toml changes.
PACKAGE := $(VENV)/.package
DEV := $(VENV)/.dev
DOCS := $(VENV)/.docs
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet

.PHONY: help setup kernels swim lab test quick check lint types contracts pytest docs bench campaigns clean
.DEFAULT_GOAL := help

help:  ## Say what there is (the default)
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(PACKAGE): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "laticauda needs Python 3.11 or newer, \
	this is " + sys.version.split()[0] + "; try: make PYTHON=python3.11")'
	@echo "Installing laticauda into $(VENV) ..."
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); exit 1; }
	@$(PIP) install --upgrade pip
	@$(PIP) install --editable .
	@touch $@

$(DEV): $(PACKAGE)
	@echo "Installing the developers' tools into $(VENV) ..."
	@$(PIP) install --no-compile --editable '.[all,export]' --editable plugins/laticauda-gym --group dev  # Python compiles the part that it imports
	@touch $@

$(DOCS): $(DEV)
	@echo "Installing the documentation's tools into $(VENV) ..."
	@$(PIP) install --group docs
	@touch $@

setup: $(DEV)  ## Install the package and the developers' tools into .venv

# The library with which runs start without Numba. The installation makes it; after an edit of the kernels it is made anew.
kernels: $(PACKAGE)
	@$(BIN)/python -m laticauda.connect.native.kernel_library

swim: kernels  ## One of Mamba's trials, with its fin, beside what was measured
	@$(BIN)/laticauda swim mamba-fin --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130 \
	--phase-shift-deg 40 --duration 30

# Two processes that share nothing but a CAN bus, a network port and a serial line. LAB_FLAGS=--speed=2 goes faster.
lab: $(PACKAGE)  ## A path-following trial of Table 2 in the virtual tank, operated like the robot
	@$(PIP) install --editable '.[hardware]'
	@$(BIN)/python examples/lab/run.py $(LAB_FLAGS)

# The types are checked beside the tests, which leave part of the cores idle.
test: lint  ## Everything that CI runs
	@$(MAKE) --no-print-directory -j 2 contracts types pytest

quick: lint  ## Style, types and tests of what differs from the last commit, in a minute; BASE=main takes more
	@files="$$($(BIN)/python tests/changed.py sources $(BASE))"; [ -z "$$files" ] || $(BIN)/pyright $$files
	@places="$$($(BIN)/python tests/changed.py tests $(BASE))"; [ -z "$$places" ] || \
	$(BIN)/pytest -q -x -m "not slow" -n $(WORKERS) --dist worksteal tests/test_house.py tests/test_reading.py $$places

check: test  ## The same as test

lint: $(DEV)  ## Style and format
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check --quiet . || { echo "Not formatted: run .venv/bin/ruff format ."; exit 1; }

types: $(DEV)  ## Types, strictly
	@$(BIN)/pyright

contracts: $(DEV)  ## Imports point down the layers only
	@$(BIN)/lint-imports --no-logo

# The tests contain the code of the README and of the docs, and the examples.
pytest: $(DEV) kernels
	@$(BIN)/pytest -n $(WORKERS) --dist worksteal

docs: $(DOCS)  ## Build the documentation into site/
	@$(BIN)/python docs/make_font.py
	@$(BIN)/python docs/images/make.py
	@$(BIN)/python docs/make_gallery.py
	@$(BIN)/python docs/make_notebooks.py
	@PYTHONPATH=. $(BIN)/zensical build --clean --strict
	@$(BIN)/laticauda export web --output site/swim

# Every script of a folder; one that fails does not keep the others from running.
define run_all
	@failed=; for script in $(1)/[a-z]*.py; do echo "== $$script"; $(BIN)/python $$script || failed="$$failed $$script"; done; \
	[ -z "$$failed" ] || { echo "Failed:$$failed"; exit 1; }
endef

bench: $(DEV)  ## Speed, one script per question
	$(call run_all,benchmarks)

campaigns: $(DEV)  ## What is too long for every commit
	$(call run_all,campaigns)

clean:  ## Remove everything that was made here
	rm -rf $(VENV) site out build dist .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -prune -exec rm -rf {} +
