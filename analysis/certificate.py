"""What a design's estimates are worth: bias, spread and coverage over simulated studies.

Simulated trials come from elsewhere, study by study; here each study is analysed as the report
would analyse it, and the truth that made it is held against what came out.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.special import chdtrc, ndtr, ndtri

from analysis.mixed import MixedFit, mixed_logistic
from analysis.preferences import contests
from analysis.psychometric import PeopleCounts, fit, fit_batch, people_counts
from analysis.psychometric.bootstrap import percentile_interval, resample_people
from analysis.psychometric.profile import threshold_interval
from analysis.psychometric.reduced import fit_reduced
from analysis.psychometric.scoring import ROUGH
from analysis.psychometric.verdict import judge
from analysis.thresholds import FitPlan, prepared
from analysis.tracks import staircase_threshold, tracks

_SAMPLES = 400  # resamples of people for one simulated study's interval


@dataclass(frozen=True)
class Estimate:
    """One side of one simulated study, signed: fits, interval, staircase estimates, verdict."""

    side: str
    value: float
    low: float
    high: float
    ok: bool
    bias_reduced: float
    reversal_mean: float | None
    stop_level: float | None


def estimates(trials: pd.DataFrame, plan: FitPlan, seed: int) -> list[Estimate]:
    """Both sides of a simulated odd-pair study, analysed as the report does."""
    table = prepared(trials[trials["correct"].notna()])
    found = []
    for side, part in table.groupby("track", sort=True):
        sign = -1.0 if side == "shorter" else 1.0
        data = people_counts(part["participant"], part["level"], part["correct"])
        value, low, high, ok = _fitted(data, plan, np.random.default_rng([seed, int(sign > 0)]))
        low, high = sorted((sign * low, sign * high))
        staircase = staircase_threshold(tracks(part))
        found.append(
            Estimate(
                side=str(side),
                value=sign * value,
                low=low,
                high=high,
                ok=ok,
                bias_reduced=sign * fit_reduced(data.pooled(), plan.what).threshold(plan.at[0]),
                reversal_mean=staircase["reversal_mean"],
                stop_level=staircase["stop_level"],
            )
        )
    return found


def _fitted(
    data: PeopleCounts, plan: FitPlan, rng: np.random.Generator
) -> tuple[float, float, float, bool]:
    pooled, at = data.pooled(), plan.at[0]
    fits = fit(pooled, plan.what)
    correct, total = pooled.correct[None], pooled.total[None]
    verdict = int(judge(pooled.levels, fits, correct, total, at)[0][0])
    if len(data.people) > 1:
        drawn = resample_people(data, _SAMPLES, rng)
        again = fit_batch(pooled.levels, *drawn, plan.what, tolerance=ROUGH)
        low, high = percentile_interval(again.threshold(at))
    else:
        ends = threshold_interval(fits, correct, total, at)
        low, high = float(ends[0][0]), float(ends[1][0])
    return float(fits.threshold(at)[0]), low, high, verdict == 0


def threshold_certificate(
    studies: list[list[Estimate]], truth: dict[str, float]
) -> list[dict[str, Any]]:
    """Bias, spread and coverage of every estimate, a side at a time."""
    told = []
    for side, true in truth.items():
        own = [entry for study in studies for entry in study if entry.side == side]
        if not own:
            continue
        held = [entry.low <= true <= entry.high for entry in own]
        told.append(
            {
                "side": side,
                "truth": true,
                "studies": len(own),
                "identifiable": float(np.mean([entry.ok for entry in own])),
                "coverage": float(np.mean(held)),
                "fit": _spread([entry.value for entry in own], true),
                "bias_reduced": _spread([entry.bias_reduced for entry in own], true),
                "reversal_mean": _spread([entry.reversal_mean for entry in own], true),
                "stop_level": _spread([entry.stop_level for entry in own], true),
                "interval_width": _median([entry.high - entry.low for entry in own]),
            }
        )
    return told


def _median(values: list[float]) -> float | None:
    middle = float(np.median(values))
    return middle if np.isfinite(middle) else None


def _spread(values: list[Any], true: float) -> dict[str, float | None]:
    """Mean, bias and SD of the values that there are."""
    known = np.array([v for v in values if v is not None and np.isfinite(v)], float)
    if len(known) == 0:
        return {"mean": None, "bias": None, "sd": None}
    sd = float(known.std(ddof=1)) if len(known) > 1 else None
    return {"mean": float(known.mean()), "bias": float(known.mean() - true), "sd": sd}


def preference_finds(
    trials: pd.DataFrame, methods: tuple[str, ...], alpha: float
) -> dict[str, dict[str, bool]]:
    """Whether the pooled test and the mixed model each find a preference in a simulated study.

    By category as the report has them: `all` first, then each where there are several.
    """
    found = {}
    for contest in contests(trials, methods):
        if (contest.a, contest.b) != tuple(methods[:2]):
            continue
        count, table = contest.count, contest.choices
        model = mixed_logistic(
            table["participant"].to_numpy(), table["motion"].to_numpy(), table["chose_a"].to_numpy()
        )
        pooled = count.p is not None and count.p < alpha
        found[contest.category] = {"chi2": pooled, "mixed_model": _found(model, pooled, alpha)}
    return found


def _found(model: MixedFit, pooled: bool, alpha: float) -> bool:
    """A model that answers too uniform do not allow leaves the pooled test."""
    return pooled if model.p is None else model.p < alpha


MODEL = "the mixed model of people and motions (t test of its log odds)"


@dataclass(frozen=True)
class PowerJob:
    """What the power of one design is simulated for: people who each answer once to each motion.

    `share` is the preference of the average person, `spread` the SD of people in log odds.
    """

    share: float
    people: int
    motions: int
    alpha: float
    spread: float
    sets: int
    seed: tuple[int, ...]


def preference_power(job: PowerJob) -> float:
    """Power of the mixed model, as the report fits it, to find a preference."""
    rng = np.random.default_rng(job.seed)
    who, which = (i.ravel() for i in np.indices((job.people, job.motions)))
    odds = np.log(job.share / (1 - job.share))
    odds = odds + job.spread * rng.standard_normal((job.sets, job.people))
    p = 1 / (1 + np.exp(-odds))
    found = 0
    for shares in p:
        chose = rng.random(len(who)) < shares[who]
        model = mixed_logistic(who, which, chose)
        n, k = len(chose), int(chose.sum())
        found += _found(model, float(chdtrc(1, (2 * k - n) ** 2 / n)) < job.alpha, job.alpha)
    return found / job.sets


def difference_power(effect: float, sd: float, simulated: int, people: int, alpha: float) -> float:
    """Power to tell two thresholds apart that differ by `effect` frames, `people` in each.

    `sd` is the spread of a threshold estimated from `simulated` people; it shrinks with the root
    of their number.
    """
    error = sd * np.sqrt(simulated / people) * np.sqrt(2)
    reach = ndtri(1 - alpha / 2)
    return float(ndtr(abs(effect) / error - reach) + ndtr(-abs(effect) / error - reach))


def fewest(power: dict[int, float], wanted: float = 0.8) -> int | None:
    """The smallest number of people whose power, and that of all larger ones, is enough."""
    enough = [people for people in power if all(power[n] >= wanted for n in power if n >= people)]
    return min(enough, default=None)
