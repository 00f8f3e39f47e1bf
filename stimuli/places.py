"""Where in the text of a TOML file a key stands, so that a fault can name its line."""

import re


def find_line(text: str, path: tuple[str | int, ...]) -> int | None:
    """The 1-based line where the deepest key of `path` stands, or None."""
    lines = text.splitlines()
    start, end, rest = _own_table(lines, path)
    found = start if len(rest) < len(path) else None  # the line of the table's header
    for part in rest:
        place = _item(lines, start, end, part) if isinstance(part, int) else None
        if isinstance(part, str):
            key = re.compile(rf"""(^|[\s,{{.])["']?{re.escape(part)}["']?\s*[=.]""")
            at = (n for n in range(start, end) if key.search(_bare(lines[n])))
            place = next(at, None)
        if place is None:
            break
        start, found = place, place + 1
        end = min(end, _closed(lines, start, end))
    return found


def _own_table(
    lines: list[str], path: tuple[str | int, ...]
) -> tuple[int, int, tuple[str | int, ...]]:
    """The lines [start, end) of the deepest table of `path` that has a header; the keys below."""
    upto = next((n for n, part in enumerate(path) if isinstance(part, int)), len(path))
    for depth in range(upto, 0, -1):
        names = r"\s*\.\s*".join(re.escape(str(part)) for part in path[:depth])
        header = re.compile(rf"\s*\[+\s*{names}\s*\]")
        headers = [n for n, line in enumerate(lines) if header.match(line)]
        number = next(iter(path[depth:]), None)
        of_array = isinstance(number, int) and any("[[" in lines[n] for n in headers)
        if isinstance(number, int) and of_array and number < len(headers):
            headers, depth = headers[number:], depth + 1
        if headers:
            at = headers[0]
            following = (n for n in range(at + 1, len(lines)) if lines[n].lstrip().startswith("["))
            return at + 1, next(following, len(lines)), path[depth:]
    top = next((n for n, line in enumerate(lines) if line.startswith("[")), len(lines))
    return 0, top, path


def _bare(line: str) -> str:
    return line.split("#")[0]


def _closed(lines: list[str], start: int, end: int) -> int:
    """The line after the one where the brackets opened in line `start` are closed."""
    depth = 0
    for n in range(start, end):
        depth += sum({"{": 1, "[": 1, "}": -1, "]": -1}.get(c, 0) for c in _bare(lines[n]))
        if depth <= 0:
            return n + 1
    return end


def _item(lines: list[str], start: int, end: int, number: int) -> int | None:
    """The line where inline table `number` of an array begins; None where there are no such."""
    begins = [n for n in range(start, end) for c in _bare(lines[n]) if c == "{"]
    return begins[number] if number < len(begins) else None
