# Two commands do all the set-up: `make reproduce` and `make test`. Both create .venv on first use and keep it.

VENV := .venv
RUN := $(VENV)/bin

.PHONY: reproduce test test-long lint bench clean

reproduce: $(VENV)/.installed  ## the main job: the paper, by both methods, with a report
	$(RUN)/viscopoint reproduce

test: $(VENV)/.installed-dev  ## run the tests
	$(RUN)/pytest

test-long: $(VENV)/.installed-dev  ## run the studies that take many minutes
	$(RUN)/pytest -m long

lint: $(VENV)/.installed-dev  ## ruff and pyright
	$(RUN)/ruff check .
	$(RUN)/ruff format --check .
	$(RUN)/pyright

bench: $(VENV)/.installed  ## measure speed, memory and start-up
	$(RUN)/viscopoint bench --out runs/bench.json --force

clean:
	rm -rf $(VENV)

# uv where it exists, else venv and pip
$(VENV)/bin/python:
	@if command -v uv >/dev/null 2>&1; then uv venv --quiet --seed --allow-existing $(VENV); \
	else python3 -m venv $(VENV); fi

comma := ,

define install
	@if command -v uv >/dev/null 2>&1; then uv pip install --quiet --python $(RUN)/python -e '.$(1)'; \
	else $(RUN)/python -m pip install --quiet --disable-pip-version-check -e '.$(1)'; fi
	@touch $@
endef

$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(call install,)

$(VENV)/.installed-dev: pyproject.toml | $(VENV)/bin/python
	$(call install,[test$(comma)lint])
	@touch $(VENV)/.installed
