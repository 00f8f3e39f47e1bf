"""All faults of a protocol at once, each with its key path and, where it can be found, its line."""

import difflib
import inspect
import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel, ValidationError

from study.schema import Keys, ProtocolFile
from study.staircase import RULES


class Fault(NamedTuple):
    """One thing wrong: the keys that lead to it, and what was expected and found."""

    path: tuple[str | int, ...]
    message: str


def faults(document: Mapping[str, Any]) -> list[Fault]:
    """Every fault of a parsed protocol: of single keys, and of keys that do not fit together."""
    found = [*_of_keys(document), *_of_wholes(document)]
    return [f for n, f in enumerate(found) if f.path not in [g.path for g in found[:n]]]


def render(found: list[Fault], text: str, where: str) -> str:
    """The faults as lines `file:line: key.path: message`."""
    return "\n".join(f"{where}{_place(fault, text)}: {fault.message}" for fault in found)


def _place(fault: Fault, text: str) -> str:
    line = find_line(text, fault.path)
    dotted = ".".join(str(part) for part in fault.path)
    return (f":{line}" if line else "") + f": {dotted}"


def find_line(text: str, path: tuple[str | int, ...]) -> int | None:
    """The 1-based line where the deepest key of `path` stands, or None."""
    lines = text.splitlines()
    start, end, rest = _own_table(lines, path)
    found = start if len(rest) < len(path) else None  # the line of the table's header
    for part in rest:
        place = _item(lines, start, end, part) if isinstance(part, int) else None
        if isinstance(part, str):
            key = re.compile(rf"""(^|[\s,{{.])["']?{re.escape(part)}["']?\s*[=.]""")
            at = (n for n in range(start, end) if key.search(_bare(lines[n])))
            place = next(at, None)
        if place is None:
            break
        start, found = place, place + 1
        end = min(end, _closed(lines, start, end))
    return found


def _own_table(
    lines: list[str], path: tuple[str | int, ...]
) -> tuple[int, int, tuple[str | int, ...]]:
    """The lines [start, end) of the deepest table of `path` that has a header; the keys below."""
    upto = next((n for n, part in enumerate(path) if isinstance(part, int)), len(path))
    for depth in range(upto, 0, -1):
        names = r"\s*\.\s*".join(re.escape(str(part)) for part in path[:depth])
        header = re.compile(rf"\s*\[+\s*{names}\s*\]")
        headers = [n for n, line in enumerate(lines) if header.match(line)]
        number = next(iter(path[depth:]), None)
        of_array = isinstance(number, int) and any("[[" in lines[n] for n in headers)
        if isinstance(number, int) and of_array and number < len(headers):
            headers, depth = headers[number:], depth + 1
        if headers:
            at = headers[0]
            following = (n for n in range(at + 1, len(lines)) if lines[n].lstrip().startswith("["))
            return at + 1, next(following, len(lines)), path[depth:]
    top = next((n for n, line in enumerate(lines) if line.startswith("[")), len(lines))
    return 0, top, path


def _bare(line: str) -> str:
    return line.split("#")[0]


def _closed(lines: list[str], start: int, end: int) -> int:
    """The line after the one where the brackets opened in line `start` are closed."""
    depth = 0
    for n in range(start, end):
        depth += sum({"{": 1, "[": 1, "}": -1, "]": -1}.get(c, 0) for c in _bare(lines[n]))
        if depth <= 0:
            return n + 1
    return end


def _item(lines: list[str], start: int, end: int, number: int) -> int | None:
    """The line where inline table `number` of an array begins; None where there are no such."""
    begins = [n for n in range(start, end) for c in _bare(lines[n]) if c == "{"]
    return begins[number] if number < len(begins) else None


def _of_keys(document: Mapping[str, Any]) -> Iterator[Fault]:
    try:
        ProtocolFile.model_validate(document)
    except ValidationError as error:
        details = error.errors()
        places = [detail["loc"] for detail in details]
        for detail in details:
            place = detail["loc"]
            implied = any(other != place and other[: len(place)] == place for other in places)
            if not implied:
                yield Fault(_as_written(place), _say(detail, place))


def _as_written(place: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """Without the tags that pydantic adds for the members of a union."""
    return tuple(
        p for p in place if not (isinstance(p, str) and re.search(r"\[|^(int|float|str)$", p))
    )


def _say(detail: Any, place: tuple[str | int, ...]) -> str:
    if detail["type"] == "missing":
        return "expected this key, found nothing; add it"
    if detail["type"] == "extra_forbidden":
        known = sorted(_keys_beside(_as_written(place)))
        near = difflib.get_close_matches(str(place[-1]), known, n=1)
        return "no such key here; " + (f"did you mean {near[0]}?" if near else "remove it")
    expected = (
        detail["msg"].replace("Input should be", "expected").replace("String should", "expected to")
    )
    return f"{expected}, found {detail['input']!r}"


def _keys_beside(place: tuple[str | int, ...]) -> set[str]:
    """The keys of the table in which the last of `place` stands."""
    kinds: list[Any] = [ProtocolFile]
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
    yield from _task(document)
    yield from _motions(document)
    yield from _lengths(document)
    yield from _methods(document)
    yield from _staircase(document)
    yield from _keys(document)
    yield from _functions(document)
    yield from _observer(document)


def _table(document: Mapping[str, Any], *path: str) -> Mapping[str, Any]:
    here: Any = document
    for part in path:
        here = here.get(part, {}) if isinstance(here, Mapping) else {}
    return here if isinstance(here, Mapping) else {}


def _one_of(value: object, known: tuple[str, ...]) -> str:
    return f"expected one of {', '.join(known)}, found {value!r}"


def _task(document: Mapping[str, Any]) -> Iterator[Fault]:
    from study.tasks import TASKS

    task = document.get("task")
    if task is not None and task not in TASKS:
        yield Fault(("task",), _one_of(task, tuple(TASKS)))
        return
    catching = _table(document, "trials").get("catch_every")
    if task is not None and catching and TASKS[task].catch is None:
        yield Fault(("trials", "catch_every"), f"a {task} study has none; remove it")


def _motions(document: Mapping[str, Any]) -> Iterator[Fault]:
    pairs = _table(document, "stimuli").get("motions", ())
    pairs = [pair for pair in pairs if isinstance(pair, Mapping)] if isinstance(pairs, list) else []
    names = [pair.get("name") for pair in pairs]
    for n, name in enumerate(names):
        if name in names[:n]:
            yield Fault(
                ("stimuli", "motions", n, "name"), f"expected a new name, found {name!r} twice"
            )
    used = {pair.get(side) for pair in pairs for side in ("from", "to")} - {None}
    for chosen, table in _table(document, "sets").items():
        bound = {key for key in table if key != "about"} if isinstance(table, Mapping) else set()
        for role in sorted(map(str, used - bound)):
            message = f"expected the role {role} bound to a clip and frame, found nothing; add it"
            yield Fault(("sets", chosen, role), message)
        for role in sorted(map(str, bound - used)):
            yield Fault(("sets", chosen, role), "no motion of [stimuli] uses this role; remove it")


def _lengths(document: Mapping[str, Any]) -> Iterator[Fault]:
    stimuli = _table(document, "stimuli")
    reference = stimuli.get("reference")
    by_length = [key for key in ("lengths", "shorter", "longer") if stimuli.get(key)]
    if document.get("task") == "odd-pair":
        if reference is None:
            yield Fault(("stimuli", "reference"), "expected the length k (frames or 'geodesic')")
        if not by_length:
            yield Fault(
                ("stimuli", "lengths"), "expected lengths, or differences shorter and longer"
            )
    elif document.get("task") == "preference" and (by_length or reference is not None):
        message = "a preference study compares methods; remove its lengths"
        yield Fault(("stimuli", by_length[0] if by_length else "reference"), message)
    if stimuli.get("lengths") and not isinstance(reference, int):
        yield Fault(
            ("stimuli", "lengths"), "lengths need a reference in frames; use shorter, longer"
        )
    for key in by_length:
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


def _methods(document: Mapping[str, Any]) -> Iterator[Fault]:
    from stimuli.transition import METHODS

    methods = document.get("methods", [])
    methods = methods if isinstance(methods, list) else []
    for method in methods:
        if method not in METHODS:
            yield Fault(("methods",), _one_of(method, tuple(METHODS)))
    if document.get("task") == "preference" and len(set(map(str, methods))) < 2:
        yield Fault(("methods",), f"expected two or more methods to compare, found {methods}")
    if document.get("task") == "odd-pair" and methods:
        yield Fault(("methods",), "an odd-pair study compares lengths; remove its methods")


def _staircase(document: Mapping[str, Any]) -> Iterator[Fault]:
    table = _table(document, "staircase")
    if document.get("task") == "preference" and table:
        yield Fault(("staircase",), "a preference study has no tracks; remove this table")
    rule = table.get("rule")
    if rule is None:
        return
    if rule not in RULES:
        yield Fault(("staircase", "rule"), _one_of(rule, tuple(RULES)))
    else:
        takes = inspect.signature(RULES[rule]).parameters
        for key in table:
            if key in ("n_down", "n_up", "down", "up") and key not in takes:
                yield Fault(("staircase", key), f"the rule {rule} takes no {key}; remove it")
    stop = _table(document, "staircase", "stop")
    if "stop" in table and not set(stop) & {"visits", "reversals", "trials"}:
        yield Fault(("staircase", "stop"), "expected visits, reversals or trials, found none")


def _keys(document: Mapping[str, Any]) -> Iterator[Fault]:
    """A key has one meaning."""
    given = _table(document, "keys")
    meanings = {**Keys().model_dump(), **given}
    for name, key in given.items():
        twins = [other for other, its in meanings.items() if its == key and other != name]
        if twins:
            yield Fault(("keys", name), f"expected a key of its own, found that of {twins[0]}")


def _functions(document: Mapping[str, Any]) -> Iterator[Fault]:
    from analysis.psychometric import FUNCTIONS

    for table in ("analysis", "observer"):
        function = _table(document, table).get("function")
        if function is not None and function not in FUNCTIONS:
            yield Fault((table, "function"), _one_of(function, tuple(FUNCTIONS)))


def _observer(document: Mapping[str, Any]) -> Iterator[Fault]:
    table = _table(document, "observer")
    if not table:
        return
    if document.get("task") == "odd-pair":
        for key in ("slope",):
            if key not in table:
                yield Fault(("observer", key), "expected this key, found nothing; add it")
        stimuli = _table(document, "stimuli")
        if stimuli.get("lengths") or (stimuli.get("shorter") and stimuli.get("longer")):
            for key in ("shorter", "longer"):
                if key not in table:
                    yield Fault(
                        ("observer", key), "expected the signed threshold in frames; add it"
                    )
    elif document.get("task") == "preference":
        wanted = set(map(str, document.get("methods", [])))
        prefer = _table(document, "observer", "prefer")
        nested = {k: v for k, v in prefer.items() if isinstance(v, Mapping)} or {"": prefer}
        for category, shares in nested.items():
            path = ("observer", "prefer", category) if category else ("observer", "prefer")
            if set(shares) != wanted:
                message = (
                    f"expected a probability for each of {sorted(wanted)}, found {dict(shares)}"
                )
                yield Fault(path, message)
