# `make` alone lists what there is. PYTHON=python3.12 make ... chooses the Python of .venv.

SHELL := /bin/bash
BIN := .venv/bin
# options for pytest: make test ARGS="-k canvas"
ARGS ?=

# inherited from a Python that has the ROS wheels: its libraries are not those of .venv
ifdef _ROS_WHEELS_BOOTSTRAP_COMPLETE
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH
endif

.PHONY: help install test lint demo bench clean
.DEFAULT_GOAL := help

help:
	@echo "make install   make .venv with everything in it; the programs are in .venv/bin"
	@echo "make demo      grade the reference controller: pictures and result in demo/"
	@echo "make test      run all tests                   (ARGS=\"-k name\" for some)"
	@echo "make lint      ruff and mypy"
	@echo "make bench     what the simulator and a grading cost: tables (minutes)"
	@echo "make clean     remove everything that was made here"
	@echo "PYTHON=python3.12 make install   with that Python (3.11, 3.12 or 3.13)"

install:
	@scripts/install.sh

test: install
	@echo "== running the tests"
	@$(BIN)/python -m pytest $(ARGS)

lint: install
	@echo "== ruff"
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@echo "== mypy"
	@$(BIN)/mypy

# -P: the installed package, not the folder of the same name here
demo: install
	@echo "== grading the reference controller"
	@$(BIN)/grader run "$$($(BIN)/python -P -c 'import turtlesim_challenge as c; print(c.__path__[0])')/turtle_controller.py" --out demo
	@echo "== the picture is demo/canvas.png, the result demo/result.json"

bench: install
	@$(BIN)/python benchmarks/node.py
	@$(BIN)/python benchmarks/grading.py

clean:
	rm -rf .venv build install log demo *.egg-info .eggs .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
