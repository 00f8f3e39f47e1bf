# Two commands do all of their own set-up: `make demo` and `make test`.
SHELL := /bin/bash

VENV := .venv
READY := $(VENV)/.ready
PYTHON := $(VENV)/bin/python

# A name with | is one package under its names in different releases of Debian and Ubuntu.
SYSTEM := xvfb libglu1-mesa libglib2.0-0|libglib2.0-0t64 libasound2|libasound2t64 \
	libjack-jackd2-0 libfontconfig1 fonts-dejavu-core libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri \
	libxkbcommon0 libdbus-1-3 libxcb-cursor0 libxkbcommon-x11-0 libxcb-icccm4 libxcb-image0 \
	libxcb-keysyms1 libxcb-render-util0 libxcb-shape0 libxcb-xkb1
SYSTEM_TEST := xdotool chromium|chromium-browser

.PHONY: demo test test-slow test-portable lint bench certify-statistics samples system system-test clean

demo: system $(READY)
	$(VENV)/bin/segue demo

# A file stays on one core: its tests share a screen, a set of clips, a record.
test: system-test lint samples
	OPENBLAS_NUM_THREADS=1 $(PYTHON) -m pytest --numprocesses logical --dist loadfile

test-slow: system-test $(READY)
	$(PYTHON) -m pytest -m slow

# What is sensitive to the machine, as on other processors, for other users and in other places.
test-portable: system-test samples
	$(PYTHON) -m tests.portable

# The sample motions that tests and the demo are made for, fetched once.
samples: $(READY)
	@$(PYTHON) -c 'import sys; from stimuli.motion import user_library; \
		sys.exit(not list(user_library().glob("humanoid3d_walk*")))' \
	|| $(VENV)/bin/segue motions fetch \
	|| echo "The sample motions cannot be fetched; tests that need them are skipped, and say so."

lint: $(READY)
	$(PYTHON) -m ruff check .
	$(PYTHON) -m ruff format --check .
	@for system in linux win32 darwin; do \
		echo "types on $$system:"; $(PYTHON) -m mypy --platform $$system || exit 1; done

bench: system $(READY)
	$(PYTHON) -m pip install --quiet --constraint constraints.txt --editable '.[bench,opinion]'
	$(PYTHON) -m tests.benchmarks

# Coverage of the published intervals over 1,000 simulated sets for each function.
certify-statistics: $(READY)
	$(PYTHON) -m pytest -m slow tests/analysis -s

$(READY): pyproject.toml constraints.txt
	@python=$$(for name in python3.12 python3.11 python3; do \
		"$$name" -c 'import sys, venv; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 12)))' \
			2>/dev/null && echo "$$name" && break; done); \
	if [ -z "$$python" ]; then \
		echo "Segue needs Python 3.11 or 3.12 with its venv module (apt-get install python3-venv)"; \
		exit 1; fi; \
	"$$python" -m venv $(VENV)
	$(PYTHON) -m pip install --quiet --constraint constraints.txt --upgrade pip
	PYTHONWARNINGS=ignore $(PYTHON) -m pip install --quiet --constraint constraints.txt \
		--editable '.[test,opinion]'
	@touch $@

# Installs what is missing as root; otherwise says the one line to run.
define install
	@if command -v dpkg-query >/dev/null; then missing=""; \
	for names in $(1); do \
		have=""; for name in $${names//|/ }; do \
			dpkg-query -W -f='$${Status}' "$$name" 2>/dev/null | grep -q 'install ok' && have=1; \
		done; \
		[ -n "$$have" ] || missing="$$missing $$names"; \
	done; \
	if [ -n "$$missing" ]; then \
		if [ "$$(id -u)" = 0 ]; then apt-get update -qq; fi; \
		chosen=""; for names in $$missing; do pick="$${names%%|*}"; \
			for name in $${names//|/ }; do \
				if apt-cache show "$$name" 2>/dev/null | grep -q '^Filename'; then \
					pick="$$name"; break; fi; done; \
			chosen="$$chosen $$pick"; done; \
		if [ "$$(id -u)" = 0 ]; then \
			DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
				$$chosen >/dev/null; \
		else \
			echo "Segue needs system packages; run: sudo apt-get install$$chosen"; exit 1; \
		fi; \
	fi; fi
endef

system:
	$(call install,$(subst |,\|,$(SYSTEM)))

system-test:
	$(call install,$(subst |,\|,$(SYSTEM) $(SYSTEM_TEST)))

clean:
	rm -rf $(VENV) build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
