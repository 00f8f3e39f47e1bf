"""What a design looks like over simulated sessions: trials, minutes, balance, staircases."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from analysis.naturalness import clip_measures
from analysis.tracks import reversal_mean, stop_level, tracks

POSITION_TOLERANCE = 0.02  # metres by which a clip may start or end elsewhere than its reference
ENDS = {"displacement_before": "starts", "displacement_after": "ends"}


def range_of(values: list[float]) -> dict[str, float]:
    """Mean, least and most."""
    return {
        "mean": float(np.mean(values)),
        "least": float(np.min(values)),
        "most": float(np.max(values)),
    }


def balance(trials: pd.DataFrame) -> dict[str, Any]:
    """Shares of each order over all main trials, and the least and most within one session."""
    told = {}
    for name, first in _orders(trials).items():
        each = first.groupby(trials["participant"]).mean()
        told[name] = {
            "share": float(first.mean()),
            "least": float(each.min()),
            "most": float(each.max()),
        }
    return told


def _orders(trials: pd.DataFrame) -> dict[str, pd.Series]:
    found = {}
    if "first_method" in trials:
        for method in sorted(set(trials["first_method"].dropna())):
            found[f"{method} first"] = (trials["first_method"] == method).astype(float)
    if "odd_pair" in trials:
        found["odd pair first"] = (trials["odd_pair"] == 1).astype(float)
        found["odd clip left"] = (trials["odd_position"] == 1).astype(float)
    if "order" in trials:
        for order in sorted(set(trials["order"].dropna())):
            found[str(order)] = (trials["order"] == order).astype(float)
    return found


def convergence(
    trials: pd.DataFrame, levels: Mapping[tuple[str, str], Sequence[int]]
) -> list[dict[str, Any]]:
    """How the tracks of each motion and side ran under the protocol's stopping rule.

    `levels` are the absolute differences of a motion and side, ascending.
    """
    told = []
    kept = trials[trials["correct"].notna()]
    found = tracks(kept)
    for motion, side in sorted({(track.motion, track.side) for track in found}):
        own = [t for t in found if (t.motion, t.side) == (motion, side)]
        sign = -1.0 if side == "shorter" else 1.0
        shown = levels[motion, side]
        ends = [float(t.levels[-1]) for t in own]
        stops = [v for t in own if (v := stop_level(t.levels)) is not None]
        turns = [v for t in own if (v := reversal_mean(t.levels)) is not None]
        told.append(
            {
                "motion": motion,
                "side": side,
                "trials": range_of([float(len(t.levels)) for t in own]),
                "proportion_right": float(np.concatenate([t.correct for t in own]).mean()),
                "stop_level": sign * float(np.mean(stops)) if stops else None,
                "reversal_mean": sign * float(np.mean(turns)) if turns else None,
                "ended_at_edge": float(np.mean([end in (shown[0], shown[-1]) for end in ends])),
            }
        )
    return told


def telltale(clips: list[dict[str, Any]]) -> list[str]:
    """Warnings of clips that their start or end position alone tells from the others.

    `clips` are manifest entries; where their measures hold displacements before and after the
    blend from the reference, those beyond POSITION_TOLERANCE are named.
    """
    told = []
    for clip in clips:
        held = clip_measures(clip)
        for name, verb in ENDS.items():
            if held.get(name, 0.0) > POSITION_TOLERANCE:
                told.append(
                    f"{clip.get('motion')}, length {clip.get('length')}: the figure {verb} "
                    f"{100 * held[name]:.0f} cm from where it does in the reference, which alone "
                    "tells the clips apart"
                )
    return told
