# make test   lint, types and tests in .venv
# make demo   failure indices of a notch from a picture, in demo/
# A stamp inside .venv says what is installed there, so that a second make starts at once.

PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

# Small matrices are up to 30 times faster with one thread; the numerical kernels have their own.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: test demo clean

test: .venv/.installed-test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/pytest -n 2 --dist worksteal

demo: .venv/.installed
	mkdir -p demo
	$(BIN)/slmm initiation examples/notch.toml -o demo/notch.nc --plot demo/notch.png

.venv/.created:
	$(PYTHON) -m venv .venv
	touch $@

.venv/.installed: .venv/.created pyproject.toml constraints.txt
	$(PIP) -e .
	touch $@

.venv/.installed-test: .venv/.created pyproject.toml constraints.txt
	$(PIP) -e '.[test]'
	touch $@ .venv/.installed

clean:
	rm -rf .venv demo build dist
