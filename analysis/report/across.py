"""What can only be said across studies: whether specifications share one function."""

from typing import Any

import pandas as pd

from analysis.report.context import Context
from analysis.report.parts import Section
from analysis.report.supplement_part import difference_section
from analysis.supplements import Difference, differences
from analysis.thresholds import fit_plan_of, prepared


def across(contexts: list[Context]) -> tuple[list[Difference], Section | None]:
    """Likelihood-ratio tests between the specifications of odd-pair studies in one report.

    The first study's protocol says which function is fitted. Rehearsals are left out.
    """
    kept = [
        context
        for context in contexts
        if context.study.task == "odd-pair"
        and not context.study.rehearsal
        and len(context.screened.main)
    ]
    tables = [
        prepared(context.screened.main, str(context.table("stimuli").get("specification", "")))
        for context in kept
    ]
    if len({name for table in tables for name in table["specification"]}) < 2 or len(kept) < 2:
        return [], None
    trials = pd.concat(tables, ignore_index=True)
    tests = differences(trials, fit_plan_of(kept[0].protocol).what, ("specifications",))
    return tests, difference_section(kept[0], tests, "across") if tests else None


def document_of(tests: list[Difference]) -> list[dict[str, Any]]:
    """The tests as report.json has them."""
    return [test.as_dict() for test in tests]
