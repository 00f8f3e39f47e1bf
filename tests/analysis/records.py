"""Records as the session writes them, for all four tasks, from people who are known.

The truth behind every record is an argument, so that tests can ask for it back.
"""

import csv
import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from analysis.psychometric import location_for, proportion

COMMON = (
    "trial",
    "phase",
    "repeat_of",
    "onset",
    "response",
    "response_time",
    "late_frames",
    "void",
    "clip_a",
    "clip_b",
)
COLUMNS = {
    "odd-pair": (
        "motion",
        "specification",
        "track",
        "reference_length",
        "length",
        "difference",
        "odd_pair",
        "odd_position",
        "correct",
    ),
    "preference": ("motion", "category", "first_method", "second_method", "chosen_method"),
    "rating": ("motion", "order", "position", "method", "question", "rating"),
    "natural": ("motion", "clip"),
}
LEVELS = {"shorter": tuple(range(2, 9, 2)), "longer": tuple(range(2, 13, 2))}


def write_dataset(
    root: Path,
    protocol: Mapping[str, Any],
    sessions: Mapping[str, Iterable[Mapping[str, Any]]],
    **sidecar: Any,
) -> Path:
    """A data set of one protocol: `sessions` maps participants to their rows."""
    root.mkdir(parents=True, exist_ok=True)
    description = {"Name": "generated", "BIDSVersion": "1.10.0", "DatasetType": "raw"}
    (root / "dataset_description.json").write_text(json.dumps(description))
    people = "participant_id\tage\tsex\tvision\tnaive\tanimation_experience\n"
    label = "".join(c for c in protocol["name"] if c.isalnum())
    digest = hashlib.sha256(json.dumps(protocol, sort_keys=True).encode()).hexdigest()
    for number, (person, rows) in enumerate(sessions.items()):
        people += f"sub-{person}\t{22 + number % 19}\t{'fm'[number % 2]}\tyes\tyes\tno\n"
        folder = root / f"sub-{person}" / "beh"
        folder.mkdir(parents=True, exist_ok=True)
        stem = folder / f"sub-{person}_task-{label}_run-1_beh"
        header = COMMON + COLUMNS[protocol["task"]]
        with stem.with_suffix(".tsv").open("w", newline="") as file:
            table = csv.DictWriter(file, header, "n/a", delimiter="\t", lineterminator="\n")
            table.writeheader()
            table.writerows(_numbered(rows))
        content = {
            "TaskName": protocol["name"],
            "Protocol": protocol,
            "ProtocolHash": digest,
            "StimulusSetHash": "n/a",
            "SoftwareVersions": {"python": "3.11.2", "segue": "0.1.0", "numpy": "2.3.5"},
            "Display": {"size": [1280, 720], "refresh_rate": 60.0},
            "Seed": 1000 + number,
            "Observer": "simulated",
            "Pace": 1.0,
            "Rehearsal": False,
            "Finished": True,
            **sidecar,
        }
        stem.with_suffix(".json").write_text(json.dumps(content))
    (root / "participants.tsv").write_text(people)
    return root


def _numbered(rows: Iterable[Mapping[str, Any]]) -> Iterable[dict[str, Any]]:
    onset = 1.0
    for number, row in enumerate(rows, start=1):
        base = {
            "trial": number,
            "phase": "main",
            "onset": f"{onset:.6f}",
            "response_time": "0.700000",
            "late_frames": 0,
            "void": 0,
            "clip_a": "a" * 64,
            "clip_b": "b" * 64,
        }
        yield {**base, **row}
        onset += 14.0


def odd_pair_protocol(name: str = "jnd-center", **tables: Any) -> dict[str, Any]:
    return {
        "name": name,
        "title": "Just noticeable difference of center-aligned transitions",
        "source": "Wang 2005, VI.3.1",
        "task": "odd-pair",
        "stimuli": {
            "specification": "center-aligned",
            "reference": 10,
            "shorter": list(LEVELS["shorter"]),
            "longer": list(LEVELS["longer"]),
            "motions": [{"name": "dance-dance"}, {"name": "walk-walk"}],
        },
        "staircase": {"rule": "levitt", "n_down": 2, "n_up": 1, "stop": {"visits": 10}},
        "analysis": {
            "alpha": 0.05,
            "at": [0.70, 0.75],
            "function": "logistic",
            "lapse": "free",
            "bootstrap": 300,
        },
        **tables,
    }


def odd_pair_rows(
    rng: np.random.Generator,
    *,
    thresholds: Mapping[str, float] | None = None,
    spread: float = 1.0,
    slope: float = 0.6,
    lapse: float = 0.0,
    motions: tuple[str, ...] = ("dance-dance", "walk-walk"),
    reference: int = 10,
    levels: Mapping[str, tuple[int, ...]] = LEVELS,
    visits: int = 10,
    specification: str = "center-aligned",
) -> list[dict[str, Any]]:
    """One person's interleaved two-down one-up tracks, each ended by its visits."""
    truth = thresholds or {"shorter": -7.0, "longer": 10.0}
    rows: list[tuple[float, dict[str, Any]]] = []
    for side, mean in truth.items():
        own = max(abs(mean) + spread * rng.standard_normal(), 0.5)
        location = location_for("logistic", own, 0.75, slope, 0.5, lapse)
        for motion in motions:
            for place, level, right in _track(rng, levels[side], location, slope, lapse, visits):
                sign = -1 if side == "shorter" else 1
                odd = int(rng.integers(1, 3))
                row = {
                    "motion": motion,
                    "specification": specification,
                    "track": side,
                    "reference_length": reference,
                    "length": reference + sign * level,
                    "difference": sign * level,
                    "odd_pair": odd,
                    "odd_position": int(rng.integers(1, 3)),
                    "response": odd if right else 3 - odd,
                    "correct": int(right),
                }
                rows.append((place + rng.random(), row))
    return [row for _, row in sorted(rows, key=lambda entry: entry[0])]


def _track(
    rng: np.random.Generator,
    levels: tuple[int, ...],
    location: Any,
    slope: float,
    lapse: float,
    visits: int,
) -> Iterable[tuple[int, int, bool]]:
    seen: dict[int, int] = {}
    at, run, place = len(levels) - 1, 0, 0
    while max(seen.values(), default=0) < visits:
        level = levels[at]
        right = rng.random() < float(proportion("logistic", level, location, slope, 0.5, lapse))
        seen[level] = seen.get(level, 0) + 1
        yield place, level, right
        place, run = place + 1, run + 1 if right else 0
        if not right:
            at = min(at + 1, len(levels) - 1)
        elif run == 2:
            at, run = max(at - 1, 0), 0


def preference_protocol(name: str = "geodesic-fixed", **tables: Any) -> dict[str, Any]:
    return {
        "name": name,
        "title": "Geodesic blend length against a fixed one",
        "source": "Wang 2005, V.2, study one",
        "task": "preference",
        "methods": ["geodesic", "fixed"],
        "stimuli": {"specification": "start-end"},
        "analysis": {"alpha": 0.01},
        **tables,
    }


def preference_rows(
    choices: Iterable[tuple[str, str, str, str | None]], category: Mapping[str, str] | None = None
) -> list[dict[str, Any]]:
    """Rows of (motion, first method, second method, chosen method or None)."""
    return [
        {
            "motion": motion,
            "category": (category or {}).get(motion, "n/a"),
            "first_method": first,
            "second_method": second,
            "chosen_method": chosen or "n/a",
            "response": "n/a" if chosen is None else "first" if chosen == first else "second",
        }
        for motion, first, second, chosen in choices
    ]


def counted_preferences(
    prefer_a: int,
    people: int,
    motions: int,
    a: str = "geodesic",
    b: str = "fixed",
    seed: int = 0,
) -> dict[str, list[dict[str, Any]]]:
    """Sessions in which exactly `prefer_a` of people × motions answers chose `a`."""
    rng = np.random.default_rng(seed)
    chose = rng.permutation(np.arange(people * motions) < prefer_a)
    sessions = {}
    for person in range(people):
        choices = []
        for motion in range(motions):
            first, second = (a, b) if rng.random() < 0.5 else (b, a)
            chosen = a if chose[person * motions + motion] else b
            choices.append((f"motion-{motion + 1}", first, second, chosen))
        sessions[f"p{person + 1:02d}"] = preference_rows(choices)
    return sessions


def rating_protocol(name: str = "weights", **tables: Any) -> dict[str, Any]:
    return {
        "name": name,
        "title": "Original against optimised weights",
        "source": "Wang 2005, IV.4",
        "task": "rating",
        "methods": ["lee", "wang"],
        "analysis": {"alpha": 0.05},
        **tables,
    }


def rating_rows(
    ratings: Mapping[str, Mapping[str, int]], order: str, comparisons: Mapping[str, int]
) -> list[dict[str, Any]]:
    """One person's rows: `ratings` by method and question, then the comparison questions."""
    rows = []
    for position, method in enumerate(order.split("-"), start=1):
        for question, rating in ratings[method].items():
            rows.append(
                {
                    "motion": "dance",
                    "order": order,
                    "position": position,
                    "method": method,
                    "question": question,
                    "rating": rating,
                    "response": rating,
                }
            )
    for question, rating in comparisons.items():
        rows.append(
            {
                "motion": "dance",
                "order": order,
                "question": question,
                "rating": rating,
                "response": rating,
            }
        )
    return rows


def natural_protocol(name: str = "labels", **tables: Any) -> dict[str, Any]:
    return {"name": name, "title": "Natural or not", "task": "natural", **tables}


def natural_rows(answers: Mapping[str, str]) -> list[dict[str, Any]]:
    """One person's answers, `natural` or `unnatural`, by clip hash."""
    return [
        {"motion": "walk", "clip": clip, "clip_a": clip, "clip_b": "n/a", "response": answer}
        for clip, answer in answers.items()
    ]
