# Two commands do all set-up on a fresh machine: `make demo` and `make test`.
VENV ?= .venv
PYTHON ?= python3
BIN := $(VENV)/bin
READY := $(VENV)/.ready
export OMP_NUM_THREADS ?= 1

.PHONY: demo test check lint types pytest setup rendering bench evaluate clean

demo: rendering  ## Type a sentence, watch the hand: the main job, with a video
	$(BIN)/taskgrasp grasp "hand me the screwdriver" --seed 0 --video grasp.mp4

test: rendering lint types pytest  ## What CI runs

lint:
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types:
	$(BIN)/mypy

pytest:
	$(BIN)/python -m pytest -m "not slow and not gpu" -n 2

bench: rendering  ## Speed as ratios in one run, and the slow tests
	$(BIN)/python -m pytest -m slow
	$(BIN)/python train/benchmark.py

evaluate: rendering  ## The success tables (hours)
	$(BIN)/taskgrasp evaluate --episodes 100 --out reports/evaluate

setup: $(READY)

$(READY): pyproject.toml constraints.txt
	sh .ci/python.sh $(PYTHON) $(VENV)
	$(BIN)/pip install -q -c constraints.txt -e ".[dev,train]"
	touch $(READY)

rendering: setup  ## A Vulkan driver where we may install one; advice elsewhere
	sh .ci/rendering.sh $(BIN)/python

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache grasp.mp4
