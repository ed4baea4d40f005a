# Every target makes the environment it needs; nothing is installed by hand.
PYTHON ?= python3.11
# nproc alone would count the threads that OMP_NUM_THREADS allows one program.
override CORES := $(or $(strip $(CORES)),$(shell env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc))
VENV := .venv
VALIDATOR := .venv-validator
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
# One thread per job: the same sums in the same order, whatever the machine.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1

# A value as one word of the shell, whatever is in it.
quoted = '$(subst ','\'',$(subst <begin>,,$(subst <begin>~/,$(HOME)/,<begin>$(1))))'
# An option with the value of a variable, where it is given.
option = $(if $($(2)),--$(1)=$(call quoted,$($(2))))
# Ends make unless the variable is a whole number above 0; programs would hang, or not name it.
counted = $(if $(shell printf %s $(call quoted,$($(1))) | grep -xE '0*[1-9][0-9]*'),,\
	$(error $(1)=$($(1)) is no whole number above 0. Give one, such as $(1)=2))
$(call counted,CORES)
$(and $(PROFILE),$(JOBS),$(call counted,JOBS))
PROFILES := $(filter-out default,$(patsubst workflow/profiles/%/profile.yaml,%,$(wildcard workflow/profiles/*/profile.yaml)))
$(if $(PROFILE),$(if $(filter-out $(PROFILES),$(PROFILE)),\
	$(error PROFILE=$(PROFILE) is none. Name a folder of workflow/profiles, such as PROFILE=slurm)))

# PROFILE=slurm JOBS=100 runs the jobs on a cluster.
PLACE := $(if $(PROFILE),--workflow-profile workflow/profiles/default \
	--profile workflow/profiles/$(PROFILE) --jobs $(or $(JOBS),100),\
	--profile workflow/profiles/default --cores $(CORES))
# What a profile needs beside the environment, which has the packages that it pulls in.
EXECUTOR = $(patsubst %,$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --requirement %, \
	$(wildcard workflow/profiles/$(1)/environment.txt))
SNAKEMAKE := $(and $(PROFILE),$(call EXECUTOR,$(PROFILE)),$(call EXECUTOR,$(PROFILE)) && )\
	PYTHONPATH=workflow workflow/alone.sh snakemake --nolock --logger progress \
	$(PLACE)

comma := ,

# Campaigns keep what they found in docs/measured, for the documents, where STORE=1 asks for it.
KEEP = $(if $(filter-out 0,$(STORE)),--store)

.DEFAULT_GOAL := help
.PHONY: help env study record case cases report report-page handover control control-robustness diagnose discrepancy resolve resolution-trials \
	container calibration real trials records faults peers interoperability soak coverage coverage-film intervals configuration laws thresholds docs audit sign crate slurm \
	killed processor numbers fresh \
	check test slow-tests compiled-tests timed-tests other-tests mutants benchmark benchmark-naming clean FORCE

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 20

# An environment names the folder that it was made in by whole paths: in a copy of the project it runs
# the code of the original. `--clear` where one is to be made again; a link to one was meant.
anew = $(shell line=$$(grep -s '^command = ' $(1)/pyvenv.cfg); case "$$line" in \
	(''|*' '$(call quoted,$(CURDIR)/$(1))) ;; (*) test -L $(1) || echo --clear;; esac)

$(VENV)/installed: environment.txt pyproject.toml requirements.in requirements-workflow.in \
		$(if $(call anew,$(VENV)),FORCE)
	$(PYTHON) -m venv $(call anew,$(VENV)) $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --requirement environment.txt
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

env: $(VENV)/installed ## create the pinned environment in .venv

study: $(VENV)/installed ## regenerate every figure and table
	$(SNAKEMAKE) study
	@echo "Figures are in results/figures, tables in results/tables; make report-page shows them on one page."

results/%: FORCE $(VENV)/installed # one result: make results/dea1/model.nc
	@python -m dea.stages.intake --result=$(call quoted,$@)
	$(SNAKEMAKE) $(call quoted,$@)

record: $(VENV)/installed ## drive a device and keep its record: make record NAME=film1 OPERATOR=A.Volta (EXCITATION=second, probed)
	$(if $(NAME),,$(error Name an actuator of config/config.yaml without bench: make record NAME=film1))
	python -m dea.stages.record $(call option,excitation,EXCITATION) $(call option,operator,OPERATOR) -- $(call quoted,$(NAME))

# What the file of a record does not say of its columns: INPUT=volts:V OUTPUT=position:mm RATE=50;
# several inputs: INPUT=left:V,right:V; of a workbook: SHEET=Data.
INTAKE = python -m dea.stages.intake $(1) $(call option,input,INPUT) $(call option,output,OUTPUT) \
	$(call option,time,TIME) $(call option,rate,RATE) $(call option,sheet,SHEET) $(call option,name,NAME) \
	$(call option,simulation,SIMULATION) $(if $(FILE),-- $(call quoted,$(FILE)))

case: $(VENV)/installed ## identify and follow a record made elsewhere: make case FILE=mine.csv (INPUT=volts:V OUTPUT=position:mm TIME=t:s RATE=50 SHEET=Data NAME=mine)
	$(if $(FILE)$(NAME),,$(error Name a file, or a case of config/cases: make case FILE=mine.csv))
	@name=$$($(INTAKE)) && $(SNAKEMAKE) case_$$name && \
		cat results/$$name/summary.txt

cases: $(VENV)/installed ## every case of config/cases, and their errors on unseen records in one table
	$(SNAKEMAKE) cases

handover: $(VENV)/installed ## a model as C code and FMU in results/NAME/handover: make handover NAME=dea1
	$(if $(NAME),,$(error Name an actuator or a file of config/cases: make handover NAME=dea1))
	@python -m dea.stages.intake $(call option,name,NAME) --goal handover > /dev/null
	$(SNAKEMAKE) results/$(NAME)/handover/model.fmu
	pytest -m campaign tests/control/test_handed_over.py
	@echo "C code, and the same as an FMU, are in results/$(NAME)/handover."
	@sed -n 's/^ [*] \(Stability .*\)/\1/p' results/$(NAME)/handover/model.h

control: $(VENV)/installed ## after discrepancy (tens of minutes), controllers follow a reference on every virtual actuator
	$(SNAKEMAKE) control_all
	pytest -m campaign tests/control/test_control_trials.py

control-robustness: $(VENV)/installed ## the controller on drawn actuators under disturbances (COUNT=100 SEED=1)
	$(SNAKEMAKE) control_models
	python -m benchmarks.control_robustness $(COUNT:%=--count %) $(SEED:%=--seed %) $(KEEP)

report: $(VENV)/installed ## results/report.html: the findings, after all of study and discrepancy (tens of minutes)
	$(SNAKEMAKE) study discrepancy
	python -m dea.report

report-page: $(VENV)/installed ## results/report.html of the results that there are after make study, within seconds
	python -m dea.report

diagnose: $(VENV)/installed ## what a simulation is missing: make diagnose FILE=mine.csv SIMULATION=mine.py
	$(if $(FILE)$(NAME),,$(error Name a file, a case of config/cases, or an actuator: make diagnose NAME=dea1))
	$(if $(FILE),$(if $(SIMULATION),,$(error Name its simulation: make diagnose FILE=mine.csv SIMULATION=mine.py)))
	@name=$$($(call INTAKE,--goal diagnose)) && \
		$(SNAKEMAKE) $(if $(FILE),case_$$name,results/figures/discrepancy/$(NAME).png \
		$(wildcard results/$(NAME)/page.html)) && \
		$(if $(FILE),cat results/$$name/summary.txt,python -c "import json; \
		print(json.load(open('results/discrepancy/$(NAME)/verdict.json'))['sentence'])")

resolve: $(VENV)/installed ## designed records until one explanation is left: make resolve NAME=dea1 OPERATOR=A.Volta
	$(if $(NAME),,$(error Name an actuator or a file of config/cases: make resolve NAME=dea1))
	@for name in $(foreach name,$(NAME),$(call quoted,$(name))); do \
		python -m dea.stages.intake --name="$$name" --goal resolve > /dev/null || exit; done
	$(SNAKEMAKE) $(NAME:%=resolvable_%)
	workflow/alone.sh python -m dea.stages.resolve $(NAME) --threads $(CORES) \
		$(call option,operator,OPERATOR)

resolution-trials: $(VENV)/installed ## how often designed records decide (defaults COUNT=20 SET=ambiguous, all FORMS)
	python -m benchmarks.resolution --cores $(CORES) $(COUNT:%=--count %) $(SET:%=--set %) \
		$(if $(FORMS),--forms $(FORMS)) $(KEEP)

discrepancy: $(VENV)/installed ## name what the simulation of each actuator is missing
	$(SNAKEMAKE) discrepancy

real: $(VENV)/installed ## name what the simulation of each measured record is missing, in one table
	$(SNAKEMAKE) real_records
	pytest -m campaign tests/discrepancy/test_discrepancy_real_records.py tests/workflow/test_cases.py

trials: $(VENV)/installed ## blind trials: hide, name, unseal, score (defaults COUNT=300 FIRST=0 SET=reporting)
	$(SNAKEMAKE) trials --config \
		'trials={$(FIRST:%=first: %$(comma) )$(COUNT:%=count: %$(comma) )$(SET:%=set: %)}'

records: $(VENV)/installed ## fetch the public measured records into data/ (FROM=folder copies them)
	python -m dea.public_records $(call option,from,FROM)

container: ## an Apptainer image of the pinned environment, for clusters (needs apptainer)
	apptainer build --force workflow/container.sif workflow/container.def

faults: $(VENV)/installed ## a thousand schedules of faults, twice, and 100,000 malformed frames (COUNT=1000 SEED=1 LONGEST=6)
	pytest tests/acquisition tests/bench -m faults --fault-schedules 1000 --fuzz-frames 100000
	python -m benchmarks.faults --count $(or $(COUNT),1000) $(SEED:%=--seed %) \
		$(LONGEST:%=--longest %) --keep build/faults $(KEEP)

intervals: $(VENV)/installed ## how often the 95 % interval of a named effect holds the truth (COUNT=50 SEED=1)
	python -m benchmarks.intervals --cores $(CORES) $(COUNT:%=--count %) $(SEED:%=--seed %) $(KEEP)

coverage: $(VENV)/installed ## how often the 95 % bands hold the truth of known plants (COUNT=100 SEED=1 SAMPLES=4000; DRIFTING=1 for those that drift)
	python -m benchmarks.coverage --cores $(CORES) $(COUNT:%=--count %) $(SEED:%=--seed %) \
		$(SAMPLES:%=--samples %) $(if $(filter-out 0,$(DRIFTING)),--drifting) $(KEEP)

coverage-film: $(VENV)/installed ## how often the bands hold the responses of the virtual actuators (COUNT=17 of each, SEED=1)
	python -m benchmarks.coverage.film --cores $(CORES) $(COUNT:%=--count %) $(SEED:%=--seed %) $(KEEP)

peers: ## install the foreign Modbus programs that tests talk to (Debian, as root)
	command -v mbpoll && test -e /usr/include/modbus/modbus.h || \
	{ apt-get update --quiet && apt-get install --yes --quiet gcc libc6-dev libmodbus-dev mbpoll; }

interoperability: peers $(VENV)/installed ## client and bench against libmodbus, mbpoll, pyModbusTCP
	pytest tests/acquisition/test_interoperability.py

soak: $(VENV)/installed ## ten minutes at wall time, idle and beside a busy core
	python -m benchmarks.acquisition --soak $(KEEP)

.venv-docs/installed: docs/site/environment.txt requirements.in environment.txt \
		$(if $(call anew,.venv-docs),FORCE)
	$(PYTHON) -m venv $(call anew,.venv-docs) .venv-docs
	.venv-docs/bin/python -m pip install --quiet --disable-pip-version-check \
		--requirement $< --requirement requirements.in --constraint environment.txt
	touch $@

docs: .venv-docs/installed ## the documentation as a site, in build/site (installs 1 GB in .venv-docs)
	NO_MKDOCS_2_WARNING=1 PYTHONPATH=$(call quoted,$(CURDIR)/src) .venv-docs/bin/mkdocs build --quiet
	@echo build/site/index.html

configuration: $(VENV)/installed ## write docs/configuration.md from the models of the config
	python -m dea.configuration page > docs/configuration.md

laws: $(VENV)/installed ## write docs/laws.md, priors, bounds and starts of every law, from the catalogue
	python -m dea.simulation > docs/laws.md

thresholds: $(VENV)/installed ## write docs/method/thresholds.md, rules and budget of a diagnosis
	python -m dea.discrepancy > docs/method/thresholds.md

audit: $(VENV)/installed ## compare the results with what their jobs made (SAMPLE=5 makes that many again)
	python -m dea.audit $(call option,sample,SAMPLE) $(call option,seed,SEED) $(call option,signers,SIGNERS)

sign: ## sign the manifest of the results: make sign KEY=~/.ssh/id_ed25519
	$(if $(KEY),,$(error Name a private key: make sign KEY=~/.ssh/id_ed25519))
	@test -f results/MANIFEST.json || { \
		echo "error: results/MANIFEST.json: there is none. Make results first: make study" >&2; exit 2; }
	@ssh-keygen -Y sign -f $(call quoted,$(KEY)) -n dea-study < results/MANIFEST.json \
		> results/MANIFEST.json.sig.partial || { rm -f results/MANIFEST.json.sig.partial; \
		printf 'error: KEY: %s does not sign. Name a private key: make sign KEY=~/.ssh/id_ed25519\n' \
			$(call quoted,$(KEY)) >&2; exit 2; }
	@mv results/MANIFEST.json.sig.partial results/MANIFEST.json.sig
	@echo results/MANIFEST.json.sig

$(VALIDATOR)/installed: workflow/validator.txt
	$(PYTHON) -m venv $(VALIDATOR)
	$(VALIDATOR)/bin/python -m pip install --quiet --disable-pip-version-check --requirement $<
	touch $@

crate: $(VENV)/installed $(VALIDATOR)/installed ## build/crate: the results and what made each, as RO-Crate
	$(SNAKEMAKE) study
	rm -rf build/crate
	PYTHONPATH=workflow/plugins snakemake --profile workflow/profiles/default --cores 1 \
		--reporter crate --report-crate-folder build/crate study
	$(VALIDATOR)/bin/python workflow/validate_crate.py build/crate

slurm: $(VENV)/installed ## a small study on a Slurm of one node (Debian, as root), and 600 actuators planned
	tests/workflow/slurm_here.sh
	$(call EXECUTOR,slurm)
	pytest -m campaign tests/workflow/test_workflow_cluster.py

killed: $(VENV)/installed ## kill runs of a small study at random moments, fill its disk, go on
	pytest -m campaign tests/workflow/test_workflow_killed.py

processor: $(VENV)/installed ## compare the jobs of an actuator with those on the oldest processor
	pytest -m campaign tests/workflow/test_workflow_processor.py

numbers: $(VENV)/installed ## write the numbers that the documents quote, from results and campaigns
	python -m dea.audit.numbers

fresh: $(VENV)/installed ## time and space that a clone, its environment and its first study take
	python -m benchmarks.fresh_clone --cores $(CORES) $(KEEP)

check: $(VENV)/installed ## linters, formatters, the type checker, import contracts, quoted numbers
	ruff check .
	ruff format --check .
	mypy
	lint-imports --no-cache --no-logo
	python -m dea.audit.numbers --check
	snakefmt --check Snakefile workflow
	snakemake --lint

# All processes share what one has compiled, beside the linters, which leave cores idle.
test slow-tests: export PYTHONDONTWRITEBYTECODE :=
test: $(VENV)/installed ## linters and every test but the slow ones
	$(MAKE) --no-print-directory --jobs $(CORES) --output-sync check compiled-tests
	$(MAKE) --no-print-directory --keep-going --jobs $(CORES) timed-tests other-tests; \
		status=$$?; cat build/timed_tests.txt; exit $$status

slow-tests: $(VENV)/installed ## tests of whole studies and diagnoses, and others of more than two seconds; campaigns have targets of their own
	pytest --numprocesses $(CORES) $(BY_FILE) -m 'slow and not campaign'

# They wait for clocks more than they compute: two files at a time, beside all others, which leave
# them the processor when they want it. A host that pauses a virtual machine for a tenth of a second
# makes a sample late or lost, so that a failed one is run again; the summary names it.
TIMED := tests/benchmarks/test_fault_campaign.py tests/acquisition tests/bench \
	tests/test_example_controller.py
BY_FILE := --dist loadfile --no-loadscope-reorder
QUICK := -m 'not slow and not campaign'

timed-tests: $(VENV)/installed
	@mkdir -p build
	pytest --quiet --numprocesses $(if $(filter 1,$(CORES)),1,2) $(BY_FILE) $(QUICK) --reruns 2 -raR $(TIMED) \
		> build/timed_tests.txt

other-tests: $(VENV)/installed
	nice pytest --numprocesses $(CORES) $(BY_FILE) $(QUICK) $(TIMED:%=--ignore %)

compiled-tests: $(VENV)/installed
	@mkdir -p build
	pytest --collect-only -qq > build/tests.txt || { cat build/tests.txt; exit 1; }

mutants: $(VENV)/installed ## change the code and see what tests notice (COUNT=300 SEED=1 ROOM=narx BUDGET=60)
	python -m benchmarks.mutants --cores $(CORES) $(COUNT:%=--count %) $(SEED:%=--seed %) \
		$(ROOM:%=--room %) $(BUDGET:%=--budget %) $(KEEP)

calibration: $(VENV)/installed ## the virtual actuators beside the measured ones, in a table and a figure
	python -m benchmarks.calibration $(KEEP)

benchmark-naming: $(VENV)/installed ## our names beside SINDy's, AIC's, chance's (defaults COUNT=40 SET=reporting LONGEST=6000 and all RECORDS; RECORDS= for none)
	python -m benchmarks.naming --cores $(CORES) $(COUNT:%=--count %) $(SET:%=--set %) \
		$(SEED:%=--seed %) $(LONGEST:%=--longest %) \
		$(if $(filter undefined,$(origin RECORDS)),,--records $(RECORDS)) $(KEEP)

benchmark: $(VENV)/installed ## speed of identification, tracking and simulation against peers
	python -m benchmarks $(KEEP)

clean: ## remove every generated result (the environment stays)
	workflow/alone.sh --no-manifest sh -c \
		'find results/ -mindepth 1 ! -path results/README.md -delete && rm -rf .snakemake'
