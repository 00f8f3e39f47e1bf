"""What a protocol file may hold: one frozen model a table, every key with its bounds."""

from collections.abc import Callable
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0)]
Count = Annotated[int, Field(ge=1)]
Share = Annotated[float, Field(ge=0, le=1)]
Colour = Annotated[tuple[Share, Share, Share], Field()]
RESERVED = {"con", "prn", "aux", "nul", *(f"{n}{k}" for n in ("com", "lpt") for k in range(10))}


def _can_be_a_file(name: str) -> str:
    """The name, unless Windows has another use for it: files are called by it."""
    if name.lower().split(".")[0] in RESERVED or name.endswith("."):
        raise ValueError("expected a name that a file can have on Windows too")
    return name


Name = Annotated[
    str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$"), AfterValidator(_can_be_a_file)
]


class TomlTable(BaseModel):
    """A TOML table: no keys but its own, never changed after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class MotionPair(TomlTable):
    """A transition of the study: from the motion in one role to the motion in another.

    Where the clips that are compared differ in more than their method, each is a pair of its own:
    `of` names the motion that they share, `condition` what each is called. A pair with the text of
    an `example` is shown with it before the session begins, and in no trial.
    """

    name: Name
    from_: Name = Field(alias="from")
    to: Name
    category: str = ""
    of: Name | None = None
    condition: Name | None = None
    example: str = ""

    @property
    def group(self) -> str:
        """The motion that the pair is of."""
        return self.of or self.name


class Stimuli(TomlTable):
    """What is shown: pairs of motions, how they are joined, and how the clip is laid out."""

    motions: Annotated[tuple[MotionPair, ...], Field(min_length=1)]
    specification: Literal["start-end", "center-aligned"] = "start-end"
    reference: Count | Literal["geodesic"] | None = None
    lengths: tuple[int, ...] = ()
    shorter: tuple[Count, ...] = ()
    longer: tuple[Count, ...] = ()
    drop_missing: bool = False
    methods_apart: Annotated[int, Field(ge=0)] = 0
    seconds: Annotated[float, Field(ge=0.5, le=60)] = 6.0
    smooth: bool = False
    foot_lock: bool = True

    def pairs(self, rehearsal: bool = False) -> tuple[MotionPair, ...]:
        """The pairs that trials show; in a rehearsal those of the first motion."""
        asked = tuple(pair for pair in self.motions if not pair.example)
        first = asked[0].group if asked else None
        return tuple(pair for pair in asked if not rehearsal or pair.group == first)

    def shown(self, rehearsal: bool = False) -> tuple[MotionPair, ...]:
        """The pairs whose clips a session shows: those of trials, then the examples."""
        examples = () if rehearsal else tuple(pair for pair in self.motions if pair.example)
        return (*self.pairs(rehearsal), *examples)


Dot = Literal[
    "head", "neck", "pelvis", "shoulders", "elbows", "wrists", "hips", "knees", "ankles", "toes"
]


def _wide_enough(width: int) -> int:
    if 0 < width < 64:
        raise ValueError("expected 64 pixels or more, or 0 for as wide as the shape has it")
    return width


class AppearanceTable(TomlTable):
    """How a clip looks; the same for all clips of a group. See `stimuli.render.appearance`."""

    width: Annotated[int, Field(ge=0, le=3840), AfterValidator(_wide_enough)] = 0
    height: Annotated[int, Field(ge=64, le=2160)] = 720
    shape: Literal["best", "4:3", "16:9"] = "best"
    picture_degrees: Annotated[float, Field(gt=0, le=120)] = 20.0
    background: Colour = (0.5, 0.5, 0.5)
    supersample: Annotated[int, Field(ge=1, le=4)] = 1
    camera: Literal["auto", "fixed", "pan", "follow"] = "auto"
    direction: Annotated[float, Field(ge=-360, le=360)] | None = None
    elevation: Annotated[float, Field(ge=-80, le=80)] = 8.0
    field_of_view: Annotated[float, Field(ge=5, le=90)] = 20.0
    margin: Annotated[float, Field(ge=0, lt=0.5)] = 0.02
    ground: Literal["none", "shadow", "grid"] = "none"
    style: Literal["figure", "mannequin", "stick", "point-light"] = "figure"
    colour: Colour = (0.80, 0.76, 0.72)
    thickness: Annotated[float, Field(ge=0.5, le=2)] = 1.0
    tint: Share = 0.0
    proportions: Literal["captured", "standard"] = "captured"
    foot_roll: Annotated[float, Field(ge=0, le=180)] | None = None
    dots: Annotated[tuple[Dot, ...], Field(min_length=1)] = (
        "head", "shoulders", "elbows", "wrists", "hips", "knees", "ankles",
    )  # fmt: skip
    dot_size: Positive = 0.25
    dot_unit: Literal["degrees", "metres"] = "degrees"
    control: Literal["none", "scrambled", "inverted", "phase-scrambled"] = "none"
    control_seed: Annotated[int, Field(ge=0)] = 0


class Presentation(TomlTable):
    """How a trial is put on the screen, and when it was shown too badly to count.

    Pictures fill the share `clip_height` of the window's height, or of its width, as far as the
    layout has room for them, but are never shown larger than pixel for pixel unless `enlarge`.
    `viewing_distance` and `screen_width` (both cm) make degrees of visual angle of what is shown;
    without a width the system's word for the screen is taken.
    `void` is a late frame in what a blend mixes, or more than `late_frames_allowed` in all.
    `slow_screen_allowed` lets a screen through that has fewer refreshes than the clips frames.
    `markers` tells of each trial's events over Lab Streaming Layer; `photodiode` is the corner of a
    square that turns with each clip frame.
    """

    layout: Literal["side-by-side", "one-after-other"] | None = None
    gap: Annotated[float, Field(ge=0, le=10)] = 0.5
    answer_seconds: Positive | None = None
    clip_height: Annotated[float, Field(gt=0, le=1)] = 0.95
    enlarge: bool = False
    viewing_distance: Annotated[float, Field(ge=10, le=1000)] = 57.0
    screen_width: Annotated[float, Field(ge=5, le=1000)] | None = None
    void: Literal["late-in-blend", "late-frames", "never"] = "late-in-blend"
    late_frames_allowed: Annotated[int, Field(ge=0)] | None = None
    slow_screen_allowed: bool = False
    feedback_in_practice: bool = True
    replays: Annotated[int, Field(ge=0, le=20)] = 0
    markers: bool = False
    photodiode: Literal["top-left", "top-right", "bottom-left", "bottom-right"] | None = None


class Keys(TomlTable):
    """The keys that answer a trial, for the first and the second alternative, to go on, and to
    pause or leave."""

    first: str = "1"
    second: str = "2"
    go_on: str = "space"
    again: str = "r"
    quit: str = "escape"


def _names(*names: str) -> Callable[[str], str]:
    """A check that a text names nothing in braces but what is known there."""

    def checked(text: str) -> str:
        try:
            text.format(**dict.fromkeys(names, ""))
        except (KeyError, IndexError, ValueError, AttributeError) as error:
            known = " and ".join(f"{{{name}}}" for name in names)
            raise ValueError(f"expected no braces but {known}, found {text!r}") from error
        return text

    return checked


class Instructions(TomlTable):
    """What a participant reads; a blank text takes the task's own.

    Consent comes first, then the welcome and further pages; the debriefing comes at the end. Texts
    that are written here stand in the study's own language, those of keys and feedback too.
    """

    consent: str = ""
    welcome: str = ""
    pages: tuple[str, ...] = ()
    question: str = ""
    pause: str = ""
    interrupted: Annotated[str, AfterValidator(_names("go_on", "quit"))] = (
        "Paused.\n\nPress {go_on} to go on; what was on the screen is shown again.\n"
        "Press {quit} once more to leave. All answers so far are kept."
    )
    debriefing: str = ""
    thanks: str = "Thank you. The session is over."
    right: str = "right"
    wrong: str = "not this time"
    replay: Annotated[str, AfterValidator(_names("again", "left"))] = (
        "{again}   see it again ({left} left)"
    )


class Lab(TomlTable):
    """Who runs the study and where, for the data set that it leaves."""

    authors: tuple[str, ...] = ()
    institution: str = ""
    department: str = ""
    address: str = ""
    license: str = ""


class Trials(TomlTable):
    """Trials beside or instead of tracks.

    Practice goes on after its number of trials until the share `practice_criterion` of the last so
    many was right, at most to `practice_most`.
    """

    repeats: Count = 1
    practice: Annotated[int, Field(ge=0)] = 0
    practice_criterion: Share | None = None
    practice_most: Count | None = None
    catch_every: Annotated[int, Field(ge=0)] = 0
    break_every: Annotated[int, Field(ge=0)] = 0
    first: Literal["balanced", "random"] = "balanced"


class ObserverTable(TomlTable):
    """What a simulated participant truly is; each task adds what its people have.

    `spread` is how far people lie apart (SD), `reference` the length that stands in where a
    computed one cannot be had.
    """

    spread: Annotated[float, Field(ge=0)] = 0.0
    reference: Count | None = None


class Analysis(TomlTable):
    """The analysis that will be run, stated before the data."""

    alpha: Annotated[float, Field(gt=0, lt=0.5)] = 0.05
    function: str = "logistic"
    lapse: Literal["free"] | Annotated[float, Field(ge=0, lt=0.5)] = "free"
    lapse_bound: Annotated[float, Field(gt=0, lt=0.5)] = 0.2
    at: tuple[Annotated[float, Field(gt=0.5, lt=1)], ...] = (0.70, 0.75)
    bootstrap: Annotated[int, Field(ge=0)] = 2000
    exclude_catch_below: Share | None = None
    exclude_missing_above: Share | None = None
    exclude_faster_than: Positive | None = None
    exclude_slower_than: Positive | None = None
    exclude_fewer_trials: Count | None = None


class Rehearsal(TomlTable):
    """How short a rehearsal is: one motion, short clips, short tracks."""

    seconds: Annotated[float, Field(ge=0.5, le=10)] = 1.0
    trials: Count = 4


class Role(TomlTable):
    """A role bound to a frame (0-based, of the working clip) of a motion clip."""

    clip: Annotated[str, Field(min_length=1)]
    frame: Annotated[int, Field(ge=0)]


class CollectionTable(TomlTable):
    """Clips by patterns of their names, through which ways lead by cuts that cost less than tau."""

    clips: Annotated[tuple[Annotated[str, Field(min_length=1)], ...], Field(min_length=1)]
    tau: Positive = 1.0


class MotionSet(BaseModel):
    """The clips behind the roles; `about` says how their frames were chosen.

    `collection` is what methods that go through other motions go through.
    """

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[str, Role] = Field(init=False)
    about: str = ""
    collection: CollectionTable | None = None

    @property
    def roles(self) -> dict[str, Role]:
        """The roles that this set binds."""
        return dict(self.__pydantic_extra__)


class ProtocolFile(TomlTable):
    """A study whole, as its TOML file has it: what any task may say; each task adds its own.

    A screen of a trial shows `own_beside` clips side by side, a whole trial `own_clips`.
    """

    own_beside: ClassVar[int] = 1
    own_clips: ClassVar[int] = 2

    name: Name
    title: str = ""
    source: str = ""
    task: str
    participants: Count = 12
    methods: tuple[str, ...] = ()
    stimuli: Stimuli
    sets: Annotated[dict[Name, MotionSet], Field(min_length=1)]
    appearance: AppearanceTable = AppearanceTable()
    presentation: Presentation = Presentation()
    keys: Keys = Keys()
    lab: Lab = Lab()
    instructions: Instructions = Instructions()
    trials: Trials = Trials()
    rehearsal: Rehearsal = Rehearsal()
    observer: ObserverTable | None = None
    analysis: Analysis = Analysis()

    @property
    def beside(self) -> int:
        """How many clips a screen shows side by side."""
        layouts = {None: self.own_beside, "one-after-other": 1, "side-by-side": self.own_clips}
        return layouts[self.presentation.layout]
