# `make` alone lists what there is. `run` and `test` first set up what is missing.
.PHONY: help setup ready run test lock
.DEFAULT_GOAL := help

help:  ## list the targets
	@sed -nE 's/^([a-z]+):.*## (.*)/make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 14

setup:  ## virtual environment, OpenGL and LLVM: whatever is missing (PYTHON=... chooses the interpreter)
	@scripts/setup.sh --check

ready:
	@scripts/setup.sh

run: ready  ## the main job: the quick suite, techniques beside the reference
	@.venv/bin/airlight run quick

test: ready  ## every check: lint, format, types, tests
	@echo "ruff check: lint";          .venv/bin/ruff check .
	@echo "ruff format: layout";       .venv/bin/ruff format --check .
	@echo "mypy: types";               .venv/bin/mypy
	@echo "pytest: behaviour";         .venv/bin/pytest

lock:  ## resolve pyproject.toml into requirements.lock anew (needs uv; UPGRADE=--upgrade takes newer versions)
	@command -v uv >/dev/null || { echo "make lock needs uv: pip install uv" >&2; exit 2; }
	uv pip compile pyproject.toml --extra dev --universal --python-version 3.11 --generate-hashes \
		--no-emit-index-url --no-emit-find-links --custom-compile-command "make lock" \
		$(UPGRADE) --quiet --output-file requirements.lock
