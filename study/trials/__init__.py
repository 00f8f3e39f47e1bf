"""What is asked: from a protocol to trials, one after the other, as a pure function of answers.

`reading` checks a protocol with its task, `plan` makes it concrete for one participant; trials are
cards of a `deck` or levels of interleaved `tracks`, each a `staircase` whose long run `chain` knows
exactly; `tasks` turn cards into what is shown and recorded; `observers` answer in a person's place.
"""
