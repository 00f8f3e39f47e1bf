"""Run all benchmarks, write `bench.json` and print it as a table.

python -m tests.benchmarks [NAME ...]    # some of them alone, printed and not written
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.benchmarks import graphs, manifolds, motion, render, session, sets, statistics

MODULES = (motion, graphs, manifolds, statistics, render, sets, session)


def main(names: Sequence[str] = ()) -> int:
    """Measure; 1 when a target is not met, 2 for a name that no benchmark has."""
    known = {module.__name__.rpartition(".")[2]: module for module in MODULES}
    if unknown := set(names) - set(known):
        print(f"{', '.join(sorted(unknown))}: expected some of {', '.join(known)}", file=sys.stderr)
        return 2
    rows: list[dict[str, Any]] = []
    for name, module in known.items():
        if name in names or not names:
            rows += module.rows()
    if not names:
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
    sys.exit(main(sys.argv[1:]))
