"""What every study's report says besides its results: who, what was left out, how it was shown."""

from collections import Counter

import numpy as np
import pandas as pd

from analysis.report.context import Context
from analysis.report.draw import LONGER, canvas, plain_ticks
from analysis.report.parts import Figure, ReportTable, Section
from analysis.report.words import count, listing, rounded

MOST_LATE = 20  # late frames with a bar of their own
LINEAR_UP_TO = 10  # trials; above, the axis is logarithmic
_MOST_FAULTS = 20  # malformed rows named on the page; report.json names them all


def people_section(context: Context) -> Section:
    """Who took part, from participants.tsv where it was filled in."""
    table = context.study.participants
    recorded = len(context.screened.people) + len(context.screened.left_out)
    sessions = context.study.sessions
    unfinished = sum(session.sidecar.get("Finished") is False for session in sessions)
    observers = Counter(str(s.sidecar.get("Observer", "not recorded")) for s in sessions)
    text = [
        f"{count(recorded, 'person', 'people')} took part in {count(len(sessions), 'session')} "
        f"({listing([f'{n} {kind}' for kind, n in observers.items()])}"
        + (f"; {unfinished} unfinished" if unfinished else "")
        + ")."
    ]
    if context.screened.left_out:
        why = "; ".join(f"{person}: {reason}" for person, reason in context.screened.left_out)
        text.append(
            f"The answers of {len(context.screened.people)} are analysed; left out are "
            f"{count(len(context.screened.left_out), 'person', 'people')} ({why})."
        )
    if "age" in table:
        ages = pd.to_numeric(table["age"], errors="coerce").dropna()
        if len(ages):
            spread = f", SD = {rounded(ages.std(), 1)}" if len(ages) > 1 else ""
            text.append(
                f"Age was given by {len(ages)}: {ages.min():g} to {ages.max():g} years "
                f"(M = {rounded(ages.mean(), 1)}{spread})."
            )
    for column, words in (
        ("sex", "Sex"),
        ("vision", "Normal or corrected vision"),
        ("naive", "Naïve to the purpose"),
        ("animation_experience", "Animation experience"),
    ):
        if column in table:
            told = Counter(str(v) for v in table[column] if str(v) not in ("", "n/a"))
            if told:
                text.append(f"{words}: {listing([f'{v} {n}' for v, n in told.most_common()])}.")
    return Section("Who took part", text=(" ".join(text),), items=_comments(table))


def _comments(table: pd.DataFrame) -> tuple[str, ...]:
    """Free comments after the session, as they were written."""
    if not {"comments", "participant_id"} <= set(table):
        return ()
    written = table[~table["comments"].isin(["", "n/a"])]
    return tuple(
        f"{person}: “{comment}”"
        for person, comment in zip(written["participant_id"], written["comments"], strict=True)
    )


def exclusion_section(context: Context) -> Section:
    """What was left out, rule by rule, stated before the data."""
    items = []
    if context.screened.practice:
        items.append(f"{count(context.screened.practice, 'practice trial')}, by design.")
    if len(context.screened.catch):
        items.append(f"{count(len(context.screened.catch), 'catch trial')}, by design.")
    for exclusion in context.screened.exclusions:
        who = f" ({listing(exclusion.participants)})" if exclusion.participants else ""
        items.append(f"{exclusion.rule}: {count(exclusion.trials, 'trial')}{who}.")
    apart = Counter(session.kept_apart for session in context.study.set_aside)
    items += [
        f"{count(n, f'{kind} session')}, never pooled with others." for kind, n in apart.items()
    ]
    items.extend(context.study.remarks)
    faults = context.study.faults
    items.extend(faults[:_MOST_FAULTS])
    if len(faults) > _MOST_FAULTS:
        items.append(f"… and {len(faults) - _MOST_FAULTS} more, all named in report.json.")
    return Section("Left out, by rules stated before the data", items=tuple(items))


def timing_section(context: Context) -> Section:
    """How the frames were shown: late frames and void trials of sessions that had a window."""
    trials, text = context.study.trials, []
    windowless = [n for n, s in enumerate(context.study.sessions) if s.windowless]
    if windowless:
        trials = trials[~trials["session"].isin(windowless)]
        every = len(windowless) == len(context.study.sessions)
        who = "All sessions" if every else count(len(windowless), "session")
        text.append(f"{who} ran without a window: no frames were shown"
                    + ("." if every else ", and what follows leaves them out."))  # fmt: skip
        if every:
            return Section("Frame timing", text=tuple(text))
    if "late_frames" not in trials or trials["late_frames"].notna().sum() == 0:
        text.append("The records hold no frame timing.")
        return Section("Frame timing", text=(" ".join(text),))
    late = trials["late_frames"].dropna().astype(float)
    text.append(_late_sentence(trials, late))
    times = (
        trials["response_time"].dropna().astype(float) if "response_time" in trials else late[:0]
    )
    if len(times):
        text.append(
            f"The median answer came {rounded(times.median())} s after the last frame "
            f"(middle half {rounded(times.quantile(0.25))} to {rounded(times.quantile(0.75))} s)."
        )
    if late.max() == 0:
        return Section("Frame timing", text=(" ".join(text),))
    return Section(
        "Frame timing",
        text=(" ".join(text),),
        figures=(_late_figure(context.stem, late),),
        tables=(_late_table(context.stem, trials),),
    )


def _late_sentence(trials: pd.DataFrame, late: pd.Series) -> str:
    on_time = int((late == 0).sum())
    void = int((trials["void"].fillna(0) == 1).sum()) if "void" in trials else 0
    return (
        f"{on_time} of {count(len(late), 'trial')} {'was' if on_time == 1 else 'were'} shown "
        "without a late frame; "
        f"the worst had {late.max():.0f}, and {count(void, 'trial')} "
        f"{'was' if void == 1 else 'were'} void."
    )


def _late_table(stem: str, trials: pd.DataFrame) -> ReportTable:
    by_person = trials.groupby(trials["participant"].astype(str))["late_frames"]
    data = pd.DataFrame(
        {"trials": by_person.size(), "late": by_person.sum(), "worst": by_person.max()}
    ).reset_index(names="participant")
    counts = data.assign(**{name: data[name].map(_whole) for name in ("trials", "late", "worst")})
    return ReportTable(f"{stem}-timing", "Late frames by person.", data, counts)


def _whole(value: float) -> str:
    """A count; a dash where none was recorded."""
    return rounded(value, 0)


def _late_figure(stem: str, late: pd.Series) -> Figure:
    values, trials = np.unique(np.minimum(late.to_numpy(), MOST_LATE), return_counts=True)
    with canvas(7.2, 2.2) as drawn:
        axis = drawn.figure.subplots()
        axis.bar(values, trials, color=LONGER, width=0.8)
        axis.set_yscale("symlog", linthresh=LINEAR_UP_TO)
        plain_ticks(axis.yaxis, _round_counts(int(trials.max())))
        plain_ticks(axis.xaxis, range(0, MOST_LATE + 1, 5) if values.max() > 5 else range(6))
        axis.set_xlabel(f"late frames in a trial ({MOST_LATE}: {MOST_LATE} or more)")
        axis.set_ylabel("trials")
    return Figure(f"{stem}-timing", "Late frames a trial.", drawn.svg)


def _round_counts(most: int) -> list[int]:
    """Round numbers of trials from 0 up to `most`, few enough for an axis."""
    if most <= LINEAR_UP_TO // 2:
        return list(range(most + 1))
    steps = [step * 10**power for power in range(1, 7) for step in (1, 2, 5)]
    return [0, 5, *(step for step in steps if step <= most)]
