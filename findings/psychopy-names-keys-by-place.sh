#!/usr/bin/env bash
# PsychoPy's keyboard on psychtoolbox names a key by its place, as an American keyboard has it, and
# not by the layout in force: with a German layout the key that types z is `y`, with a French one
# the key that types a is `q`. A study whose keys are letters asks for other keys than are printed.
# Needs Xvfb, xdotool and setxkbmap, and a user who may have real-time priority (or it says so).
# Fails when this changes.
set -euo pipefail
chrt --fifo 1 true 2>/dev/null || { echo "this user may not have real-time priority"; exit 2; }
folder=$(mktemp -d)
trap 'kill "${server:-}" 2>/dev/null || true; rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet psychopy==2026.2.5 psychtoolbox==3.0.22.2 pyglet==1.5.27
exec 3>"$folder/number"
Xvfb -displayfd 3 -screen 0 640x480x24 -noreset +extension GLX >/dev/null 2>&1 &
server=$!
for _ in $(seq 100); do [ -s "$folder/number" ] && break; sleep .1; done
DISPLAY=:$(cat "$folder/number"); export DISPLAY
HOME=$folder "$folder/venv/bin/python" - <<'PY' 2>/dev/null
import importlib.metadata
import subprocess
import time

from psychopy.hardware import keyboard

keys = keyboard.Keyboard(backend="ptb")
found = {}
for layout in ("us", "de", "fr"):
    subprocess.run(["setxkbmap", layout], check=True)
    time.sleep(0.3)
    keys.clearEvents()
    for key in ("z", "a"):  # xdotool presses the key that types this letter in the layout
        subprocess.run(["xdotool", "keydown", key], check=True)
        time.sleep(0.08)
        subprocess.run(["xdotool", "keyup", key], check=True)
        time.sleep(0.08)
    found[layout] = [key.name for key in keys.getKeys(waitRelease=True)]
print("psychopy", importlib.metadata.version("psychopy"), "backend", keys.getBackend())
for layout, names in found.items():
    print(f"  {layout}: pressed the keys that type z and a; named {names}")
assert found == {"us": ["z", "a"], "de": ["y", "a"], "fr": ["w", "q"]}, found
PY
echo "as found"
