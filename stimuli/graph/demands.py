"""What is demanded of a motion (sections 3.2 and 4.2.1), as a TOML file says it.

    frames = 300
    body = [{ at = 0, place = [0, 0], heading = 0 }, { at = "end", place = [2, 3], heading = 90 }]
    joint = [{ at = 150, role = "right_wrist", place = [1, 1.6, 1], velocity = [0, 0, 1] }]
    style = [{ from = 100, to = 200, label = "walk" }]
    avoid = [{ centre = [1, 2], radius = 0.5 }, { low = [0, 0, 0], high = [1, 2, 1] }]
    pose = [{ at = 60, clip = "jump", frame = 20 }]

Frames are 0-based at 30 a second, places in metres, headings in degrees (0 faces +Z, 90 faces +X).
`shortest = 8` are the fewest frames that a piece may have; 8 unless given. Several figures have a
table `[figures.NAME]` each.
"""

import difflib
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from stimuli.errors import InputError
from stimuli.graph import fields
from stimuli.graph.fields import KINDS, WEIGHTS_OF, Field
from stimuli.places import find_line

TOP = (*KINDS, "frames", "shortest", "weights")
SHORTEST_PIECE = 8  # frames of a piece: in fewer nothing is seen but two cuts
Where = tuple[str | int, ...]
Wrong = tuple[Where, str]  # the keys that lead to a fault, and what was expected and found


@dataclass(frozen=True)
class Demand:
    """One demand: its kind, its values (frames counted, "end" replaced), and where it stands."""

    kind: str
    values: Mapping[str, Any]
    path: Where

    def __getitem__(self, key: str) -> Any:
        return self.values[key]


@dataclass(frozen=True)
class Demands:
    """All that is demanded of one figure. `shortest` is the fewest frames of a piece."""

    name: str
    frames: int
    demands: tuple[Demand, ...]
    weights: Mapping[str, float] = field(
        default_factory=lambda: MappingProxyType(dict.fromkeys(WEIGHTS_OF, 1.0))
    )
    shortest: int = SHORTEST_PIECE

    def of(self, kind: str) -> list[Demand]:
        """The demands of a kind, in order of time."""
        found = [demand for demand in self.demands if demand.kind == kind]
        return sorted(found, key=lambda d: d.values.get("at", d.values.get("from", 0)))


@dataclass(frozen=True)
class DemandFile:
    """The figures of a file, and its text, so that a later fault can name its line."""

    where: str
    text: str
    figures: tuple[Demands, ...]

    def refuse(self, faults: Sequence[Wrong]) -> None:
        """InputError of all these faults, each with its line; nothing where there are none."""
        if faults:
            raise InputError(_told(faults, self.text, self.where))


def read_demands(path: Path) -> DemandFile:
    """The demands of a file; InputError with all faults at once, each with its line."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        document = tomllib.loads(text)
    except OSError as error:
        raise InputError(
            f"{path}: expected a file of demands, found: {error.strerror or error}."
        ) from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path}: expected TOML in UTF-8, found: {error}") from error
    tables = _figures(document)
    faults = [fault for place, table in tables.items() for fault in _faults(table, place)]
    if "figures" in document:
        faults += [
            ((key,), "expected only [figures.NAME] beside figures; move it into one of them")
            for key in document
            if key != "figures"
        ]
    if faults:
        raise InputError(_told(faults, text, str(path)))
    figures = tuple(_demands(table, place) for place, table in tables.items())
    return DemandFile(str(path), text, figures)


def _figures(document: Mapping[str, Any]) -> dict[Where, Any]:
    figures = document.get("figures")
    if figures is None:
        return {(): document}
    if not isinstance(figures, Mapping) or not figures:
        return {("figures",): figures}
    return {("figures", str(name)): table for name, table in figures.items()}


def _told(faults: Sequence[Wrong], text: str, where: str) -> str:
    lines = []
    for path, message in faults:
        line = find_line(text, path)
        dotted = ".".join(map(str, path))
        lines.append(f"{where}{f':{line}' if line else ''}: {dotted}: {message}")
    return "\n".join(dict.fromkeys(lines))


def _faults(table: Any, place: Where) -> Iterator[Wrong]:
    if not isinstance(table, Mapping):
        yield place, f"expected tables [figures.NAME], found {table!r}"
        return
    yield from _unknown(table, TOP if place else (*TOP, "figures"), place)
    if "frames" not in table:
        yield (*place, "frames"), "expected how many frames the motion has, found nothing; add it"
    elif expected := fields.motion_length(table["frames"]):
        yield (*place, "frames"), f"expected {expected}, found {table['frames']!r}"
    if expected := fields.piece_length(table.get("shortest", SHORTEST_PIECE)):
        yield (*place, "shortest"), f"expected {expected}, found {table['shortest']!r}"
    weights = table.get("weights", {})
    if isinstance(weights, Mapping):
        yield from _of_table(weights, WEIGHTS_OF, (*place, "weights"))
    else:
        yield (*place, "weights"), f"expected a table, found {weights!r}"
    for kind, keys in KINDS.items():
        entries = table.get(kind, [])
        if not isinstance(entries, list):
            yield (*place, kind), f"expected a list of tables, found {entries!r}"
            continue
        for n, entry in enumerate(entries):
            if not isinstance(entry, Mapping):
                yield (*place, kind, n), f"expected a table, found {entry!r}"
                continue
            yield from _of_table(entry, keys, (*place, kind, n))
            yield from _of_whole(kind, entry, table.get("frames"), (*place, kind, n))
    yield from _of_ends(table, place)


def _unknown(table: Mapping[str, Any], known: Sequence[str], place: Where) -> Iterator[Wrong]:
    for key in table:
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1)
            hint = f"did you mean {near[0]}?" if near else f"expected {', '.join(known)}"
            yield (*place, key), f"no such key here; {hint}"


def _of_table(table: Mapping[str, Any], keys: Mapping[str, Field], place: Where) -> Iterator[Wrong]:
    yield from _unknown(table, tuple(keys), place)
    for key, rule in keys.items():
        if key not in table:
            if rule.needed:
                yield (*place, key), "expected this key, found nothing; add it"
        elif expected := rule.check(table[key]):
            yield (*place, key), f"expected {expected}, found {table[key]!r}"


def _of_whole(kind: str, entry: Mapping[str, Any], frames: Any, place: Where) -> Iterator[Wrong]:
    """Faults between the keys of one demand, and of times beyond the motion."""
    if fields.frame(frames) is None:
        for key in ("at", "from", "to"):
            value = entry.get(key)
            if fields.frame(value) is None and value >= frames:
                yield (
                    (*place, key),
                    f'expected a frame from 0 to {frames - 1}, or "end", found {value}',
                )
    spanned = all(fields.frame(entry.get(key)) is None for key in ("from", "to"))
    if kind == "style" and spanned and entry["to"] < entry["from"]:
        yield (*place, "to"), f"expected {entry['from']} or more, found {entry['to']}"
    if kind == "avoid":
        yield from _of_place(entry, place)


def _of_place(entry: Mapping[str, Any], place: Where) -> Iterator[Wrong]:
    """A place to avoid is a circle or a box, whose low corner is below its high one."""
    circle, box = {"centre", "radius"}, {"low", "high"}
    whole = [shape for shape in (circle, box) if shape <= entry.keys()]
    if len(whole) != 1 or len((circle | box) & entry.keys()) > len(whole[0]):
        yield place, "expected either centre and radius, or low and high"
    elif whole[0] == box:
        low, high = entry["low"], entry["high"]
        if not (isinstance(low, list) and isinstance(high, list)):
            return
        if len(low) != len(high):
            yield (*place, "high"), f"expected as many numbers as low has, found {high!r}"
        elif all(map(fields.is_number, [*low, *high])) and any(
            a >= b for a, b in zip(low, high, strict=True)
        ):
            yield (*place, "high"), f"expected more than low, {low}, found {high}"


def _of_ends(table: Mapping[str, Any], place: Where) -> Iterator[Wrong]:
    """A motion must begin and end somewhere; poses cannot be two at once."""
    bodies = table.get("body", [])
    entries = bodies if isinstance(bodies, list) else []
    times = [_moment(b.get("at"), table) for b in entries if isinstance(b, Mapping)]
    last = _moment("end", table)
    if 0 not in times:
        yield (*place, "body"), "expected one at = 0, where the motion begins; add it"
    if last is not None and last not in times:
        yield (*place, "body"), 'expected one at = "end", where the motion ends; add it'
    for n, time in enumerate(times):
        if time is not None and time in times[:n]:
            yield (*place, "body", n, "at"), f"expected a new time, found {time} twice"
    poses = table.get("pose", [])
    seen: list[Any] = []
    for n, pose in enumerate(poses if isinstance(poses, list) else []):
        time = _moment(pose.get("at"), table) if isinstance(pose, Mapping) else None
        if time is not None and time in seen:
            yield (*place, "pose", n, "at"), f"expected a new time, found {time} twice"
        seen.append(time)


def _moment(value: Any, table: Mapping[str, Any]) -> int | None:
    frames = table.get("frames")
    if value == "end":
        return frames - 1 if fields.motion_length(frames) is None else None  # type: ignore[operator]
    return value if fields.frame(value) is None else None


def _demands(table: Mapping[str, Any], place: Where) -> Demands:
    found = []
    for kind, keys in KINDS.items():
        for n, entry in enumerate(table.get(kind, [])):
            values = {key: entry.get(key, rule.default) for key, rule in keys.items()}
            for key in {"at", "from", "to"} & values.keys():
                values[key] = _moment(values[key], table)
            found.append(Demand(kind, MappingProxyType(values), (*place, kind, n)))
    weights = {name: float(table.get("weights", {}).get(name, 1.0)) for name in WEIGHTS_OF}
    name = str(place[-1]) if place else ""
    return Demands(
        name, int(table["frames"]), tuple(found), MappingProxyType(weights),
        int(table.get("shortest", SHORTEST_PIECE)),
    )  # fmt: skip
