# Everything runs in .venv, which the first target that needs it makes.
SHELL := /bin/bash
TURN ?= 90
OUT ?= out
PYTHON ?=
VENV := .venv
READY := $(VENV)/.ready

.PHONY: help demo test lint format bench clean

help: ## list the targets
	@grep -E '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 10

demo: $(READY) ## turn a simulated robot: make demo [TURN=-135] [OUT=out]
	@$(VENV)/bin/omega_turn demo --turn-deg $(TURN) --out $(OUT)

test: $(READY) ## run all tests
	@$(VENV)/bin/python -m pytest

lint: $(READY) ## check style and types
	@$(VENV)/bin/ruff check . && $(VENV)/bin/ruff format --check . && $(VENV)/bin/mypy

format: $(READY) ## format the code
	@$(VENV)/bin/ruff format . && $(VENV)/bin/ruff check --fix .

bench: $(READY) ## measure what we claim about speed
	@for f in benchmarks/bench_*.py; do $(VENV)/bin/python $$f || exit 1; done

clean: ## remove what the other targets made
	rm -rf $(VENV) build install log $(OUT) *.egg-info .pytest_cache .mypy_cache .ruff_cache

$(READY): setup.py pyproject.toml tools/make_venv.sh
	@tools/make_venv.sh $(VENV) $(PYTHON)
	@touch $@
