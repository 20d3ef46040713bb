# `make demo` and `make test` set up everything by themselves; they need git, make and Python >= 3.11 with venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

SOURCES := $(sort $(shell find drakearm systems diagrams -name '*.py' -o -name '*.yaml' -o -name '*.urdf'))

# The editable install links each file, so it is repeated when the list of files changes.
LINKED := $(VENV)/linked-$(shell echo $(SOURCES) | cksum | cut -d' ' -f1)

.PHONY: demo test lint bench clean

demo: $(LINKED) ## plan, train, evaluate and replay one movement
	$(BIN)/drakearm run timing-0.7s

test: $(LINKED) ## all tests, in parallel
	$(BIN)/pytest -n 2

bench: $(LINKED) ## how fast and how accurate, next to other packages where they are installed
	$(BIN)/python tests/benchmarks/speed.py
	$(BIN)/python tests/benchmarks/integration.py
	$(BIN)/python tests/benchmarks/planning.py
	$(BIN)/python tests/benchmarks/learning.py

lint: $(LINKED) ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

clean: ## removes everything that make made, but not runs/
	rm -rf $(VENV) build *.egg-info

$(VENV)/installed: constraints.txt pyproject.toml
	$(PYTHON) -c 'import sys; assert sys.version_info >= (3, 11), "drakearm needs Python 3.11 or newer"'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --constraint constraints.txt setuptools
	$(BIN)/pip install --quiet --constraint constraints.txt --no-build-isolation \
		--config-settings editable_mode=strict --editable .[test]
	rm -f $(VENV)/linked-*
	touch $@

$(LINKED): $(VENV)/installed
	$(BIN)/pip install --quiet --no-deps --no-build-isolation --config-settings editable_mode=strict --editable .
	rm -f $(VENV)/linked-*
	touch $@
