# All that is needed is Python >= 3.11 and make; everything else goes into .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SNAKEMAKE := $(BIN)/snakemake
# One thread of linear algebra per job: jobs run side by side, and results do not depend on --cores.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
# Libraries are compiled when they are first imported (below). Where nothing may be written down,
# each job would do it again, which doubles what it takes to start.
unexport PYTHONDONTWRITEBYTECODE

# What `make` and `make help` say: the words after ##.
.PHONY: help demo test tests test-long test-slurm paper why archive pages results bench slurm docs links check clean

help:
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)
	@echo 'Options follow in ARGS: make paper ARGS="-n". Which Python: make PYTHON=python3.13 demo'

demo: $(VENV)/installed ## networks, learnt equations, control: three minutes
	$(SNAKEMAKE) --configfile workflow/presets/quick.yaml $(ARGS)

paper: $(VENV)/installed ## the paper's whole campaign: hours
	$(SNAKEMAKE) $(ARGS)

# Side by side, since links and linters keep one core busy each.
test: ## linters, types, links of the site, tests
	$(MAKE) --jobs 3 check links tests

# Two processes, each of which takes a file of tests at a time, campaigns first: what they share is
# made once.
tests: $(VENV)/developed
	$(BIN)/pytest -n 2 --dist loadfile --no-loadscope-reorder $(ARGS)

# Property tests, too, with examples that the gate has not seen; a failure comes back with its SEED.
SEED = $(shell date +%s)
test-long: $(VENV)/developed ## tests that take long, and new examples for property tests
	$(BIN)/pytest -m "long or hypothesis" --hypothesis-profile new --hypothesis-seed $(SEED) $(ARGS)

test-slurm: $(VENV)/developed ## tests on a Slurm of their own
	$(BIN)/pytest -m slurm $(ARGS)

# What would run again, and why: make why ARGS="--configfile workflow/presets/quick.yaml"
why: $(VENV)/installed ## what would run again, and why
	@$(SNAKEMAKE) -n $(ARGS)

archive: $(VENV)/installed ## tables, figures, report, config, versions in one zip
	@$(BIN)/burstcast archive $(ARGS)

pages: $(VENV)/installed ## pages and the schema of settings, from the model and the declarations
	$(BIN)/burstcast settings > docs/settings.md
	$(BIN)/python -m burstcast_workflow.config.reference > workflow/schemas/config.schema.json
	$(BIN)/python -m burstcast_workflow.tables.page > docs/tables.md
	$(BIN)/python docs/site/references.py > docs/references.md
	$(BIN)/burstcast explain --configfile config.yaml > docs/rules.md
	$(SNAKEMAKE) --rulegraph | $(BIN)/python docs/site/rule_graph.py docs/images/rule_graph.svg

# make results ARGS="collect results/paper" takes a campaign's tables first
results: $(VENV)/installed ## docs/results.md, from the tables in docs/results
	$(BIN)/python docs/results/$(if $(ARGS),keep,make_page).py $(ARGS)

docs: $(VENV)/documented ## the site, build/site/index.html, in two minutes
	$(BIN)/python docs/site/build.py $(ARGS)

links: $(VENV)/documented ## links and docstrings of the site alone
	$(BIN)/python docs/site/build.py --check

bench: $(VENV)/developed ## time what the work is made of
	$(BIN)/python benchmarks/bench.py $(ARGS)

slurm: $(VENV)/installed ## the paper's campaign on a Slurm cluster
	$(SNAKEMAKE) --workflow-profile profiles/slurm $(ARGS)

check: $(VENV)/developed ## linters and types alone
	$(BIN)/ruff check .
	$(BIN)/ruff format --check src tests workflow/scripts benchmarks examples docs/results docs/site
	$(BIN)/mypy
	$(BIN)/snakefmt --check Snakefile workflow/Snakefile workflow/rules

# Lock files hold every version; the package itself comes from this directory. Python compiles what is
# imported when it is imported: compiling all of it here would double the time. uv takes a tenth of
# the time of pip, which does it where uv cannot be had or does not find the index.
PIP := $(BIN)/pip install --quiet --no-compile --disable-pip-version-check --no-deps
UV := $(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps

$(BIN)/pip:
	$(PYTHON) -c 'import sys; sys.exit("burstcast needs Python 3.11 or newer: make PYTHON=...") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)
	-@$(PIP) $$(grep ^uv== requirements-development.lock)

$(VENV)/%.lock: %.lock | $(BIN)/pip
	@echo installing what $< lists
	@$(UV) -r $< 2>/dev/null || $(PIP) -r $<
	@touch $@

# what campaigns use
$(VENV)/installed: $(VENV)/requirements.lock pyproject.toml setup.py
	@$(UV) -e . 2>/dev/null || $(PIP) -e .
	@touch $@

# what linters, types, tests and benchmarks need beyond it
$(VENV)/developed: $(VENV)/installed $(VENV)/requirements-development.lock
	@touch $@

# what the site needs beyond that
$(VENV)/documented: $(VENV)/developed $(VENV)/requirements-docs.lock
	@touch $@

# Beside this file alone, and never what VENV= on the command line names. The cache stays: with it,
# results that .snakemake has forgotten cost nothing (docs/selective_rebuilds.md).
clean: ## remove what is not the results'
	cd '$(dir $(abspath $(lastword $(MAKEFILE_LIST))))' && \
		rm -rf .venv .snakemake .pytest_cache .mypy_cache .ruff_cache
