"""All faults of a protocol at once, each with its key path and, where it can be found, its line.

What only one kind of study can get wrong is told by its task (see `study.trials.tasks`).
"""

import difflib
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel, ValidationError

from stimuli.places import find_line
from study.protocol.keys import KEY_NAMES
from study.protocol.schema import Keys, ProtocolFile

_NO_ROLES = ("about", "collection")  # keys of a set that are names of its own
SOME_KEYS = ("1", "a", "left", "space", "return", "num_1", "f1")


class Fault(NamedTuple):
    """One thing wrong: the keys that lead to it, and what was expected and found."""

    path: tuple[str | int, ...]
    message: str


TaskCheck = Callable[[Mapping[str, Any]], Iterator[Fault]]


def faults(
    document: Mapping[str, Any],
    task: str,
    files: Mapping[str, type[ProtocolFile]],
    check: TaskCheck,
) -> list[Fault]:
    """Every fault of a parsed protocol: of single keys, and of keys that do not fit together.

    `files` holds what a protocol of each task may say; a `task` not among them is checked for what
    all have in common. `check` finds what this task alone can get wrong.
    """
    found = [*_of_keys(document, task, files), *_of_wholes(document), *check(document)]
    return [f for n, f in enumerate(found) if f.path not in [g.path for g in found[:n]]]


def tell_faults(found: list[Fault], text: str, where: str) -> str:
    """The faults as lines `file:line: key.path: message`."""
    return "\n".join(f"{where}{_place(fault, text)}: {fault.message}" for fault in found)


def _place(fault: Fault, text: str) -> str:
    line = find_line(text, fault.path)
    dotted = ".".join(str(part) for part in fault.path)
    return (f":{line}" if line else "") + f": {dotted}"


def table_at(document: Mapping[str, Any], *path: str) -> Mapping[str, Any]:
    """The table that these keys lead to; an empty one where they lead to something else."""
    here: Any = document
    for part in path:
        here = here.get(part, {}) if isinstance(here, Mapping) else {}
    return here if isinstance(here, Mapping) else {}


def one_of(value: object, known: tuple[str, ...]) -> str:
    """What is said of a value that is none of the `known`."""
    return f"expected one of {', '.join(known)}, found {value!r}"


def _of_keys(
    document: Mapping[str, Any], task: str, files: Mapping[str, type[ProtocolFile]]
) -> Iterator[Fault]:
    file = files.get(task, ProtocolFile)
    try:
        file.model_validate(document)
    except ValidationError as error:
        details = error.errors()
        places = [detail["loc"] for detail in details]
        for detail in details:
            place = detail["loc"]
            implied = any(other != place and other[: len(place)] == place for other in places)
            owners = _owners(detail, files)
            if not implied and (task in files or not owners):
                yield Fault(_as_written(place), _say(detail, file, owners))


def _owners(detail: Any, files: Mapping[str, type[ProtocolFile]]) -> list[str]:
    """The tasks whose protocols know a key that is said to be unknown."""
    if detail["type"] != "extra_forbidden":
        return []
    place = _as_written(detail["loc"])
    return [name for name, file in files.items() if str(place[-1]) in _keys_beside(file, place)]


def _as_written(place: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """Without the tags that pydantic adds for the members of a union."""
    return tuple(
        p for p in place if not (isinstance(p, str) and re.search(r"\[|^(int|float|str)$", p))
    )


def _say(detail: Any, file: type[ProtocolFile], owners: list[str]) -> str:
    place = _as_written(detail["loc"])
    if detail["type"] == "missing":
        return "expected this key, found nothing; add it"
    if owners:
        return f"only studies of the task {' or '.join(owners)} have it; remove it"
    if detail["type"] == "extra_forbidden":
        known = sorted(_keys_beside(file, place))
        near = difflib.get_close_matches(str(place[-1]), known, n=1)
        return "no such key here; " + (f"did you mean {near[0]}?" if near else "remove it")
    expected = (
        detail["msg"].replace("Input should be", "expected").replace("String should", "expected to")
    )
    return f"{expected}, found {detail['input']!r}"


def _keys_beside(file: type[ProtocolFile], place: tuple[str | int, ...]) -> set[str]:
    """The keys of the table in which the last of `place` stands."""
    kinds: list[Any] = [file]
    for part in place[:-1]:
        kinds = [inner for kind in kinds for inner in _inside(kind, part)]
    models = [model for kind in kinds for model in _models(kind)]
    return {field.alias or name for m in models for name, field in m.model_fields.items()}


def _inside(kind: Any, part: str | int) -> Iterator[Any]:
    """What a value of the type `kind` holds at a key or place."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        named = [f for name, f in kind.model_fields.items() if part in (name, f.alias)]
        extra = get_args(kind.__annotations__.get("__pydantic_extra__"))[1:]
        yield from [field.annotation for field in named] or extra
    elif get_origin(kind) in (dict, tuple):
        yield get_args(kind)[-1 if get_origin(kind) is dict else 0]
    else:
        for member in get_args(kind):
            yield from _inside(member, part)


def _models(kind: Any) -> Iterator[type[BaseModel]]:
    """The tables that a value of the type `kind` may be."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield kind
    elif get_origin(kind) not in (dict, tuple):
        for member in get_args(kind):
            yield from _models(member)


def _of_wholes(document: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults between keys, each check reading only tables that have the right shape."""
    yield from _motions(document)
    yield from _lengths(document)
    yield from _methods(document)
    yield from _keys(document)
    yield from _voids(document)
    yield from _functions(document)


def _motions(document: Mapping[str, Any]) -> Iterator[Fault]:
    pairs = table_at(document, "stimuli").get("motions", ())
    pairs = [pair for pair in pairs if isinstance(pair, Mapping)] if isinstance(pairs, list) else []
    names = [pair.get("name") for pair in pairs]
    for n, name in enumerate(names):
        if name in names[:n]:
            yield Fault(
                ("stimuli", "motions", n, "name"), f"expected a new name, found {name!r} twice"
            )
    used = {pair.get(side) for pair in pairs for side in ("from", "to")} - {None}
    for chosen, table in table_at(document, "sets").items():
        bound = (
            {key for key in table if key not in _NO_ROLES} if isinstance(table, Mapping) else set()
        )
        for role in sorted(map(str, used - bound)):
            message = f"expected the role {role} bound to a clip and frame, found nothing; add it"
            yield Fault(("sets", chosen, role), message)
        for role in sorted(map(str, bound - used)):
            yield Fault(("sets", chosen, role), "no motion of [stimuli] uses this role; remove it")


def no_conditions(document: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of a study whose trials take each pair for a motion of its own."""
    pairs = table_at(document, "stimuli").get("motions", ())
    for n, pair in enumerate(pairs if isinstance(pairs, list) else ()):
        for key in ("of", "condition"):
            if isinstance(pair, Mapping) and pair.get(key):
                yield Fault(("stimuli", "motions", n, key), "only ratings have it; remove it")


def no_lengths(document: Mapping[str, Any], why: str) -> Iterator[Fault]:
    """Lengths, or the one that they are compared with, of a study that shows methods."""
    by_length = given_lengths(document)
    if by_length or table_at(document, "stimuli").get("reference") is not None:
        message = f"{why}; remove its lengths"
        yield Fault(("stimuli", by_length[0] if by_length else "reference"), message)


def no_right_answers(document: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of a study whose answers are neither right nor wrong."""
    trials = table_at(document, "trials")
    for key in ("catch_every", "practice_criterion", "practice_most"):
        if trials.get(key):
            yield Fault(("trials", key), "no answer of this task is right or wrong; remove it")


def _lengths(document: Mapping[str, Any]) -> Iterator[Fault]:
    stimuli = table_at(document, "stimuli")
    reference = stimuli.get("reference")
    if stimuli.get("lengths") and not isinstance(reference, int):
        yield Fault(
            ("stimuli", "lengths"), "lengths need a reference in frames; use shorter, longer"
        )
    for key in given_lengths(document):
        values = stimuli[key]
        if not isinstance(values, list) or not all(isinstance(v, int) for v in values):
            continue
        if sorted(set(values)) != values:
            yield Fault(("stimuli", key), f"expected ascending numbers, each once, found {values}")
        if isinstance(reference, int) and not stimuli.get("drop_missing"):
            made = {"lengths": values, "shorter": [reference - v for v in values]}.get(key, [])
            low = [v for v in made if v < 1]
            if low:
                message = f"expected blend lengths of 1 frame or more, found {low}; drop them"
                yield Fault(("stimuli", key), message)


def given_lengths(document: Mapping[str, Any]) -> list[str]:
    """The keys by which a protocol gives lengths around a reference."""
    stimuli = table_at(document, "stimuli")
    return [key for key in ("lengths", "shorter", "longer") if stimuli.get(key)]


def given_methods(document: Mapping[str, Any]) -> list[Any]:
    """The methods that a protocol lists."""
    methods = document.get("methods", [])
    return methods if isinstance(methods, list) else []


def _methods(document: Mapping[str, Any]) -> Iterator[Fault]:
    from stimuli.transition import METHODS

    for method in given_methods(document):
        if method not in METHODS:
            yield Fault(("methods",), one_of(method, tuple(METHODS)))
        elif METHODS[method].through:
            yield from _through(document, method)


def _through(document: Mapping[str, Any], method: str) -> Iterator[Fault]:
    """A method that goes through other motions is told which, in every set."""
    from stimuli.transition import METHODS

    for name, table in table_at(document, "sets").items():
        needed = METHODS[method].through == "collection"
        if needed and isinstance(table, Mapping) and "collection" not in table:
            message = f'{method} needs a collection of clips, such as clips = ["walk*"]; add it'
            yield Fault(("sets", str(name), "collection"), message)
    if table_at(document, "stimuli").get("specification", "start-end") != "start-end":
        yield Fault(("stimuli", "specification"), f"{method} leaves and reaches: it is start-end")


def _keys(document: Mapping[str, Any]) -> Iterator[Fault]:
    """A key is one that there is, and has one meaning."""
    given = table_at(document, "keys")
    meanings = {**Keys().model_dump(), **given}
    if not table_at(document, "presentation").get("replays"):
        meanings.pop("again")
    for name, key in given.items():
        if isinstance(key, str) and key not in KEY_NAMES:
            yield Fault(("keys", name), _no_key(key))
            continue
        twins = [other for other, its in meanings.items() if its == key and other != name]
        if twins:
            yield Fault(("keys", name), f"expected a key of its own, found that of {twins[0]}")


def _voids(document: Mapping[str, Any]) -> Iterator[Fault]:
    """A number of late frames belongs to the rule that counts them."""
    table = table_at(document, "presentation")
    counts, given = table.get("void") == "late-frames", "late_frames_allowed" in table
    if given and not counts:
        message = 'only void = "late-frames" counts them; say so, or remove it'
        yield Fault(("presentation", "late_frames_allowed"), message)
    if counts and not given:
        message = "expected late_frames_allowed, the most that a trial may have; add it"
        yield Fault(("presentation", "void"), message)


def _no_key(key: str) -> str:
    if not key.strip():
        return "expected the name of a key, found an empty one"
    likely = [name for name in KEY_NAMES if name in re.split(r"[\s_-]+", key.lower())]
    near = [*likely, *difflib.get_close_matches(key.lower(), KEY_NAMES, n=1)]
    hint = f"did you mean {near[0]}?" if near else f"keys are called {', '.join(SOME_KEYS)} …"
    return f'no key is called "{key}" ({hint})'


def _functions(document: Mapping[str, Any]) -> Iterator[Fault]:
    from analysis.psychometric import FUNCTIONS

    for table in ("analysis", "observer"):
        function = table_at(document, table).get("function")
        if function is not None and function not in FUNCTIONS:
            yield Fault((table, "function"), one_of(function, tuple(FUNCTIONS)))
