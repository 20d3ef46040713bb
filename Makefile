# `make demo` and `make test` set up everything by themselves; they need git, make and Python >= 3.11 with venv.
# `make test PYTHON=python3.12` sets up .venv with that Python, if there is no .venv yet.

VENV := .venv
BIN := $(VENV)/bin
PYTHON ?= $(firstword $(wildcard $(BIN)/python) python3)

version_of = $(shell $(1) -c 'import sys; print("%d.%d" % sys.version_info[:2])')
VERSION := $(call version_of,$(PYTHON))

# A .venv of another Python is not used by accident.
VENV_VERSION := $(if $(wildcard $(BIN)/python),$(call version_of,$(BIN)/python),$(VERSION))
ifneq ($(MAKECMDGOALS),clean)
ifneq ($(VERSION),$(VENV_VERSION))
$(error $(VENV) has Python $(VENV_VERSION) and $(PYTHON) is Python $(VERSION): run `make clean` first, or make without PYTHON=)
endif
endif

# Python 3.11 gets the versions of packages that CI uses, any newer Python the newest versions that were tried.
CONSTRAINTS := constraints/python$(if $(filter 3.11,$(VERSION)),3.11,3.12).txt

SOURCES := $(sort $(shell find drakearm systems diagrams -name '*.py' -o -name '*.yaml' -o -name '*.urdf' -o -name '*.obj' -o -path '*/policies/*/*' -o -name '*.html' -o -name '*.css' -o -name '*.js' -o -name '*.csv'))

# The editable install links each file, so it is repeated when the list of files changes.
LINKED := $(VENV)/linked-$(shell echo $(SOURCES) | cksum | cut -d' ' -f1)

.PHONY: demo test test-extra test-cpus fuzz faults lint docs bench pictures clean

demo: $(LINKED) ## plan, train, evaluate and replay one movement
	$(BIN)/drakearm run timing-0.7s

# Three workers for two cores: many tests wait for processes that they started.
test: $(LINKED) ## the tests of the code, in parallel
	$(BIN)/pytest -n 3 --dist worksteal -m 'not extra'

test-extra: $(LINKED) ## documentation, pages in a browser, benchmarks, the release, sweeps and attacks
	$(BIN)/pytest -n 3 --dist worksteal -m extra

test-cpus: $(LINKED) ## the quick tests as on other processors: PyTorch without vectors, then Numba with AVX2 at most
	ATEN_CPU_CAPABILITY=default $(BIN)/pytest -n 2 -m 'not slow'
ifeq ($(shell uname -m),x86_64)
	NUMBA_CPU_NAME=haswell NUMBA_CPU_FEATURES=+avx2,+fma $(BIN)/pytest -n 2 -m 'not slow'
endif

faults: $(LINKED) ## kills commands at 100 random moments and checks that nothing is damaged or lost
	$(BIN)/python tests/attacks/faults.py

pictures: $(LINKED) ## remakes the pictures of the README and of docs from shipped policies
	$(BIN)/python docs/make_pictures.py
	$(BIN)/python docs/draw_diagrams.py
	$(BIN)/python docs/draw_holding.py
	$(BIN)/python tests/benchmarks/integration.py

bench: $(LINKED) ## how fast and how accurate, next to other packages where they are installed
	$(BIN)/python tests/benchmarks/speed.py
	$(BIN)/python tests/benchmarks/integration.py
	$(BIN)/python tests/benchmarks/planning.py
	$(BIN)/python tests/benchmarks/learning.py

fuzz: $(LINKED) ## reads and uses 10 000 malformed files of all types
	$(BIN)/python tests/attacks/fuzz.py

lint: $(LINKED) ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/codespell *.md docs drakearm systems diagrams examples

docs: $(LINKED) ## the documentation as a site, docs/_build/html/index.html; every warning is an error
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet -b html $(SPHINXOPTS) docs docs/_build/html
	$(BIN)/python docs/check_links.py docs/_build/html

clean: ## removes everything that make created, except runs/
	rm -rf $(VENV) build docs/_build *.egg-info

$(BIN)/pip:
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("drakearm needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: $(CONSTRAINTS) pyproject.toml | $(BIN)/pip
	$(BIN)/pip install --quiet --constraint $(CONSTRAINTS) setuptools
	$(BIN)/pip install --quiet --constraint $(CONSTRAINTS) --no-build-isolation \
		--config-settings editable_mode=strict --editable .[test]
	rm -f $(VENV)/linked-*
	touch $@

$(LINKED): $(VENV)/installed
	$(BIN)/pip install --quiet --no-deps --no-build-isolation --config-settings editable_mode=strict --editable .
	rm -f $(VENV)/linked-*
	touch $@
