# Every target makes the environment it needs; nothing is installed by hand.
PYTHON ?= python3.11
CORES ?= $(shell nproc)
VENV := .venv
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
# One thread per job: the same sums in the same order, whatever the machine.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1

SNAKEMAKE := snakemake --profile workflow/profiles/default --cores $(CORES)

.DEFAULT_GOAL := help
.PHONY: help study case report discrepancy trials records faults check test benchmark clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 16

$(VENV)/installed: environment.txt pyproject.toml requirements.in
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --requirement environment.txt
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

env: $(VENV)/installed ## create the pinned environment in .venv

study: $(VENV)/installed ## regenerate every figure and table
	$(SNAKEMAKE) study

case: $(VENV)/installed ## identify and follow a record made elsewhere: make case NAME=mine
	$(SNAKEMAKE) case_$(NAME)

report: study ## write results/report.html with captions
	$(SNAKEMAKE) study --report results/report.html

discrepancy: $(VENV)/installed ## name what the simulation of each actuator is missing
	$(SNAKEMAKE) discrepancy

trials: $(VENV)/installed ## blind trials: hide an effect, name it, open the seal, score
	$(SNAKEMAKE) trials

records: $(VENV)/installed ## fetch the public measured records into data/ (FROM=folder copies them)
	python -m dea.public_records $(if $(FROM),--from $(FROM))

faults: $(VENV)/installed ## a thousand random faults against the acquisition
	pytest tests/acquisition -m faults --fault-schedules 1000

check: $(VENV)/installed ## linters, formatters and the type checker
	ruff check .
	ruff format --check .
	mypy
	snakefmt --check Snakefile workflow
	snakemake --lint

test: check ## the whole test suite
	pytest

benchmark: $(VENV)/installed ## speed of identification, tracking and simulation against peers
	python -m benchmarks

clean: ## remove every generated result (the environment stays)
	rm -rf results/* .snakemake
	git checkout -- results/README.md
