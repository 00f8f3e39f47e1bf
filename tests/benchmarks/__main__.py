"""Run all benchmarks, write `bench.json` and print it as a table."""

import json
import sys
from pathlib import Path
from typing import Any

from tests.benchmarks import graphs, manifolds, motion, render, session, sets, statistics

MODULES = (motion, graphs, manifolds, statistics, render, sets, session)


def main() -> int:
    """Measure; 1 when a target is not met."""
    rows: list[dict[str, Any]] = []
    for module in MODULES:
        rows += module.rows()
    Path("bench.json").write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    print(table(rows))
    return 0 if all(row["met"] is not False for row in rows) else 1


def table(rows: list[dict[str, Any]]) -> str:
    """The rows as aligned columns."""
    head = ("name", "value", "unit", "rival", "rival value", "ratio", "target", "met")
    lines = [head, *(tuple(_cell(row[key.replace(" ", "_")]) for key in head) for row in rows)]
    widths = [max(len(line[n]) for line in lines) for n in range(len(head))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )


def _cell(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "NO"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    sys.exit(main())
