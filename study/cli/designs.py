"""Simulated studies of a protocol and what they certify: composed here, since it needs both
`study`, which simulates, and `analysis`, which judges what came out.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

    from study.protocol.protocol import Protocol

PEOPLE = (6, 12, 18, 24, 35, 50, 80)
SHARES = (0.55, 0.60, 0.65, 0.75)
FRAMES = (1.0, 2.0, 3.0)
POWER = 0.8


@dataclass(frozen=True)
class Job:
    """One simulated study: small enough to send to a process."""

    document: dict[str, Any]
    references: dict[str, int]
    seed: int
    people: int


@dataclass(frozen=True)
class Options:
    """What is asked of a certificate: seed, effects for the power, a stimulus set to check."""

    seed: int = 1
    effects: tuple[float, ...] = ()
    stimuli: Path | None = None


def one_study(job: Job) -> dict[str, Any]:
    """Simulate one study and keep what the certificate needs of it."""
    from study.trials.reading import protocol_of

    protocol = protocol_of(job.document)
    trials, minutes, counts = simulated_trials(protocol, job)
    return {
        "trials": counts,
        "minutes": minutes,
        **TASKS.get(protocol.file.task, _nothing_more)(protocol, trials, job.seed),
        "table": trials,
    }


def simulated_trials(
    protocol: "Protocol", job: Job
) -> tuple["pd.DataFrame", list[float], list[float]]:
    """The counted trials of all people of one study, and each session's minutes and trials."""
    import pandas as pd

    from study.session.duration import minutes_of
    from study.session.simulation import plan_of, rows

    tables, minutes, counts = [], [], []
    for person in range(job.people):
        table = pd.DataFrame(list(rows(plan_of(protocol, job.references, job.seed, person))))
        table["participant"] = f"p{person + 1:03d}"
        minutes.append(minutes_of(table["onset"].tolist()))
        counts.append(float(len(table)))
        tables.append(table[(table["phase"] == "main") & ~table["void"].astype(bool)])
    whole = pd.concat(tables, ignore_index=True)
    numbers = {"correct", "difference", "rating"} & set(whole)
    return whole.astype(dict.fromkeys(numbers, float)), minutes, counts


def _odd_pair(protocol: "Protocol", trials: "pd.DataFrame", seed: int) -> dict[str, Any]:
    from analysis.certificate import estimates
    from analysis.thresholds import plan_of

    return {"estimates": estimates(trials, plan_of(dict(protocol.document)), seed)}


def _preference(protocol: "Protocol", trials: "pd.DataFrame", seed: int) -> dict[str, Any]:
    from analysis.certificate import preference_finds

    methods = tuple(protocol.file.methods)
    return {"finds": preference_finds(trials, methods, protocol.file.analysis.alpha)}


def _nothing_more(protocol: "Protocol", trials: "pd.DataFrame", seed: int) -> dict[str, Any]:
    return {}


TASKS: dict[str, Callable[["Protocol", "pd.DataFrame", int], dict[str, Any]]] = {
    "odd-pair": _odd_pair,
    "preference": _preference,
}


def certificate(
    protocol: "Protocol",
    references: dict[str, int],
    studies: list[dict[str, Any]],
    people: int,
    options: Options,
) -> dict[str, Any]:
    """Everything that is certified of a protocol."""
    import pandas as pd

    from analysis.design import balance, range_of

    tables = [s["table"].assign(study=n) for n, s in enumerate(studies)]
    tables = [t.assign(participant=t["participant"] + f"/{n}") for n, t in enumerate(tables)]
    trials = pd.concat(tables, ignore_index=True)
    entry: dict[str, Any] = {
        "protocol": protocol.name,
        "protocol_hash": protocol.hash,
        "task": protocol.file.task,
        "participants": people,
        "simulated_sets": len(studies),
        "seed": options.seed,
        "trials": range_of([n for s in studies for n in s["trials"]]),
        "minutes": range_of([n for s in studies for n in s["minutes"]]),
        "balance": balance(trials),
        "warnings": warnings_of(options.stimuli),
    }
    part = {"odd-pair": _odd_pair_part, "preference": _preference_part}.get(protocol.file.task)
    return entry | (part(protocol, references, studies, trials, people, options) if part else {})


def _odd_pair_part(
    protocol: "Protocol",
    references: dict[str, int],
    studies: list[dict[str, Any]],
    trials: "pd.DataFrame",
    people: int,
    options: Options,
) -> dict[str, Any]:
    from analysis.certificate import difference_power, fewest, threshold_certificate
    from analysis.design import convergence

    observer = protocol.file.observer
    assert observer is not None
    truth = {side: float(value) for side in ("shorter", "longer")
             if (value := getattr(observer, side)) is not None}  # fmt: skip
    thresholds = threshold_certificate([s["estimates"] for s in studies], truth)
    alpha = protocol.file.analysis.alpha
    sd = max((t["fit"]["sd"] or 0.0 for t in thresholds), default=0.0)
    power: list[dict[str, Any]] = [
        {
            "effect": effect,
            "participants": n,
            "power": difference_power(effect, sd, people, n, alpha) if sd else None,
        }
        for effect in options.effects or FRAMES
        for n in _numbers(protocol, people)
    ]
    effect = (options.effects or FRAMES[1:2])[0]
    by_people = {row["participants"]: row["power"] or 0.0 for row in power
                 if row["effect"] == effect}  # fmt: skip
    return {
        "staircases": exact_targets(protocol, references),
        "convergence": convergence(trials),
        "thresholds": thresholds,
        "power": power,
        "power_of": "telling two thresholds apart that differ by `effect` frames",
        "recommended_participants": fewest(by_people, POWER),
        "recommended_for": f"power {POWER:g} for a difference of {effect:g} frames",
    }


def _numbers(protocol: "Protocol", people: int) -> list[int]:
    """Numbers of people to give the power for: the protocol's own among them.

    One person alone has no spread to test against.
    """
    return sorted({*PEOPLE, *(n for n in (people, protocol.file.participants) if n > 1)})


def exact_targets(protocol: "Protocol", references: dict[str, int]) -> list[dict[str, Any]]:
    """Where each staircase settles on the protocol's observer, from its Markov chain."""
    from study.trials.plan import make_plan
    from study.trials.tasks import TASKS

    settles = TASKS[protocol.file.task].settles
    return settles(make_plan(protocol, references, 0)) if settles else []


def _preference_part(
    protocol: "Protocol",
    references: dict[str, int],
    studies: list[dict[str, Any]],
    trials: "pd.DataFrame",
    people: int,
    options: Options,
) -> dict[str, Any]:
    import numpy as np

    from analysis.certificate import fewest, preference_power

    file = protocol.file
    spread = file.observer.spread if file.observer else 0.0
    answers = max(int(len(trials) / trials["participant"].nunique()), 1)
    power: list[dict[str, Any]] = [
        {
            "effect": share,
            "participants": n,
            "power": preference_power(
                share, n, answers, file.analysis.alpha, spread, np.random.default_rng(options.seed)
            ),
        }
        for share in options.effects or SHARES
        for n in _numbers(protocol, people)
    ]
    share = (options.effects or SHARES[2:3])[0]
    by_people = {row["participants"]: row["power"] for row in power if row["effect"] == share}
    return {
        "finds": {
            test: float(np.mean([s["finds"][test] for s in studies]))
            for test in ("chi2", "mixed_model")
        },
        "finds_of": "share of studies simulated from [observer] in which each test is significant",
        "power": power,
        "power_of": "finding a preference of share `effect`, people differing as in [observer]",
        "recommended_participants": fewest(by_people, POWER),
        "recommended_for": f"power {POWER:g} for a preference of {share:g}",
    }


def warnings_of(stimuli: Path | None) -> list[str]:
    """Clips of a stimulus set that their position alone gives away."""
    if stimuli is None:
        return []
    import json

    from analysis.design import telltale
    from stimuli.errors import InputError

    try:
        manifest = json.loads((stimuli / "manifest.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"{stimuli}: expected a stimulus set with a manifest.json, found none that can be read "
            f"({error}); build one with `segue render`"
        ) from error
    return telltale(manifest.get("clips", []))
