"""Figures beside what a user would otherwise use: `make bench`.

Each module has a function `rows()` that measures Segue and its rivals in the same run on the same
data and returns medians, as `bench.json` has them. No test looks at a clock.
"""
