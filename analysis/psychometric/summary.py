"""A fit with everything that is reported of it: interval, goodness of fit and verdict."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.psychometric.bootstrap import (
    PeopleCounts,
    percentile_interval,
    resample_parametric,
    resample_people,
    resample_trials,
)
from analysis.psychometric.counts import Counts
from analysis.psychometric.fit import Batch, Setting, deviance, fit, fit_batch
from analysis.psychometric.functions import Array, proportion
from analysis.psychometric.scoring import ROUGH
from analysis.psychometric.verdict import INTERVAL, at_lapse_bound, judge, verdict_words

INTERVALS = {
    "profile": "profile likelihood",
    "parametric": "parametric bootstrap",
    "trials": "non-parametric bootstrap of trials",
    "people": "bootstrap of people, then of trials within people",
}
SAMPLES = 2000


@dataclass(frozen=True)
class Threshold:
    """Level at proportion `at` with the ends of its 95 % interval; ±inf where unbounded.

    `least` and `most` are the levels shown: nothing is known of what lies beyond them, so that an
    end out there is told as “beyond” the last level, never as a number.
    """

    at: float
    value: float
    low: float
    high: float
    least: float = float("-inf")
    most: float = float("inf")

    @property
    def beyond_low(self) -> float | None:
        """The level beyond which the lower end lies, if it does."""
        return self.least if self.low < self.least and np.isfinite(self.least) else None

    @property
    def beyond_high(self) -> float | None:
        """The level beyond which the upper end lies, if it does."""
        return self.most if self.high > self.most and np.isfinite(self.most) else None

    @property
    def signed_down(self) -> "Threshold":
        """The threshold with its sign turned, ends in ascending order."""
        return Threshold(self.at, -self.value, -self.high, -self.low, -self.most, -self.least)


@dataclass(frozen=True)
class Summary:
    """One fit as reported; the numbers stand even where the verdict denies them."""

    function: str
    location: float
    slope: float
    guess: float
    lapse: float
    log_likelihood: float
    deviance: float
    deviance_p: float | None
    thresholds: tuple[Threshold, ...]
    interval_method: str
    verdicts: tuple[str, ...]
    trials: int
    lapse_bound: float | None = None  # where the free lapse rate ended at it

    @property
    def verdict(self) -> str:
        return self.verdicts[0]

    @property
    def note(self) -> str:
        """What is to be known of a fit that stands; empty where there is nothing."""
        if self.lapse_bound is None:
            return ""
        return f"the lapse rate is at its bound of {self.lapse_bound:g}"

    def proportion(self, levels: Array) -> Array:
        """The fitted proportion right at `levels`."""
        return proportion(self.function, levels, self.location, self.slope, self.guess, self.lapse)

    def as_dict(self) -> dict[str, Any]:
        """The fields of `segue fit`; what the verdict denies is None."""
        denied = self.verdict != "ok"

        def kept(value: float | None) -> float | None:
            return None if denied or value is None or not np.isfinite(value) else float(value)

        return {
            "location": kept(self.location),
            "slope": kept(self.slope),
            "guess": self.guess,
            "lapse": kept(self.lapse),
            "log_likelihood": self.log_likelihood,
            "deviance": kept(self.deviance),
            "deviance_p": kept(self.deviance_p),
            "threshold": threshold_dict(self.thresholds[0], self.verdicts[0]),
            "interval_method": self.interval_method,
            "verdict": self.verdict,
        } | ({"note": self.note} if self.note else {})


def threshold_dict(threshold: Threshold, verdict: str, signed: bool = False) -> dict[str, Any]:
    """A threshold as JSON; None for what is denied, or lies beyond the levels shown.

    Of an end beyond them the key `low_reason` or `high_reason` says so: “beyond −8”, with its sign
    either way where levels are `signed`.
    """
    numbers = {"value": threshold.value, "low": threshold.low, "high": threshold.high}
    beyond = {"low": threshold.beyond_low, "high": threshold.beyond_high}
    told: dict[str, Any] = {"at": threshold.at}
    for name, value in numbers.items():
        known = verdict == "ok" and np.isfinite(value) and beyond.get(name) is None
        told[name] = float(value) if known else None
    for name, level in beyond.items():
        if verdict == "ok" and level is not None:
            shown = f"{level:+.10g}" if signed else f"{level:.10g}"
            told[f"{name}_reason"] = f"beyond {shown.replace('-', '−')}, the last level shown"
    return told


def summarise(
    data: Counts | PeopleCounts,
    what: Setting,
    at: tuple[float, ...] = (0.75,),
    *,
    interval: str = "profile",
    samples: int = SAMPLES,
    rng: np.random.Generator | None = None,
) -> Summary:
    """Fit `data` and say everything about it; the first of `at` decides the main verdict.

    `interval` is a key of INTERVALS ("people" needs PeopleCounts); `samples` sets the bootstrap
    and the simulated p of the deviance (0: neither).
    """
    rng = np.random.default_rng(0) if rng is None else rng
    pooled = data.pooled() if isinstance(data, PeopleCounts) else data
    fits = fit(pooled, what)
    table = (pooled.levels, fits, pooled.correct[None], pooled.total[None], at)
    if interval == "profile" or not samples:
        return _summaries(*table, samples, rng)[0]
    if interval == "parametric":
        # The sets that give the interval give the p of the deviance as well.
        plain = _summaries(*table, 0, rng)[0]
        again, lost = _refit_parametric(fits, table[3], samples, rng)
        plain = replace(plain, deviance_p=_share_beyond(lost, np.array([plain.deviance]))[0])
    else:
        plain = _summaries(*table, samples, rng)[0]
        again = _refit(data, pooled, fits, interval, samples, rng)
    thresholds = tuple(
        replace(each, low=low, high=high)
        for each in plain.thresholds
        for low, high in [percentile_interval(again.threshold(each.at), INTERVAL)]
    )
    method = f"{INTERVALS[interval]}, {samples} samples"
    return replace(plain, thresholds=thresholds, interval_method=method)


def summarise_each(
    data: PeopleCounts,
    what: Setting,
    at: tuple[float, ...] = (0.75,),
    *,
    samples: int = SAMPLES,
    rng: np.random.Generator | None = None,
) -> list[Summary]:
    """Each person's own fit with profile-likelihood intervals, all in one batch."""
    rng = np.random.default_rng(0) if rng is None else rng
    fits = fit_batch(data.levels, data.correct, data.total, what)
    return _summaries(data.levels, fits, data.correct, data.total, at, samples, rng)


def _summaries(
    levels: Array,
    fits: Batch,
    correct: Array,
    total: Array,
    at: tuple[float, ...],
    samples: int,
    rng: np.random.Generator,
) -> list[Summary]:
    lost, bounded = deviance(fits, correct, total), at_lapse_bound(fits)
    judged = [judge(levels, fits, correct, total, each) for each in at]
    found = [fits.threshold(each) for each in at]
    p = deviance_p(fits, total, lost, samples, rng) if samples else None
    return [
        Summary(
            function=fits.setting.function.name,
            location=float(fits.location[row]),
            slope=float(fits.slope[row]),
            guess=fits.setting.guess,
            lapse=float(fits.lapse[row]),
            log_likelihood=float(fits.value[row]),
            deviance=float(lost[row]),
            deviance_p=None if p is None else float(p[row]),
            thresholds=tuple(
                Threshold(
                    each,
                    float(value[row]),
                    float(low[row]),
                    float(high[row]),
                    float(levels[total[row] > 0].min()),
                    float(levels[total[row] > 0].max()),
                )
                for each, value, (_, low, high) in zip(at, found, judged, strict=True)
            ),
            interval_method=INTERVALS["profile"],
            verdicts=tuple(
                verdict_words(int(verdict[row]), fits.setting, levels, correct[row], total[row])
                for verdict, _, _ in judged
            ),
            trials=int(total[row].sum()),
            lapse_bound=fits.setting.lapse_bound if bounded[row] else None,
        )
        for row in range(len(total))
    ]


def _refit(
    data: Counts | PeopleCounts,
    pooled: Counts,
    fits: Batch,
    interval: str,
    samples: int,
    rng: np.random.Generator,
) -> Batch:
    if isinstance(data, PeopleCounts) and interval == "people":
        correct, total = resample_people(data, samples, rng)
    else:
        correct, total = resample_trials(pooled, samples, rng)
    return fit_batch(pooled.levels, correct, total, fits.setting, tolerance=ROUGH)


def _refit_parametric(
    fits: Batch, total: Array, samples: int, rng: np.random.Generator
) -> tuple[Batch, Array]:
    """Fits of `samples` sets drawn from each of B fits, and their deviances (B, samples)."""
    correct, drawn = resample_parametric(fits, total, samples, rng)
    scale, function = fits.scale, fits.setting.function
    levels = function.untransform(scale.centre + scale.half * scale.z)
    again = fit_batch(levels, correct, drawn, fits.setting, tolerance=ROUGH)
    return again, deviance(again, correct, drawn).reshape(len(total), samples)


def deviance_p(
    fits: Batch, total: Array, observed: Array, samples: int, rng: np.random.Generator
) -> Array:
    """Share (B,) of sets simulated from each fit whose own deviance is at least the observed.

    The χ² approximation does not hold for few trials a level (Wichmann and Hill 2001, part I).
    """
    return _share_beyond(_refit_parametric(fits, total, samples, rng)[1], observed)


def _share_beyond(simulated: Array, observed: Array) -> Array:
    """The simulated p (B,): the observed set counts as one of them."""
    beyond = (simulated >= observed[:, None] - 1e-9).sum(1)
    return (1.0 + beyond) / (1 + simulated.shape[1])
