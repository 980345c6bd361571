# The commands of Microcosmos. They need Python 3.11 or 3.12 and make.

PYTHON ?= $(shell command -v python3.12 >/dev/null && python3.12 -c '' 2>/dev/null && echo python3.12 || echo python3)
VENV := .venv
BIN := $(VENV)/bin
LOCK := $(shell nvidia-smi -L >/dev/null 2>&1 && echo requirements-cuda.lock || echo requirements.lock)
INSTALLED := $(VENV)/installed-$(LOCK)
KERNEL := $(VENV)/kernel
KERNEL_SOURCES := $(shell find engine/kernels -name __pycache__ -prune -o -type f -print)
# Node is installed from the registry if the machine has none.
NPM = PATH="$(CURDIR)/$(BIN):$$PATH" npm --prefix web
WEB_SOURCES := $(shell find web -path web/node_modules -prune -o -path web/dist -prune -o -type f -print) docs/glossary.md

# Tests start hundreds of processes, which need not read all sources anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run install web wheels simulator style-python style-page test test-all mutants check peers lab \
	bench acceptance fuzz validate pictures docs texts release-check lock

run: install web
	@$(BIN)/python -m microcosmos_server.local

# uv installs in a third of pip's time. It reads no settings of pip: where these name another
# registry, which uv does not find, pip installs.
fetch = $(BIN)/uv pip install -q --no-config --python $(BIN)/python --compile-bytecode --require-hashes $(1) \
	|| $(PIP) --require-hashes $(1)
PIP = $(BIN)/python -m pip install -q --disable-pip-version-check

install: $(INSTALLED) $(KERNEL)

$(INSTALLED): $(LOCK) requirements-uv.lock requirements-node.lock pyproject.toml
	@$(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(0 if (3, 11) <= v < (3, 13) else f"Microcosmos needs Python 3.11 or 3.12, got {v[0]}.{v[1]}: make PYTHON=python3.12")'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "Installing from $(LOCK) into $(VENV) ..."
	@$(PIP) --require-hashes -r requirements-uv.lock
	@$(call fetch,-r $(LOCK))
	@command -v npm >/dev/null || { $(call fetch,-r requirements-node.lock); }
	@$(PIP) --no-build-isolation --no-deps -e .
	@touch $@

$(KERNEL): $(KERNEL_SOURCES) requirements-zig.lock $(INSTALLED)
	@echo "Building the native kernel ..."
	@# It touches the file only once the kernel is installed: else the next call tries again.
	@$(BIN)/python engine/kernels/install.py $@

web: web/dist/index.html

web/dist/index.html: $(WEB_SOURCES) | install
	@echo "Building the page ..."
	@$(NPM) ci --silent
	@$(NPM) run --silent build

# Style, types and import rules of Python and of the page, at the same time.
STYLE = $(MAKE) --no-print-directory -j2 -Otarget style-python style-page

style-python: install
	@$(BIN)/ruff format --check . && $(BIN)/ruff check . && $(BIN)/lint-imports
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pyright

style-page: install web
	@$(BIN)/python web/scripts/openapi.py | diff - web/openapi.json
	@$(BIN)/python web/scripts/figures.py | diff - web/src/api/figures.json
	@$(NPM) run --silent generated && $(NPM) run --silent check && $(NPM) test --silent

check: install web
	@$(STYLE)
	$(BIN)/pytest -m fast tests/engine

# `make test` is everything essential; `make test-all` is everything (see tests/README.md), with the
# libraries that examples and benchmarks need. Both have the same parts, each in one session, since
# long tests share products, finished runs and compiled programs with the others. Tests about bits
# compile as the product does; the others compile without optimising, see tests/engine/conftest.py.
# Tests of the server fork, and a process with JAX must not. Those of whole products, with real
# processes and a browser, run apart and all at the lowest priority: a worker's job lowers its own,
# and would starve beside the tests and browsers that wait for it.
test test-all: install web
	@rm -f $(TIMES)
	$(call part,style,$(STYLE))
	$(call part,engine,$(ENGINE) -m "not optimised$(AND)" tests/engine tests/examples)
	$(call part,bits,$(BITS) -m "optimised$(AND)")
	$(call part,server,$(SERVER) -m "not optimised$(AND)")
	$(call part,products,$(PRODUCTS) -m "not optimised$(AND)")
	$(TELL_TIMES)

test: AND = $() and not long
test-all: peers lab

# A worker keeps the tests of a file together: they share what the file has compiled.
ENGINE = $(BIN)/pytest -q -p no:schemathesis -n auto --maxprocesses 4 --dist worksteal
BITS = MICROCOSMOS_TEST_OPTIMISED=1 $(ENGINE) tests/engine
PRODUCT_TESTS = tests/faults tests/e2e
SERVER = $(BIN)/pytest -q -n 3 $(addprefix --ignore=,tests/engine tests/examples $(PRODUCT_TESTS)) tests
PRODUCTS = nice -n 19 $(BIN)/pytest -q -n 3 $(PRODUCT_TESTS)
TIMES := $(VENV)/times
# A named part of the tests; its time is printed at the end. Parts that fail stop no other, and
# are named there. Status 5 means that no test matched.
define part
	@begun=$$(date +%s); failed=; { $(2); } || [ $$? = 5 ] || failed=", FAILED"; \
	echo "$(1): $$(( $$(date +%s) - begun )) s$$failed" >> $(TIMES)
endef
TELL_TIMES = @cat $(TIMES); ! grep -q FAILED $(TIMES)

# Break the code on purpose and see whether the tests notice: all, or make mutants NAMES=auth
mutants: install web
	$(BIN)/python tests/mutants/run.py $(NAMES)

# Libraries with which the benchmarks compare, and JupyterLab, in which a test opens a notebook.
peers: $(VENV)/installed-requirements-peers.lock
lab: $(VENV)/installed-requirements-lab.lock

$(VENV)/installed-requirements-peers.lock $(VENV)/installed-requirements-lab.lock: \
$(VENV)/installed-%: % $(INSTALLED)
	@echo "Installing from $< ..."
	@# The lock has all dependencies, one of which overrides what a library asks for.
	@$(call fetch,--no-deps -r $<)
	@touch $@

bench: peers web
	$(BIN)/python engine/benchmarks/physics.py
	$(BIN)/python engine/benchmarks/accelerator.py
	$(BIN)/python engine/benchmarks/kernel.py
	$(BIN)/python engine/benchmarks/budget.py
	$(BIN)/python engine/benchmarks/crowd.py
	$(BIN)/python engine/benchmarks/gradients.py
	$(BIN)/python engine/benchmarks/cma_mega.py
	$(BIN)/python engine/benchmarks/archive.py
	$(BIN)/python engine/benchmarks/classic.py
	$(BIN)/python engine/benchmarks/fronts.py
	$(BIN)/python engine/benchmarks/aurora.py
	$(BIN)/python engine/benchmarks/networks.py
	$(BIN)/python engine/benchmarks/xor.py
	$(BIN)/python engine/benchmarks/generation.py
	$(BIN)/python engine/benchmarks/sinks.py
	$(BIN)/python engine/benchmarks/cluster.py --seconds 0.1 1
	$(BIN)/python server/benchmarks/load.py
	$(BIN)/python web/benchmarks/start.py
	$(BIN)/python web/benchmarks/page.py
	$(BIN)/python web/benchmarks/simulate.py

# All parts, or some: make acceptance PARTS=databases
acceptance: install web
	PYTHONPATH=tests/support $(BIN)/python tests/faults/acceptance.py $(PARTS)

# Random worlds, bodies and crowds under sanitisers, also SANITISERS=thread:
# make fuzz WORLDS=300, or SANITISED="g++ -mavx2"
WORLDS ?= 100000
SANITISED ?= g++
SANITISERS ?= address,undefined,float-cast-overflow
CHECKS = -std=c++17 -O1 -g1 -pthread -ffp-contract=off -Wno-psabi \
	-fsanitize=$(SANITISERS) -fno-sanitize-recover=all
fuzz:
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && \
	for kind in worlds slots; do \
		$(SANITISED) $(CHECKS) engine/kernels/check/$$kind.cpp -o $$folder/$$kind && \
		$$folder/$$kind $(WORLDS) || exit 1; \
	done

# Take a picture of every page into docs/pictures/page; DATA names a folder with finished runs.
pictures: install web
	DATA=$(DATA) PYTHONPATH=tests/faults $(BIN)/python tests/e2e/pictures.py

validate: install
	$(BIN)/python -m validation

# All texts of the page, the commands and the server, for review: make texts > texts.md
texts: install
	@$(BIN)/python tests/texts.py

# Build the documentation site; the server shows it at /help.
docs: install
	@$(call fetch,-r requirements-docs.lock)
	$(BIN)/sphinx-build -q -W --keep-going -d .cache/doctrees docs docs/_build

# Wheels of the native kernel for x86-64 and ARM, so that its users need no compiler.
wheels: $(INSTALLED)
	@rm -f dist/microcosmos_kernels-*
	@$(BIN)/python engine/kernels/wheels.py dist

# The native kernel for the page, which the repository keeps: run it after a change to its sources.
simulator: $(INSTALLED)
	@$(BIN)/python engine/kernels/wasm.py web/src/simulate/kernel.wasm

# Install the wheel into an empty environment, with the newest versions of its dependencies.
release-check: install web
	rm -f dist/microcosmos-* && $(BIN)/python -m pip wheel -q --disable-pip-version-check --no-build-isolation --no-deps -w dist .
	folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && $(PYTHON) -m venv $$folder/venv \
	&& $$folder/venv/bin/pip install -q --disable-pip-version-check dist/microcosmos-*.whl && cd $$folder \
	&& venv/bin/python -c 'import microcosmos as mc; mc.evolve; print(mc.__version__, mc.__file__)' \
	&& JAX_PLATFORMS=cpu venv/bin/microcosmos evolve demo --out demo.h5 \
	&& JAX_PLATFORMS=cpu venv/bin/microcosmos replay demo.best.json --check

# What a run's curves and files can go to; the tests need all of them.
SINKS := --extra exports --extra tensorboard --extra mlflow --extra wandb

lock: install
	$(eval COMPILE := $(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-header --no-annotate)
	$(COMPILE) pyproject.toml --group dev --group server --group build --extra figures --extra studies --extra notebook --extra shapes --extra cluster $(SINKS) -o requirements.lock
	$(COMPILE) pyproject.toml --group dev --group server --group build --extra figures --extra studies --extra notebook --extra shapes --extra cluster $(SINKS) --extra cuda -c requirements.lock -o requirements-cuda.lock
	$(COMPILE) --group pyproject.toml:server -c requirements.lock -o requirements-server.lock
	$(COMPILE) --group pyproject.toml:lab -c requirements.lock -o requirements-lab.lock
	$(COMPILE) --group pyproject.toml:docs -c requirements.lock -o requirements-docs.lock
	$(COMPILE) --group pyproject.toml:peers -c requirements.lock -o requirements-peers.lock
	$(COMPILE) --group pyproject.toml:uv -o requirements-uv.lock
	$(COMPILE) --group pyproject.toml:node -o requirements-node.lock
	$(COMPILE) --group pyproject.toml:zig -o requirements-zig.lock
	$(COMPILE) --group pyproject.toml:xla --no-deps -o requirements-xla.lock
