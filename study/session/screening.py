"""What a session says of who did it: catch trials against chance, practice by its criterion."""

from typing import Any

from scipy.stats import binom

from study.session.progress import Progress, practised_enough

_CHANCE, _ALPHA = 0.5, 0.05


def pass_mark(trials: int) -> int | None:
    """The fewest right answers that guessing reaches with a probability of at most _ALPHA.

    Of 10 trials 9, of 20 trials 15; None where even all right could be guessed.
    """
    marks = (n for n in range(trials + 1) if binom.sf(n - 1, trials, _CHANCE) <= _ALPHA)
    return next(marks, None)


def catch_summary(progress: Progress) -> dict[str, Any]:
    """For the sidecar: catch trials, those right, the mark, whether it was reached."""
    trials, right = progress.caught, progress.caught_right
    if not trials:
        return {}
    mark = pass_mark(trials)
    passed = None if mark is None else right >= mark
    return {"Catch": {"trials": trials, "right": right, "pass_mark": mark, "passed": passed}}


def practice_summary(progress: Progress) -> dict[str, Any]:
    """For the sidecar: whether practice reached its criterion; nothing where it has none."""
    table = progress.plan.protocol.file.trials
    if table.practice_criterion is None or not progress.practice:
        return {}
    reached = practised_enough(progress)
    return {"Practice": {"trials": len(progress.practice), "reached": reached}}
