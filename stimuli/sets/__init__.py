"""A stimulus set: which clips a study needs, how each is laid out in time, rendered once.

`spec` says what is wanted, `plan` which lengths that means, `layout` how a clip is cut out of a
transition, `naming` what it is called, by what goes into it; `building` renders what is missing in
processes of their own (`workers`), `manifest` is what a session reads. Nothing here opens a window
or imports OpenGL in this process.
"""

from stimuli.render.appearance import Appearance
from stimuli.sets.building import Inventory, build, inventory, prune, stale_clips
from stimuli.sets.layout import clip_motion
from stimuli.sets.manifest import ClipEntry, Manifest, load_manifest
from stimuli.sets.plan import ResolvedPairing, resolve
from stimuli.sets.spec import Pairing, SetSpec, Through

__all__ = [
    "Appearance",
    "ClipEntry",
    "Inventory",
    "Manifest",
    "Pairing",
    "ResolvedPairing",
    "SetSpec",
    "Through",
    "build",
    "clip_motion",
    "inventory",
    "load_manifest",
    "prune",
    "resolve",
    "stale_clips",
]
