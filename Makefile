# make demo     a moving avatar in demo.mp4, from a fresh clone
# make test     everything that is checked: lint, types, layers, tests
# make avatars  rebuild assets/avatars from their ingredients
# make lint     the quick half of make test
# make lock     the versions and hashes that CI installs, anew (asks the package index)
# make nightly  100,000 mutated files of each format, more bred for coverage, half an hour of the live loop in foul
#               weather (hours)
# make licences the licences of all that is installed, and build/sbom.json, its bill of materials

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SYSTEM_PACKAGES := libegl1 libgl1 libgl1-mesa-dri
WINDOW_PACKAGES := xvfb xdotool
SYSTEM := build/system.stamp
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: demo test avatars lint lock nightly licences clean

demo: $(VENV)/base.stamp $(VENV)/warm.stamp
	$(BIN)/gemheads demo

test: lint build/window.stamp
	$(BIN)/pytest

nightly: $(VENV)/dev.stamp
	$(BIN)/python tests/bench/fuzz.py --inputs 100000
	if $(BIN)/pip install -q atheris; then $(BIN)/python tests/bench/coverage_fuzz.py all --seconds 300; fi
	$(BIN)/python tests/bench/soak.py --minutes 30

lint: $(VENV)/dev.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/basedpyright
	$(BIN)/lint-imports

avatars: $(VENV)/avatars.stamp
	$(BIN)/python -m gemheads.models.heads

lock: $(VENV)/dev.stamp
	$(BIN)/pip install --quiet pip-tools
	$(BIN)/python .ci/lock

licences: $(VENV)/dev.stamp
	$(BIN)/python -m tests.supply.licences train dev
	@mkdir -p build && $(BIN)/python -m tests.supply.sbom train dev > build/sbom.json && echo build/sbom.json

# The drawing kernels are compiled once (half a minute) and kept, so that no picture ever waits for them.
$(VENV)/warm.stamp: $(VENV)/base.stamp $(wildcard render/*.py models/posing.py models/gem.py)
	@echo "Compiling the drawing kernels, once (up to half a minute) ..."
	@$(BIN)/python -m gemheads.app.warm
	@touch $@

$(VENV)/base.stamp: $(VENV)/bin/python pyproject.toml constraints.txt .ci/install .ci/requirements.txt $(SYSTEM)
	.ci/install $(BIN)
	@touch $@

$(VENV)/dev.stamp: $(VENV)/base.stamp
	.ci/install $(BIN) '[train,dev]'
	@touch $@

$(VENV)/avatars.stamp: $(VENV)/base.stamp
	.ci/install $(BIN) '[avatars]'
	@touch $@

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "gemheads needs Python 3.11 or newer; name one: make demo PYTHON=/path/to/python3.12"; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || .ci/system-packages python3-venv
	$(PYTHON) -m venv $(VENV)

$(SYSTEM):
	@.ci/system-packages $(SYSTEM_PACKAGES)
	@mkdir -p $(dir $@) && touch $@

build/window.stamp:
	@.ci/system-packages $(WINDOW_PACKAGES)
	@mkdir -p $(dir $@) && touch $@

clean:
	rm -rf $(VENV) build
