# `make` alone lists the targets. Only Python 3.11 to 3.13 and make are needed.

VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed

# The first interpreter of a supported version that really starts.
SUPPORTED := import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))
FIND_PYTHON = for name in python3 python3.13 python3.12 python3.11; do \
	if "$$name" -c '$(SUPPORTED)' 2>/dev/null; then echo "$$name"; break; fi; done

DEMO_FLIGHT := demo-flight
DEMO_SIZE := 700x466
DEMO_RESULTS := demo-results
DEMO_MODELS := demo-models
DEMO_REPORT := demo-report.html
DEMO_COMBINATIONS := SIFT-SIFT-L2-*,AKAZE-AKAZE-HAM-BF,AKAZE-SIFT-L2-BF,KAZE-KAZE-L2-BF,ORB-ORB-HAM-*,$(\
	)ORB-BEBLID-HAM-BF,BRISK-BRISK-HAM-BF,FAST-FREAK-HAM-BF,AGAST-BRIEF-HAM-BF,GFTT_H-DAISY-L2-BF,$(\
	)GFTT_H-TEBLID-HAM-BF,STAR-LATCH-HAM-BF,MSER-SIFT-L2-BF

# Hundreds of processes start in tests: without this each would compile all of Python's modules again where a machine says so.
export PYTHONDONTWRITEBYTECODE :=

# Modules are compiled when they are first imported: most of them never are.
PIP := $(BIN)/python -m pip
INSTALL := install --quiet --no-compile --no-deps

# One process more than cores, as tests often wait for programs that they started. Neighbours, which share fixtures and compiled code, go
# to one process; one that is done early helps out.
PROCESSES := -n 3 --dist worksteal

# Extra arguments for pytest, for instance: make test PYTEST_ARGUMENTS="-k synthetic"
PYTEST_ARGUMENTS :=
STUDY :=

OLDEST_VENV := .venv-oldest
OLDEST_OPENCV := opencv-contrib-python-headless==4.11.0.86 numpy==2.2.6
OLDEST_INSTALLED := $(OLDEST_VENV)/.installed
# Tests of methods that say nothing about OpenCV.
WITHOUT_OPENCV := combination licences pixelmap plugins preset_files registration selection

AUDIT_VENV := .venv-audit
AUDIT_INSTALLED := $(AUDIT_VENV)/.installed
AUDIT_TOOLS := pip-audit==2.10.1 pip-licenses==5.5.5 cyclonedx-bom==7.5.0

DOCS_VENV := .venv-docs
DOCS_INSTALLED := $(DOCS_VENV)/.installed
DOCS_TOOLS := mkdocs-material==9.8.2 mkdocs==1.6.1 mkdocstrings==1.0.8 mkdocstrings-python==2.0.11 pymdown-extensions==13.1.2 plotly==7.1.0

LEARNED := packages/aerocues-learned
LEARNED_VENV := .venv-learned
LEARNED_INSTALLED := $(LEARNED_VENV)/.installed
TORCH_VENV := .venv-torch
TORCH_INSTALLED := $(TORCH_VENV)/.installed

LIGHT_VENV := .venv-light
LIGHT_INSTALLED := $(LIGHT_VENV)/.installed
LOCK := uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-header

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help setup demo test test-slow test-oldest-opencv test-light test-learned fresh-learned learned-weights lint lint-page audit docs bench study tables lock clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-20s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: $(INSTALLED) ## make .venv and install everything at the locked versions

$(BIN)/python:
	@python=$$($(FIND_PYTHON)); \
	if [ -z "$$python" ]; then echo "error: no Python 3.11 to 3.13 found; install one" >&2; exit 1; fi; \
	"$$python" -m venv $(VENV)

$(INSTALLED): requirements.lock pyproject.toml | $(BIN)/python
	$(PIP) $(INSTALL) --require-hashes -r requirements.lock
	$(PIP) $(INSTALL) --no-build-isolation -e .
	@touch $@

demo: setup ## fly, measure, rank, reconstruct and report: a simulated survey of six images (3 minutes)
	$(BIN)/aerocues simulate --survey mini --size $(DEMO_SIZE) -o $(DEMO_FLIGHT)
	$(BIN)/aerocues run simulated:$(DEMO_FLIGHT) -o $(DEMO_RESULTS) --timing-pairs 2 --combinations "$(DEMO_COMBINATIONS)"
	$(BIN)/aerocues reconstruct simulated:$(DEMO_FLIGHT) -o $(DEMO_MODELS) --from $(DEMO_RESULTS) --top 3
	$(BIN)/aerocues report $(DEMO_RESULTS) -o $(DEMO_REPORT)

test: setup ## the fast tests
	$(BIN)/pytest $(PROCESSES) -m "not slow" $(PYTEST_ARGUMENTS)

test-slow: setup ## the tests that take more than a few seconds each
	$(BIN)/pytest $(PROCESSES) -m slow $(PYTEST_ARGUMENTS)

test-oldest-opencv: $(OLDEST_INSTALLED) ## the tests of the methods with the oldest supported OpenCV
	$(OLDEST_VENV)/bin/python -m pytest $(PROCESSES) tests/methods $(WITHOUT_OPENCV:%=--ignore=tests/methods/test_%.py) -m "not slow" $(PYTEST_ARGUMENTS)

# What is not installed in it comes from the usual environment.
$(OLDEST_INSTALLED): $(INSTALLED)
	$(BIN)/python -m venv --clear --without-pip $(OLDEST_VENV)
	$(PIP) --python $(OLDEST_VENV)/bin/python $(INSTALL) $(OLDEST_OPENCV)
	@site() { $$1/bin/python -c 'import site; print(site.getsitepackages()[0])'; }; \
		printf '%s\n' "$$(site $(VENV))" "$(CURDIR)/src" > "$$(site $(OLDEST_VENV))/usual.pth"
	@touch $@

test-light: $(LIGHT_INSTALLED) ## the light install for boards: what it can, and that it says what it cannot
	$(PIP) wheel --quiet --no-deps --no-build-isolation --wheel-dir $(LIGHT_VENV)/wheel .
	$(PIP) --python $(LIGHT_VENV)/bin/python $(INSTALL) --no-index --force-reinstall $(LIGHT_VENV)/wheel/*.whl
	AEROCUES_LIGHT_PYTHON=$(CURDIR)/$(LIGHT_VENV)/bin/python $(BIN)/pytest tests/cli/test_light_install.py $(PYTEST_ARGUMENTS)

$(LIGHT_INSTALLED): requirements-light.lock $(INSTALLED)
	$(BIN)/python -m venv --clear --without-pip $(LIGHT_VENV)
	$(PIP) --python $(LIGHT_VENV)/bin/python $(INSTALL) --require-hashes -r requirements-light.lock
	@touch $@

# Its own wheel is installed, with what it needs at locked versions; the rest comes from the usual environment.
test-learned: $(LEARNED_INSTALLED) ## the tests of aerocues-learned
	$(PIP) wheel --quiet --no-deps --no-build-isolation --wheel-dir $(LEARNED_VENV)/wheel $(LEARNED)
	$(PIP) --python $(LEARNED_VENV)/bin/python $(INSTALL) --no-index --force-reinstall $(LEARNED_VENV)/wheel/*.whl
	$(LEARNED_VENV)/bin/python -m pytest $(LEARNED)/tests $(PYTEST_ARGUMENTS)

$(LEARNED_INSTALLED): $(LEARNED)/requirements.lock $(INSTALLED)
	$(BIN)/python -m venv --clear --without-pip $(LEARNED_VENV)
	$(PIP) --python $(LEARNED_VENV)/bin/python $(INSTALL) --require-hashes -r $(LEARNED)/requirements.lock
	@site() { $$1/bin/python -c 'import site; print(site.getsitepackages()[0])'; }; \
		printf '%s\n' "$$(site $(VENV))" "$(CURDIR)/src" > "$$(site $(LEARNED_VENV))/usual.pth"
	@touch $@

# Not part of the tests, as it installs everything from the index anew.
fresh-learned: | $(BIN)/python ## both wheels in an environment of their own: no torch, and then no network
	$(LEARNED)/fresh_environment.sh $(CURDIR)/$(BIN)/python

# Only who changes the graphs needs it; torch is in no other environment.
learned-weights: $(TORCH_INSTALLED) ## export the weights of aerocues-learned again, and the arrays of its tests (installs torch)
	$(TORCH_VENV)/bin/python $(LEARNED)/export/export.py
	$(TORCH_VENV)/bin/python $(LEARNED)/export/golden.py

$(TORCH_INSTALLED): $(LEARNED)/export/requirements.txt $(LEARNED)/export/carriers.txt | $(BIN)/python
	$(BIN)/python -m venv --clear $(TORCH_VENV)
	$(TORCH_VENV)/bin/python -m pip install --quiet -r $(LEARNED)/export/requirements.txt
	$(TORCH_VENV)/bin/python -m pip install --quiet --no-deps --require-hashes -r $(LEARNED)/export/carriers.txt
	@touch $@

lint: setup lint-page ## style, types (of the page's JavaScript, too) and the direction of imports
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

# The development install brings Node and npm; TypeScript comes from npm, at the version in package-lock.json.
lint-page: export PATH := $(CURDIR)/$(BIN):$(PATH)
lint-page: setup
	@if [ ! node_modules/.package-lock.json -nt package-lock.json ]; then \
		npm ci --ignore-scripts --no-audit --no-fund --loglevel=error; \
	fi; \
	if [ -f node_modules/typescript/bin/tsc ]; then \
		echo "tsc: the page's JavaScript"; node node_modules/typescript/bin/tsc -p .; \
	elif [ -n "$(CI)" ]; then echo "error: no TypeScript to check the page's JavaScript with" >&2; exit 1; \
	else echo "skipped: the page's JavaScript is not checked, as Node or TypeScript cannot be installed here" >&2; fi

# Their answers change from day to day: known weaknesses are asked for on the network, so that this is no part of `lint`.
audit: setup $(AUDIT_INSTALLED) ## known weaknesses and licences of what requirements.lock pins, and its bill of materials (sbom.cdx.json)
	$(AUDIT_VENV)/bin/cyclonedx-py requirements requirements.lock --output-file sbom.cdx.json
	$(AUDIT_VENV)/bin/pip-licenses --python $(BIN)/python --from mixed --order license --format csv | grep '^"' | cut -c 1-100
	$(AUDIT_VENV)/bin/pip-audit --disable-pip --require-hashes --strict -r requirements.lock

$(AUDIT_INSTALLED): Makefile | $(BIN)/python
	$(BIN)/python -m venv --clear $(AUDIT_VENV)
	$(AUDIT_VENV)/bin/python -m pip install --quiet $(AUDIT_TOOLS)
	@touch $@

# It reads the source without importing it. Only the first time needs the network, for the tools.
docs: $(DOCS_INSTALLED) ## the guide as a site, in site/; warnings are errors
	NO_MKDOCS_2_WARNING=1 $(DOCS_VENV)/bin/mkdocs build --quiet --strict

$(DOCS_INSTALLED): Makefile | $(BIN)/python
	$(BIN)/python -m venv --clear $(DOCS_VENV)
	$(DOCS_VENV)/bin/python -m pip install --quiet $(DOCS_TOOLS)
	@touch $@

bench: setup ## the benchmarks of the framework itself
	@for benchmark in $$(grep -l __main__ benchmarks/*.py); do echo "== $$benchmark"; $(BIN)/python "$$benchmark" || exit; done

# It goes on where it stopped, and ends with 3 where the budget is spent; more words, such as --budget 30min, --dry-run, --only PART or --verify: STUDY="--budget 30min"
study: setup ## measure the study, or go on with it: about 8 CPU hours; stored piece by piece in study/database
	$(BIN)/python -m study.measure $(STUDY) || [ $$? -eq 3 ]
	$(BIN)/python -m docs.study

tables: setup ## bring the tables of the guide up to date with the source and the study
	$(BIN)/python -m docs.tables
	$(BIN)/python -m docs.study

lock: setup ## pin the newest allowed versions in the files *.lock (needs uv)
	$(LOCK) pyproject.toml --all-extras --group dev --upgrade --output-file requirements.lock
	$(LOCK) --group light --constraint requirements.lock --output-file requirements-light.lock
	echo onnxruntime | $(LOCK) - --upgrade --constraint requirements.lock --no-emit-package numpy --no-emit-package packaging --output-file $(LEARNED)/requirements.lock

clean: ## remove everything that the other targets made
	rm -rf $(VENV) $(OLDEST_VENV) $(LIGHT_VENV) $(LEARNED_VENV) $(TORCH_VENV) $(AUDIT_VENV) $(DOCS_VENV) site sbom.cdx.json $(DEMO_FLIGHT) $(DEMO_RESULTS) $(DEMO_MODELS) $(DEMO_REPORT) study/work .coverage .coverage.* build dist $(LEARNED)/build
	rm -rf .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache node_modules
