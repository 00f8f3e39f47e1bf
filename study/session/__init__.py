"""How a study is run: the session, its stage, one participant in the lab, many simulated.

`progress` is where a session stands, `conduct` shows, asks, records and advances on a `stage`;
`lab` finds a participant's stimuli and record, `simulation` needs neither; `duration` foretells.
"""
