"""The report: from studies to one page, one JSON document, tables and figures.

Each task has a part that turns screened trials into sections; `write` puts them together.
"""

from analysis.report.write import Written, write_report

__all__ = ["Written", "write_report"]
