"""Simulated studies of a protocol and what they certify: composed here, since it needs both
`study`, which simulates, and `analysis`, which judges what came out.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from study.cli.expected import expected, measured

if TYPE_CHECKING:
    import pandas as pd

    from study.protocol.protocol import Protocol

_PEOPLE = (6, 12, 18, 24, 35, 50, 80)
SHARES = (0.55, 0.60, 0.65, 0.75)
_FRAMES = (1.0, 2.0, 3.0)
POWER = 0.8
WORTH_PROCESSES = 10  # simulated studies from which the power is worth other processes


@dataclass(frozen=True)
class SimulatedStudy:
    """One simulated study: small enough to send to a process."""

    document: dict[str, Any]
    references: dict[str, int]
    seed: int
    people: int


@dataclass(frozen=True)
class Options:
    """What is asked of a certificate: seed, effects for the power, stimuli to check, processes."""

    seed: int = 1
    effects: tuple[float, ...] = ()
    stimuli: Path | None = None
    workers: int | None = None
    scheduler: str | None = None


def one_study(job: SimulatedStudy) -> dict[str, Any]:
    """Simulate one study and keep what the certificate needs of it."""
    from study.trials.reading import protocol_of

    protocol = protocol_of(job.document)
    trials, minutes, counts = simulated_trials(protocol, job)
    study = {
        "trials": counts,
        "minutes": minutes,
        **_JUDGED.get(analysis_of(protocol), _nothing_more)(protocol, trials, job.seed),
        "table": trials,
    }
    return study | {"measured": measured(protocol, study)}


def simulated_trials(
    protocol: "Protocol", job: SimulatedStudy
) -> tuple["pd.DataFrame", list[float], list[float]]:
    """The counted trials of all people of one study, and each session's minutes and trials."""
    import pandas as pd

    from analysis.rows import FLAGS, NUMBERS
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
    numbers = (NUMBERS | FLAGS) & {name for name in whole if whole[name].dtype == object}
    return whole.astype(dict.fromkeys(numbers, float)), minutes, counts


def _odd_pair(protocol: "Protocol", trials: "pd.DataFrame", seed: int) -> dict[str, Any]:
    from analysis.certificate import estimates
    from analysis.thresholds import fit_plan_of

    return {"estimates": estimates(trials, fit_plan_of(dict(protocol.document)), seed)}


def _preference(protocol: "Protocol", trials: "pd.DataFrame", seed: int) -> dict[str, Any]:
    from analysis.certificate import preference_finds

    methods = tuple(protocol.file.methods)
    return {"finds": preference_finds(trials, methods, protocol.file.analysis.alpha)}


def _nothing_more(protocol: "Protocol", trials: "pd.DataFrame", seed: int) -> dict[str, Any]:
    return {}


_JUDGED: dict[str, Callable[["Protocol", "pd.DataFrame", int], dict[str, Any]]] = {
    "thresholds": _odd_pair,
    "preferences": _preference,
}


# What an effect is counted in, and below what it lies.
EFFECTS = {"thresholds": ("frames", float("inf")), "preferences": ("a share between 0 and 1", 1.0)}


def analysis_of(protocol: "Protocol") -> str:
    """The analysis that the answers of a protocol's task go to."""
    from study.trials.tasks import TASKS

    return TASKS[protocol.file.task].analysis


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
        "expected": expected(protocol, studies),
        "warnings": warnings_of(options.stimuli),
    }
    part = {"thresholds": _odd_pair_part, "preferences": _preference_part}.get(
        analysis_of(protocol)
    )
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
    from study.trials.plan import make_plan

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
        for effect in options.effects or _FRAMES
        for n in _numbers(protocol, people)
    ]
    effect = (options.effects or _FRAMES[1:2])[0]
    plan = make_plan(protocol, references, 0)
    levels = {(m.name, side): shown for m in plan.motions for side, shown in m.sides().items()}
    by_people = {row["participants"]: row["power"] or 0.0 for row in power
                 if row["effect"] == effect}  # fmt: skip
    return {
        "staircases": exact_targets(protocol, references),
        "ends": track_ends(protocol, references, options.seed),
        "convergence": convergence(trials, levels),
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
    return sorted({*_PEOPLE, *(n for n in (people, protocol.file.participants) if n > 1)})


def exact_targets(protocol: "Protocol", references: dict[str, int]) -> list[dict[str, Any]]:
    """Where each staircase settles on the protocol's observer, from its Markov chain."""
    from study.trials.plan import make_plan
    from study.trials.tasks import TASKS

    settles = TASKS[protocol.file.task].settles
    return settles(make_plan(protocol, references, 0)) if settles else []


def track_ends(protocol: "Protocol", references: dict[str, int], seed: int) -> list[dict[str, Any]]:
    """How often tracks end at the first or last level, for whom, and what would mend it."""
    import numpy as np

    from study.trials.plan import make_plan
    from study.trials.tasks import TASKS

    ends = TASKS[protocol.file.task].ends
    return ends(make_plan(protocol, references, 0), np.random.default_rng(seed)) if ends else []


def _preference_part(
    protocol: "Protocol",
    references: dict[str, int],
    studies: list[dict[str, Any]],
    trials: "pd.DataFrame",
    people: int,
    options: Options,
) -> dict[str, Any]:
    from analysis.certificate import MODEL, fewest

    finds, power = _finds(studies), _preference_powers(protocol, trials, people, options)
    share = (options.effects or SHARES[2:3])[0]
    by_people = {
        n: min(row["power"] for row in power if (row["effect"], row["participants"]) == (share, n))
        for n in sorted({row["participants"] for row in power})
    }
    several = len(finds) > 1
    return {
        "finds": finds["all"],
        "finds_by_category": {name: held for name, held in finds.items() if name != "all"},
        "finds_of": "share of studies simulated from [observer] in which each test is significant",
        "power": power,
        "power_test": MODEL,
        "power_of": f"finding a preference of share `effect` by {MODEL}, at α = "
        f"{protocol.file.analysis.alpha:g}, people differing as in [observer]",
        "power_sets": len(studies),
        "recommended_participants": fewest(by_people, POWER),
        "recommended_for": f"power {POWER:g} for a preference of {share:g}"
        + (" in every category" if several else ""),
    }


def _finds(studies: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """By category, the share of studies in which each test is significant."""
    import numpy as np

    names = list(dict.fromkeys(name for study in studies for name in study["finds"]))
    return {
        name: {
            test: float(np.mean([s["finds"][name][test] for s in studies if name in s["finds"]]))
            for test in ("chi2", "mixed_model")
        }
        for name in names
    }


def _preference_powers(
    protocol: "Protocol", trials: "pd.DataFrame", people: int, options: Options
) -> list[dict[str, Any]]:
    """The power of the model that the report trusts, for each share, number of people, category.

    As many simulated studies as were asked for; on all cores where there are many.
    """
    from analysis.certificate import PowerJob, preference_power
    from stimuli.processes import mapped
    from study.cli.common import progress

    file = protocol.file
    spread = file.observer.spread if file.observer else 0.0
    persons, sets = trials["participant"].nunique(), trials["study"].nunique()
    category = trials["category"].fillna("") if "category" in trials else trials["motion"].map(str)
    answers = (category.value_counts() / persons).round().astype(int).clip(lower=1)
    several = "category" in trials and category.nunique() > 1
    designs = dict(answers) if several else {"all": max(len(trials) // persons, 1)}
    rows: list[dict[str, Any]] = [
        {"effect": share, "category": name, "participants": n, "motions": int(motions)}
        for name, motions in designs.items()
        for share in options.effects or SHARES
        for n in _numbers(protocol, people)
    ]
    jobs = [
        PowerJob(row["effect"], row["participants"], row["motions"], file.analysis.alpha, spread,
                 sets, (options.seed, place))
        for place, row in enumerate(rows)
    ]  # fmt: skip
    most = len(jobs) if sets >= WORTH_PROCESSES else 1
    powers = mapped(preference_power, jobs, options.workers, most, options.scheduler)
    with progress(len(jobs), "simulating power") as step:
        for done, power in enumerate(powers, 1):
            rows[done - 1]["power"] = power
            step(done)
    return rows


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
