"""Text of tables as spreadsheets and laboratories write them: encodings, separators, numbers.

Excel of half of Europe separates by semicolons and says so in a first line `sep=;`, writes rows
of separators for cells once touched, and saves “Unicode text” in UTF-16; people paste the minus
sign of typesetters. All of that is read for what it means.
"""

import re

SEPARATORS = ",;\t"
_MINUS = "−"
_MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:,\d{3})+(?:\.\d*)?")
_COMMA = re.compile(r"[-+]?\d*,\d+")


def decoded(data: bytes, errors: str = "strict") -> str:
    """Bytes in UTF-8 or UTF-16, with or without a mark; UnicodeDecodeError for neither."""
    for mark, encoding in _MARKS.items():
        if data.startswith(mark):
            return data.decode(encoding, errors)
    if b"\0" in data[:200]:
        # In a table's header every other byte of UTF-16 is zero: which ones tells the order.
        even = data[:200:2].count(0) > data[1:200:2].count(0)
        return data.decode("utf-16-be" if even else "utf-16-le", errors)
    return data.decode("utf-8", errors)


def told_separator(line: str) -> str | None:
    """The separator that a first line `sep=;` names; None for any other line."""
    found = re.fullmatch(r"\s*\"?sep=(.)\"?\s*", line.rstrip("\r\n"), re.IGNORECASE)
    return found[1] if found and found[1] in SEPARATORS else None


def separator_of(header: str, otherwise: str = ",") -> str:
    """The separator that a header has most of; `otherwise` where it has none."""
    most = max(otherwise + SEPARATORS, key=header.count)
    return most if header.count(most) else otherwise


def is_blank(cells: list[str]) -> bool:
    """Whether a row holds nothing but separators."""
    return not any(cell.strip() for cell in cells)


def plain_minus(text: str) -> str:
    """The typesetter's minus sign as the keyboard's."""
    return text.replace(_MINUS, "-")


def is_thousands(text: str) -> bool:
    """Whether commas in a number stand where thousands are separated: 1,000."""
    return bool(_THOUSANDS.fullmatch(text.strip()))


def is_comma_number(text: str) -> bool:
    """Whether a number has one comma, which may be a decimal one: 0,5 or 1,000."""
    return bool(_COMMA.fullmatch(text.strip()))


def renamed(header: list[str], columns: dict[str, str]) -> list[str]:
    """The header with its own names replaced: `columns` says which of them each name stands for.

    Raises KeyError with the names that the header lacks.
    """
    missing = [own for own in columns.values() if own not in header]
    if missing:
        raise KeyError(", ".join(missing))
    names = {own: name for name, own in columns.items()}
    # A column that already has a name which another now stands for is set aside under another.
    aside = {name: f"{name} (as it was)" for name in columns if name not in names}
    return [names.get(name, aside.get(name, name)) for name in header]


def columns_from(text: str | None) -> dict[str, str]:
    """The value of `--columns`, `participant=subj,level=stim`: our names and the table's.

    Raises ValueError for what is no such list.
    """
    pairs = [part.partition("=") for part in text.split(",")] if text else []
    if not all(name.strip() and own.strip() for name, _, own in pairs):
        raise ValueError(text)
    return {name.strip(): own.strip() for name, _, own in pairs}
