# SPDX-License-Identifier: LGPL-3.0-or-later
#
# `make verify` and `make test` install what they need. DOLFINX says where FEniCSx comes from: conda (the
# active environment, see environment.yml), pip (Python 3.12 or later, no root) or debian (packages of
# Debian 12 and 13, root). Unless given, it is the first of these that this machine has.

SHELL_CASES := paper paper-friction three-segments spatial
VERIFY_CASES := $(SHELL_CASES) drawn-out crane-telescopes hoist slew

ROOMS := $(patsubst %/__init__.py,%,$(wildcard */__init__.py))
SOURCES := pyproject.toml $(wildcard runs/*/templates/*) \
    $(shell find $(ROOMS) -path runs/out -prune -o -name '*.py' -print)
REPORTS := $(VERIFY_CASES:%=runs/out/%/report.html)
VARY_hoist := hoist.speed=0.2,0.3,0.4,0.5,0.6
VARY_slew := slew.speed=2,4,6,8,10
SWEEPS := $(patsubst %,runs/out/%-sweep/sweep.csv,hoist slew)
CHARTS := runs/out/chart-crane-chart/chart.html

# Instructions that `make imitate` hides from numpy.
AVX512 := AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR
NEWER := $(AVX512) AVX2 FMA3

# One thread each: parallelism is MPI ranks, `make -j` and test workers. Open MPI 4 and 5 refuse root and
# more ranks than cores else.
export OMP_NUM_THREADS ?= 1
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_rmaps_base_oversubscribe := 1
export PRTE_MCA_rmaps_default_mapping_policy := :oversubscribe
# Runs and tests start many processes, each of which would compile all modules without bytecode.
export PYTHONDONTWRITEBYTECODE :=

PYTHON ?= python3
RELEASE := $(shell . /etc/os-release && echo $$ID-$$VERSION_ID)
FIND_DOLFINX := import importlib.util, sys; sys.exit(importlib.util.find_spec("dolfinx") is None)
HAS_CONDA := $(if $(CONDA_PREFIX),$(shell $(CONDA_PREFIX)/bin/python -c '$(FIND_DOLFINX)' && echo yes))
HAS_PIP := $(shell $(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 12))' 2>/dev/null && echo yes)
DOLFINX ?= $(if $(HAS_CONDA),conda,$(if $(HAS_PIP),pip,debian))
ifeq ($(DOLFINX),conda)
BIN := $(CONDA_PREFIX)/bin
READY := $(BIN)/protractile
SPHINX := $(READY)
else
BIN := .venv/bin
READY := .venv/ready-$(DOLFINX)
SPHINX := .venv/sphinx-$(DOLFINX)
endif
# Pip makes environments, FFCx compiles the forms of shells, and gmsh's wheel loads these libraries,
# unless it is one without X.
GMSH_NEEDS = $(shell $(BIN)/python -c 'import gmsh' 2>/dev/null || \
    echo libgomp.so.1 libGL.so.1 libGLU.so.1 libXft.so.2 libXcursor.so.1 libXinerama.so.1)
FIND_TOOLS = import ctypes, ensurepip, os, shutil, sys, venv; from sysconfig import get_config_var, get_path; \
    [*map(ctypes.CDLL, "$(GMSH_NEEDS)".split())]; \
    compiler = (os.environ.get("CC") or get_config_var("CC")).split()[0]; \
    sys.exit(not (shutil.which(compiler) and os.path.exists(get_path("include") + "/Python.h")))
VENV_debian := /usr/bin/python3 -m venv --system-site-packages
VENV_pip := $(PYTHON) -m venv
NEEDS_debian := .[report,test,mesh]
NEEDS_pip := .[shell,report,test]
CONSTRAINTS_debian := .ci/constraints-$(RELEASE).txt
CONSTRAINTS_pip := .ci/constraints-pip.txt

.PHONY: help install verify report snapshots gallery bench convergence validation validity other-codes test imitate fuzz torture quick lint docs matrix clean distclean packages-debian packages-pip
.DELETE_ON_ERROR:

help: ## list these targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12
	@echo "FEniCSx comes from: $(DOLFINX); make TARGET DOLFINX=conda|pip|debian takes another (see README.md)"

install: $(READY) ## install what runs need, into .venv or the active conda environment

# As many cases at a time as there are cores, of which nproc tells no more than OMP_NUM_THREADS.
verify: $(READY) ## run the cases where they are not up to date, print verdicts and where the reports are
	@$(MAKE) --no-print-directory --jobs=$$(OMP_NUM_THREADS= nproc) $(REPORTS)
	@$(BIN)/protractile report --brief $(VERIFY_CASES:%=runs/out/%)

report: $(REPORTS) ## render the reports of the verify cases again, and print all their tables
	@$(BIN)/protractile report $(VERIFY_CASES:%=runs/out/%)

snapshots: $(REPORTS) ## pictures of the verify cases with a shell
	@set -e; for case in $(SHELL_CASES); do $(BIN)/protractile snapshot runs/out/$$case; done

gallery: $(REPORTS) $(SWEEPS) $(CHARTS) ## the pictures of docs/gallery.md, from the verify cases
	@set -e; for case in paper spatial; do $(BIN)/protractile snapshot runs/out/$$case; done
	$(BIN)/protractile report --figures runs/out/paper > /dev/null
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

# Each rounds differently: compiled loops, numpy and BLAS choose other instructions.
imitate: ## `make test` as on three other processors
	NUMBA_CPU_NAME=generic OPENBLAS_CORETYPE=Prescott NPY_DISABLE_CPU_FEATURES="$(NEWER)" $(MAKE) test
	NUMBA_CPU_NAME=haswell OPENBLAS_CORETYPE=Haswell NPY_DISABLE_CPU_FEATURES="$(AVX512)" $(MAKE) test
	NUMBA_CPU_NAME=znver2 OPENBLAS_CORETYPE=Zen NPY_DISABLE_CPU_FEATURES="$(AVX512)" $(MAKE) test

fuzz: $(READY) ## a thousand valid and wrong cases, load files, command lines and Python calls
	$(BIN)/python -m tests.fuzz

torture: $(READY) ## full disks, kills, shared folders: losses, as a table
	NUMBA_NUM_THREADS=1 $(BIN)/python -m tests.torture

quick: $(READY) ## the quick tests alone
	NUMBA_NUM_THREADS=1 $(BIN)/python -m pytest -m 'not slow' -n 2 --dist loadfile

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

# How fast a crane may hoist and slew.
runs/out/%-sweep/sweep.csv: runs/cases/%.toml $(SOURCES) | $(READY)
	@$(BIN)/protractile sweep $< --out $(@D) --models timoshenko --vary $(VARY_$*)

runs/out/%-chart/chart.html: runs/cases/%.toml $(SOURCES) | $(READY)
	@$(BIN)/protractile chart $< --out $(@D)

# An environment with FEniCSx from elsewhere is made anew, so that it never has two.
.venv/ready-debian .venv/ready-pip: .venv/ready-%: pyproject.toml $(CONSTRAINTS_$(DOLFINX)) | packages-%
	@[ -f $@ ] || rm -rf .venv
	@echo "installing Python packages into .venv (a minute or two) ..."
	@[ -d .venv ] || $(VENV_$*) .venv
	@PIP_CONSTRAINT=$(CONSTRAINTS_$*) $(BIN)/python -m pip install --quiet --editable '$(NEEDS_$*)'
	@touch $@

.venv/sphinx-debian .venv/sphinx-pip: .venv/sphinx-%: $(READY)
	@PIP_CONSTRAINT=$(CONSTRAINTS_$*) $(BIN)/python -m pip install --quiet --editable '.[docs]'
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

packages-debian:
	@.ci/debian-packages

packages-pip:
	@$(PYTHON) -c '$(FIND_TOOLS)' 2>/dev/null || { echo "no venv, C compiler, headers of $(PYTHON) or libraries \
	of gmsh; install them (apt install gcc python3-dev python3-venv libgl1 libglu1-mesa libxft2 libxcursor1 \
	libxinerama1, or dnf install gcc python3-devel libglvnd-glx mesa-libGLU libXft libXcursor libXinerama); \
	without root, a gmsh without X: make install GMSH_NEEDS= && $(BIN)/pip install --force-reinstall \
	-i https://gmsh.info/python-packages-dev-nox gmsh" >&2; exit 1; }

.ci/constraints-%.txt:
	@echo "$*: neither Debian 12 nor 13; give a Python of 3.12 or later by PYTHON=python3.13" >&2; exit 1
