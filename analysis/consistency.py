"""Rows that contradict themselves: what was answered against what is said of the answer.

A column that can be worked out from others is held against them. Where the rest of the row
decides which of the two is wrong the column is worked out anew; where it does not, the rows are
not used until someone mends them. Either is said, person by person, with the rows.
"""

from collections.abc import Callable, Iterable

import pandas as pd

from analysis.rows import (
    CHOICE_WORDS,
    chosen_by_response,
    correct_of_response,
    difference_of_lengths,
)

MILLISECONDS = 50.0  # seconds: no median answer takes as long, so that such times are milliseconds
UNUSED = "they are not used until that is mended"

# A check mends the rows that it can, drops those that it cannot, and tells of both.
Check = Callable[[pd.DataFrame, str], tuple[pd.DataFrame, list[str]]]


def line_ranges(lines: Iterable[int]) -> str:
    """Line numbers in words: `rows 2 to 25 and 31`."""
    spans: list[list[int]] = []
    for line in sorted(lines):
        if spans and line == spans[-1][1] + 1:
            spans[-1][1] = line
        else:
            spans.append([line, line])
    parts = [f"{a}" if a == b else f"{a} to {b}" for a, b in spans]
    shown = parts if len(parts) <= 12 else [*parts[:11], f"{len(parts) - 11} more stretches"]
    listed = f"{', '.join(shown[:-1])} and {shown[-1]}" if len(shown) > 1 else "".join(shown)
    return f"{'row' if len(spans) == 1 and spans[0][0] == spans[0][1] else 'rows'} {listed}"


def consistent(
    task: str, trials: pd.DataFrame, where: str, person: str
) -> tuple[pd.DataFrame, list[str]]:
    """Typed rows of one table whose answers agree with themselves, and what was said of the rest.

    `person` is whose table it is where no column says so.
    """
    told: list[str] = []
    named = "participant" in trials
    table = trials if named else trials.assign(participant=person)
    for check in CHECKS.get(task, ()):
        table, found = check(table, where)
        told += found
    table, found = _times(table, where)
    return (table if named else table.drop(columns="participant")), told + found


def _by_person(rows: pd.DataFrame, where: str, what: str, done: str) -> list[str]:
    """One line a person: where, whose, which rows, what is wrong with them, what is done."""
    if len(rows) == 0:
        return []
    return [
        f"{where}: {person}, {line_ranges(part.index)} ({len(part)}): {what}; {done}"
        for person, part in rows.groupby(rows["participant"].astype(str), sort=True)
    ]


def _correct(table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    if not {"response", "odd_pair", "correct"} <= set(table):
        return table, []
    worked = correct_of_response(table)
    if "phase" in table:  # what is right in a catch trial is its script's to say
        worked = worked.where(table["phase"] != "catch")
    wrong = worked.notna() & table["correct"].notna() & (worked != table["correct"])
    what = "correct is not what response and odd_pair say"
    return table[~wrong], _by_person(table[wrong], where, what, UNUSED)


def _difference(table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    """The side named by `track` decides between the difference and the lengths."""
    if not {"length", "reference_length", "difference"} <= set(table):
        return table, []
    worked = difference_of_lengths(table)
    wrong = worked.notna() & ((worked - table["difference"]).abs() > 1e-6)
    if not wrong.any():
        return table, []
    side = worked.map(lambda d: "shorter" if d < 0 else "longer")
    track = table["track"] if "track" in table else pd.Series(None, table.index, dtype=object)
    mirrored = (worked + table["difference"]).abs() <= 1e-6
    decided = wrong & (worked != 0) & (track == side) & mirrored
    told = _by_person(
        table[decided],
        where,
        "difference is not length − reference_length, which the track agrees with",
        "it is worked out anew from the lengths",
    )
    told += _by_person(
        table[wrong & ~decided], where, "difference is not length − reference_length", UNUSED
    )
    mended = table.assign(difference=table["difference"].where(~decided, worked))
    return mended[~(wrong & ~decided)], told


def _track(table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    """A side that is not that of the difference."""
    if not {"track", "difference"} <= set(table):
        return table, []
    known = table["track"].isin(["shorter", "longer"])
    wrong = known & ((table["difference"] < 0) != (table["track"] == "shorter"))
    what = "track is not the side that difference says"
    return table[~wrong], _by_person(table[wrong], where, what, UNUSED)


def _chosen(table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    if not {"response", "chosen_method"} <= set(table):
        return table, []
    worked = chosen_by_response(table)
    wrong = worked.notna() & table["chosen_method"].notna() & (worked != table["chosen_method"])
    what = "chosen_method is not the method that response says"
    return table[~wrong], _by_person(table[wrong], where, what, UNUSED)


def _answers(table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    """Answers that are no choice: ties, which count as such, and words that say nothing."""
    told = _by_person(
        table[table["tie"]],
        where,
        "answers of another kind than first and second, which call the two equal",
        "they are counted as ties",
    )
    if "response" in table:
        given = table["response"].dropna().astype(str).str.lower()
        odd = given.index[~given.isin(CHOICE_WORDS)]
        other = table.loc[odd]
        other = other[other["chosen_method"].isna() & ~other["tie"]]
        told += _by_person(
            other, where, "response is neither first, second nor a tie", "they count as no answer"
        )
    return table, told


CHECKS: dict[str, tuple[Check, ...]] = {
    "odd-pair": (_correct, _difference, _track),
    "preference": (_chosen, _answers),
}


def _times(table: pd.DataFrame, where: str) -> tuple[pd.DataFrame, list[str]]:
    """Response times below 0 are no times; those that can only be milliseconds are read so."""
    if "response_time" not in table:
        return table, []
    times = table["response_time"].astype(float)
    negative = times < 0
    told = _by_person(
        table[negative],
        where,
        "response_time is negative",
        "the times are not used, the answers are",
    )
    times = times.where(~negative)
    if not times.max() > MILLISECONDS:
        return table.assign(response_time=times), told
    medians = times.groupby(table["participant"].astype(str)).transform("median")
    slow = (medians > MILLISECONDS) & times.notna()
    told += _by_person(
        table[slow],
        where,
        "response_time can only be milliseconds (the median is above 50 s)",
        "it is read as such",
    )
    return table.assign(response_time=times.where(~slow, times / 1000)), told
