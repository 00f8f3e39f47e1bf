#!/usr/bin/env bash
# A window of pyglet 1.5 (the one that PsychoPy opens) is two X windows, one filling the other. Keys
# go to the inner one: a second X client that selects key events on the window itself gets none
# while the pointer is over it, and one that selects them on the inner window gets them all.
# Needs Xvfb and xdotool. Fails when this changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'kill "${server:-}" 2>/dev/null || true; rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pyglet==1.5.27 python-xlib==0.33
exec 3>"$folder/number"
Xvfb -displayfd 3 -screen 0 640x480x24 -noreset +extension GLX >/dev/null 2>&1 &
server=$!
for _ in $(seq 100); do [ -s "$folder/number" ] && break; sleep .1; done
DISPLAY=:$(cat "$folder/number"); export DISPLAY
"$folder/venv/bin/python" - <<'PY'
import subprocess, time
import pyglet
from Xlib import X
from Xlib.display import Display

window = pyglet.window.Window(400, 300)
window.dispatch_events()
listeners = {}
for name in ("_window", "_view"):
    display = Display()
    target = display.create_resource_object("window", getattr(window, name))
    target.change_attributes(event_mask=X.KeyPressMask)
    display.sync()
    listeners[name] = display
window.activate()
outer = listeners["_window"].create_resource_object("window", window._window)
outer.set_input_focus(X.RevertToParent, X.CurrentTime)
listeners["_window"].sync()
time.sleep(0.3)
subprocess.run(["xdotool", "mousemove", "200", "150"], check=True)
for key in "abc":
    subprocess.run(["xdotool", "keydown", key], check=True)
    time.sleep(0.08)
    subprocess.run(["xdotool", "keyup", key], check=True)
    time.sleep(0.05)
heard = {}
for name, display in listeners.items():
    events = [display.next_event() for _ in range(display.pending_events())]
    heard[name] = sum(event.type == X.KeyPress for event in events)
print("pyglet", pyglet.version, "| inner window is another:", window._view != window._window)
print("keys pressed: 3 | heard on the window:", heard["_window"], "| on the one within:", heard["_view"])
assert window._view != window._window
assert heard == {"_window": 0, "_view": 3}, heard
PY
echo "as found"
