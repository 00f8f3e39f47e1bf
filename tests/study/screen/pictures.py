"""Every kind of screen that a session shows, as pictures read from the back buffer of its window.

    python -m tests.study.screen.pictures docs/screens

writes one of each for the documentation, with clips of the sample motions. The tests look at the
texts of all protocols through the same window.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.protocol.protocol import Protocol, shipped
from study.screen.clips import ClipFile, ClipSource, Decoder, Held
from study.screen.placing import pixel_side, visual_angle
from study.screen.press import Press
from study.screen.virtual import virtual_screen
from study.screen.window import Look, WindowStage
from study.session.progress import advance, begin, next_trial
from study.session.showing import Settings, _with_replay, settings_of
from study.trials.plan import Plan, make_plan
from study.trials.prompt import Prompt
from study.trials.reading import load_protocol
from study.trials.trial import ClipKey, Outcome

Picture = NDArray[np.uint8]
Scene = Callable[[WindowStage], object]
PICTURED, SIZE = "jnd-center", (1920, 1080)
COLOURS, SMALLER = 48, 2  # of a picture in the documentation


class Witness:
    """A window whose every flip is kept, before a keyboard on which the first key is always down.

    `letters` are the smallest heights (pixels) in which texts were drawn.
    """

    def __init__(self, clips: ClipSource, **look: Any) -> None:
        made = Look(**{"gap": 0.0, "clip_height": 0.95, "fps": 30.0, "pace": 20.0,
                       "background": (128, 128, 128), **look})  # fmt: skip
        self.stage = WindowStage(made, clips, None)
        self.pictures: list[Picture] = []
        self.letters: list[float] = []
        self._flip = self.stage._flips.flip
        self.stage._flips.flip = self._kept  # type: ignore[method-assign]
        quit_key = made.keys.quit

        def pressed(names: Any, clear: bool = True) -> list[Press]:
            return [] if list(names) == [quit_key] else [Press(names[0], 0.1)]

        self.stage._keyboard.pressed = pressed  # type: ignore[method-assign]
        draw = self.stage._writer.draw

        def drawn(*words: Any, **options: Any) -> float:
            self.letters.append(draw(*words, **options))
            return self.letters[-1]

        self.stage._writer.draw = drawn  # type: ignore[method-assign]

    def _kept(self) -> float:
        if self.stage._patch:
            self.stage._patch.draw()
        self.pictures.append(np.asarray(self.stage.picture())[..., :3])
        return self._flip()

    def see(self, scene: Scene) -> list[Picture]:
        """The pictures of a scene, flip by flip."""
        self.pictures, self.letters = [], []
        scene(self.stage)
        return self.pictures


def plan_of(protocol: Protocol) -> Plan:
    """A session of a protocol, whose lengths are ten where they are computed."""
    lengths = {pair.name: 10 for pair in protocol.file.stimuli.motions}
    return make_plan(protocol, lengths, seed=1)


def prompts(plan: Plan, settings: Settings, trials: int = 12) -> Iterator[Prompt]:
    """The questions of a session's first trials, with the words of a replay too."""
    progress = begin(plan)
    for _ in range(trials):
        drawn = next_trial(progress)
        if drawn is None:
            return
        trial, card = drawn
        prompt = progress.task.ask(plan.protocol.file, trial.content)
        yield prompt
        yield _with_replay(prompt, settings, 3)
        progress = advance(
            progress, trial, card, Outcome(next(iter(prompt.answers.values())), 1.0, 0.0, 0, False)
        )


def texts_of(protocol: Protocol) -> Mapping[str, Scene]:
    """All that a protocol has its participants read, by its own words."""
    plan = plan_of(protocol)
    settings = settings_of(plan, begin(plan).task)
    examples = [pair.example for pair in protocol.file.stimuli.motions if pair.example]
    told = [settings.consent, *settings.pages, *examples, settings.pause, settings.debriefing]
    scenes: dict[str, Scene] = {}
    for text in filter(None, told):
        scenes[text] = lambda stage, text=text: stage.tell(text)
    for text in settings.feedback_texts:
        scenes[text] = lambda stage, text=text: stage.flash(text)
    scenes[settings.thanks] = lambda stage: stage.thank(settings.thanks)
    scenes[protocol.file.instructions.interrupted] = lambda stage: stage.pause()
    for prompt in prompts(plan, settings):
        scenes[prompt.text] = lambda stage, prompt=prompt: stage.ask(prompt, None, None)
    return scenes


def _decoder(folder: Path) -> tuple[Decoder, list[ClipKey], tuple[int, int]]:
    """Clips of a rehearsal of the protocol that is pictured, of the sample motions."""
    from stimuli.motion import Library, user_library
    from stimuli.sets import build
    from study.protocol.sets import set_spec

    library = Library([user_library()])
    spec = set_spec(load_protocol(PICTURED), None, library, rehearsal=True)
    manifest = build(spec, library, folder / "set")
    clips = {ClipKey("m", length=clip.document["length"]): clip for clip in manifest.clips}

    def lies(key: ClipKey) -> ClipFile:
        clip = clips[key]
        return ClipFile(clip.path, None, clip.frames, 0, clip.frames, *manifest.size)

    return Decoder(lies), list(clips), manifest.size


def documented(folder: Path) -> Iterator[tuple[str, Picture]]:
    """One picture of each kind of screen, by name."""
    decoder, keys, _ = _decoder(folder)
    jnd, weights = (load_protocol(name) for name in (PICTURED, "weights"))
    plans = [plan_of(protocol) for protocol in (jnd, weights)]
    settings = [settings_of(plan, begin(plan).task) for plan in plans]
    odd = list(prompts(plans[0], settings[0]))
    rated = {prompt.text: prompt for prompt in prompts(plans[1], settings[1])}
    each, *_, compared = (prompt for text, prompt in rated.items() if "again" not in text)
    first, last = keys[0], keys[-1]
    witness = Witness(decoder, keys=jnd.file.keys, pace=4.0, photodiode="bottom-left")
    scenes: Mapping[str, tuple[Scene, int]] = {
        "consent": (lambda stage: stage.tell(CONSENT), 0),
        "instructions": (lambda stage: stage.tell(settings[0].pages[0]), 0),
        "example": (lambda stage: stage.tell(_example(weights)), 0),
        "announced": (lambda stage: stage.present(((first, last), (first, first)), "t"), 0),
        "pair": (lambda stage: stage.present(((first, last),), "t"), 5),
        "both-pairs": (lambda stage: stage.present(((first, last, first, first),), "t"), 5),
        "one-clip": (lambda stage: stage.present(((first,),), "t"), 5),
        "question": (lambda stage: stage.ask(odd[0], None, None), 0),
        "replay": (lambda stage: stage.ask(odd[1], None, None), 0),
        "rating": (lambda stage: stage.ask(each, None, None), 0),
        "comparison": (lambda stage: stage.ask(compared, None, None), 0),
        "feedback": (lambda stage: stage.flash(settings[0].feedback_texts[0]), 0),
        "break": (lambda stage: stage.tell(settings[0].pause), 0),
        "paused": (lambda stage: stage.pause(), 0),
        "thanks": (lambda stage: stage.thank(settings[0].thanks), 0),
    }
    for name, (scene, place) in scenes.items():
        yield name, witness.see(scene)[place]
    witness.stage.close()


def _example(protocol: Protocol) -> str:
    return next(pair.example for pair in protocol.file.stimuli.motions if pair.example)


CONSENT = (
    "Consent to take part\n\nYou will watch short animations of moving figures and answer a "
    "question after each of them. The session lasts about forty minutes, with breaks.\n\n"
    "Your answers are stored under a number, not under your name, and will be published in a form "
    "in which nobody can be recognised.\n\nTaking part is up to you. You may stop at any time and "
    "need not say why: press ESCAPE, or tell the experimenter.\n\n"
    "Press SPACE if you agree to take part."
)


def main(out: str) -> int:
    """Have the documentation's pictures drawn by a process that ends before its screen does."""
    with virtual_screen(*SIZE):
        drawn = [sys.executable, "-m", "tests.study.screen.pictures", "draw", out]
        return subprocess.run(drawn, check=False).returncode


def draw(out: Path) -> int:
    """Write the documentation's pictures, of the screen that there is."""
    from PIL import Image

    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="segue-") as folder:
        for name, picture in documented(Path(folder)):
            small = Image.fromarray(picture).reduce(SMALLER)
            image = small.quantize(COLOURS, dither=Image.Dither.NONE)
            image.save(out / f"{name}.png", optimize=True)
    return 0


def check() -> int:
    """Print as JSON how the texts of all protocols lie in a window of the screen that there is."""
    protocols = [load_protocol(name) for name in shipped()]
    witness = Witness(Held({}), keys=protocols[0].file.keys)
    stage = witness.stage
    pixel = pixel_side(stage._window.winHandle.screen, None)
    capital = witness.see(lambda stage: stage.flash("H"))[0]
    rows = np.flatnonzero((capital[..., 0] < 64).any(axis=1))
    degrees = visual_angle(float(np.ptp(rows)) + 1, pixel, 100.0)
    scenes = {text: scene for p in protocols for text, scene in texts_of(p).items()}
    scenes[CONSENT] = lambda stage: stage.tell(CONSENT)
    found = []
    for text, scene in scenes.items():
        edges = [_at_the_edge(picture) for picture in witness.see(scene)]
        shrunk = min(witness.letters) / stage._writer.height
        found.append({"text": text, "pages": len(edges), "edge": any(edges), "letters": shrunk})
    stage.close()
    print(json.dumps({"size": list(stage._size()), "degrees": degrees, "texts": found}))
    return 0


def _at_the_edge(picture: Picture) -> bool:
    """Whether anything is drawn within a hundredth of a window's edge."""
    tall, wide = picture.shape[:2]
    outside = np.ones(picture.shape[:2], bool)
    outside[tall // 100 : -(tall // 100), wide // 100 : -(wide // 100)] = False
    return bool((np.ptp(picture[outside], axis=0) > 2).any())


if __name__ == "__main__":
    word = sys.argv[1]
    sys.exit(
        check() if word == "check" else draw(Path(sys.argv[2])) if word == "draw" else main(word)
    )
