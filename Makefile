# SPDX-License-Identifier: LGPL-3.0-or-later
#
# `make verify` and `make test` bring up what they need on Debian 12 and 13: Debian packages, and
# pinned Python packages in .venv. If a conda environment is active whose Python has DOLFINx (see
# environment.yml), that one is used and nothing but protractile itself is installed in it.

SHELL_CASES := paper paper-friction three-segments spatial
VERIFY_CASES := $(SHELL_CASES) drawn-out crane-telescopes hoist slew

ROOMS := $(patsubst %/__init__.py,%,$(wildcard */__init__.py))
SOURCES := pyproject.toml $(wildcard runs/report/templates/*) \
    $(shell find $(ROOMS) -path runs/out -prune -o -name '*.py' -print)
REPORTS := $(VERIFY_CASES:%=runs/out/%/report.html)
VARY_drawn-out := joint.drive.time=0.5,0.7,1,1.2,1.4,1.7,2,3,5
VARY_hoist := hoist.speed=0.2,0.3,0.4,0.5,0.6
VARY_slew := slew.speed=2,4,6,8,10
SWEEPS := $(patsubst %,runs/out/%-sweep/sweep.csv,drawn-out hoist slew)

# One thread each: parallelism is MPI ranks, `make -j` and test workers. Open MPI refuses root else.
export OMP_NUM_THREADS ?= 1
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
# Runs and tests start many processes, each of which would compile all modules without bytecode.
export PYTHONDONTWRITEBYTECODE :=

RELEASE := $(shell . /etc/os-release && echo $$ID-$$VERSION_ID)
FIND_DOLFINX := import importlib.util, sys; sys.exit(importlib.util.find_spec("dolfinx") is None)
CONDA := $(if $(CONDA_PREFIX),$(shell $(CONDA_PREFIX)/bin/python -c '$(FIND_DOLFINX)' && echo yes))
ifeq ($(CONDA),yes)
BIN := $(CONDA_PREFIX)/bin
READY := $(BIN)/protractile
SPHINX := $(READY)
else
BIN := .venv/bin
READY := .venv/ready-$(RELEASE)
SPHINX := .venv/sphinx-$(RELEASE)
endif

.PHONY: help install verify snapshots gallery bench convergence validation validity other-codes test fuzz torture quick lint docs matrix clean distclean debian-packages
.DELETE_ON_ERROR:

help: ## list these targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12

install: $(READY) ## install what runs need, into .venv or the active conda environment

# As many cases at a time as there are cores, of which nproc tells no more than OMP_NUM_THREADS.
verify: $(READY) ## run the cases where they are not up to date, print the verdicts
	@$(MAKE) --no-print-directory --jobs=$$(OMP_NUM_THREADS= nproc) $(REPORTS)
	@$(BIN)/protractile report $(VERIFY_CASES:%=runs/out/%)

snapshots: $(REPORTS) ## pictures of the verify cases with a shell
	@set -e; for case in $(SHELL_CASES); do $(BIN)/protractile snapshot runs/out/$$case; done

gallery: $(REPORTS) $(SWEEPS) ## the pictures of docs/gallery.md, from the verify cases
	$(BIN)/python -m studies.gallery

bench: $(READY) ## what integrators, reductions and other programs cost, into runs/out/bench
	$(BIN)/python -m studies.cost.bench

convergence: $(READY) ## verification: benchmarks, refinements, other codes; into runs/out/convergence
	$(BIN)/python -m studies.convergence

validation: $(READY) ## measurements and other programs beside this one; part of `make convergence`
	$(BIN)/python -m studies.convergence validation

validity: $(READY) ## where a beam may stand for the shell, over friction, play and load, into runs/out/validity
	$(BIN)/protractile sweep runs/cases/beam-or-shell.toml --against shell --large \
	    --vary joint.friction=0,0.2 --vary joint.play=0:0.02:5 --vary gravity.acceleration=1,2,5,10 \
	    --out runs/out/validity

other-codes: build/other-codes/ready ## OpenSees, sectionproperties and Exudyn, beside which tests hold results

test: $(READY) ## all tests
	NUMBA_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

fuzz: $(READY) ## a thousand errors in cases, load files and command lines; each must give one line
	$(BIN)/python -m tests.fuzz

torture: $(READY) ## full disks, kills, flipped bits, shared folders: losses, as a table
	NUMBA_NUM_THREADS=1 $(BIN)/python -m tests.torture

quick: $(READY) ## the quick tests alone
	$(BIN)/python -m pytest -m 'not slow'

lint: $(READY) ## ruff and mypy
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	$(BIN)/python -m mypy

docs: $(SPHINX) ## these texts, the formulas and the library's pages as a site, into build/docs
	rm -rf docs/api build/docs
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet --jobs auto docs build/docs

matrix: ## `make verify`, `test` and `docs` on fresh Debian 12 and 13, the quick tests on unstable (needs root)
	@$(MAKE) --no-print-directory --keep-going -j1 matrix-bookworm matrix-trixie matrix-sid

matrix-%:
	@.ci/matrix $*

clean: ## remove outputs, other codes, root file systems and caches
	rm -rf --one-file-system runs/out build docs/api *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find $(ROOMS) studies tests -name __pycache__ -prune -exec rm -rf {} +

distclean: clean ## remove .venv too
	rm -rf .venv

# Exit status 1 with a report is a run whose verdict failed; `report` in `verify` says so, and
# prints the tables.
runs/out/%/report.html: runs/cases/%.toml $(SOURCES) | $(READY)
	@rm -f $@
	@echo "running the models of $< ..."
	@$(BIN)/protractile run $< --out $(@D) >/dev/null || { [ $$? -eq 1 ] && [ -f $@ ]; }

# How fast the boom may be drawn out, hoist and slew.
runs/out/%-sweep/sweep.csv: runs/cases/%.toml $(SOURCES) | $(READY)
	@$(BIN)/protractile sweep $< --out $(@D) --models timoshenko --vary $(VARY_$*)

.venv/ready-$(RELEASE): pyproject.toml .ci/constraints-$(RELEASE).txt | debian-packages
	@echo "installing Python packages into .venv (a minute or two) ..."
	@/usr/bin/python3 -m venv --system-site-packages .venv
	@PIP_CONSTRAINT=.ci/constraints-$(RELEASE).txt $(BIN)/python -m pip install --quiet --editable '.[test]'
	@touch $@

.venv/sphinx-$(RELEASE): $(READY)
	@PIP_CONSTRAINT=.ci/constraints-$(RELEASE).txt $(BIN)/python -m pip install --quiet --editable '.[docs]'
	@touch $@

# In an environment of their own: DOLFINx is built against another numpy than they need.
build/other-codes/ready: .ci/other-codes.txt | $(READY)
	@echo "installing OpenSees, sectionproperties and Exudyn into $(@D) ..."
	@$(BIN)/python -m venv --clear $(@D)
	@$(@D)/bin/python -m pip install --quiet --requirement $<
	@touch $@

$(CONDA_PREFIX)/bin/protractile: pyproject.toml
	$(BIN)/python -m pip install --no-deps --no-build-isolation --editable .
	@touch $@

debian-packages:
	@.ci/debian-packages

.ci/constraints-%.txt:
	@echo "$*: neither Debian 12 nor 13; activate environment.yml's conda environment" >&2; exit 1
