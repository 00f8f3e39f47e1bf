"""What a report is made of: sections of sentences, figures and tables."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import pandas as pd


@dataclass(frozen=True)
class Figure:
    """A drawing as SVG text; `name` is its file's stem."""

    name: str
    caption: str
    svg: str


@dataclass(frozen=True, eq=False)
class ReportTable:
    """A table as printed (`shown`, text cells) and as numbers (`data`, written as CSV)."""

    name: str
    caption: str
    data: pd.DataFrame
    shown: pd.DataFrame
    note: str = ""

    @cached_property
    def wordy(self) -> set[str]:
        """Columns of words, set flush left; numbers are set flush right."""
        return {
            str(column)
            for column in self.shown
            if "interval" not in str(column)  # "−8.1 to −6.9" is two numbers, kept on one line
            and any(any(c.isalpha() for c in str(cell)) for cell in self.shown[column])
        }


@dataclass(frozen=True, eq=False)
class Section:
    """A titled part of a study's report; `findings` are sentences ready to paste."""

    title: str
    text: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    tables: tuple[ReportTable, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()
    items: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Findings:
    """What the analysis of one task gives: its sections and its keys of report.json."""

    sections: tuple[Section, ...]
    document: dict[str, Any] = field(default_factory=dict)

    @property
    def sentences(self) -> list[str]:
        return [sentence for section in self.sections for sentence in section.findings]
