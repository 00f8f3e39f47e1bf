#!/usr/bin/env bash
# The re module of Python 3.11.2 (Debian 12's own) takes an optional possessive group for matched
# when it failed half-way: a pattern of decimal numbers with an optional exponent then accepts `1e`
# whole, which a reader of motion files or tables hands on to float. Later 3.11 and 3.12 refuse it.
# Runs on whichever Python 3.11 or later is called python3; says which behaviour it has.
set -euo pipefail
python3 - <<'PY'
import re, sys

number = r"[+-]?(?:\d++(?:\.\d*+)?+|\.\d++)(?:[eE][+-]?\d++)?+"
plain = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
words = ("1e5", "1e", "0.e", "12")
possessive = [bool(re.fullmatch(number, word)) for word in words]
greedy = [bool(re.fullmatch(plain, word)) for word in words]
print("python", sys.version.split()[0])
print("words     ", *words)
print("possessive", *possessive)
print("greedy    ", *greedy)
assert greedy == [True, False, False, True]
if sys.version_info[:3] == (3, 11, 2):
    assert possessive == [True, True, True, True], possessive
else:
    assert possessive == greedy, possessive
PY
echo "as found"
