# Two commands do all the set-up: `make reproduce` and `make test`. Both create .venv on first use and keep it.

VENV := .venv
RUN := $(VENV)/bin
LOWEST := .venv-lowest

.PHONY: reproduce test test-long test-lowest lint bench clean

reproduce: $(VENV)/.installed  ## the main job: the paper, by both methods, with a report
	$(RUN)/viscopoint reproduce

test: $(VENV)/.installed-dev  ## run the tests
	$(RUN)/pytest -n auto --maxprocesses 4

test-long: $(VENV)/.installed-dev  ## run the studies that take many minutes
	$(RUN)/pytest -m long

test-lowest: $(LOWEST)/.installed  ## run a few tests with the lowest versions that pyproject.toml allows
	$(LOWEST)/bin/python -m pytest -o filterwarnings=default tests/unit/test_units.py tests/unit/test_case.py \
	  tests/unit/test_every_method.py

lint: $(VENV)/.installed-dev  ## ruff and pyright
	$(RUN)/ruff check .
	$(RUN)/ruff format --check .
	$(RUN)/pyright

bench: $(VENV)/.installed  ## measure speed, memory and start-up
	$(RUN)/viscopoint bench --out runs/bench.json --force

clean:
	rm -rf $(VENV) $(LOWEST)

# uv where it exists, else venv and pip
%/bin/python:
	@if command -v uv >/dev/null 2>&1; then uv venv --quiet --seed --allow-existing $*; \
	else python3 -m venv $*; fi

comma := ,

# of a virtual environment: the package with extras, and more options
define install
	@if command -v uv >/dev/null 2>&1; then uv pip install --quiet --python $(1)/bin/python -e '.$(2)' $(3); \
	else $(1)/bin/python -m pip install --quiet --disable-pip-version-check -e '.$(2)' $(3); fi
	@touch $@
endef

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(call install,$(VENV),[threads])

$(VENV)/.installed-dev: pyproject.toml | $(VENV)/bin/python
	$(call install,$(VENV),[threads$(comma)test$(comma)lint])
	@touch $(VENV)/.installed

$(LOWEST)/.installed: pyproject.toml .ci/lowest.py | $(LOWEST)/bin/python
	@$(LOWEST)/bin/python .ci/lowest.py > $(LOWEST)/constraints.txt
	$(call install,$(LOWEST),[mesh],pytest hypothesis scipy -c $(LOWEST)/constraints.txt)
