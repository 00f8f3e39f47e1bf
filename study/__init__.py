"""The study, in the order in which it comes about, each folder knowing only those before it.

`protocol` (what it is), `trials` (what is asked), `record` (what is kept), `session` (how it is
run), `screen` (what is seen), `cli` (the commands).
"""
