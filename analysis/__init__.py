"""From recorded files to statistics: the record as a table, tests, fits and the report."""
