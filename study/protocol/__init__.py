"""What a study is: one TOML file, checked key by key, and the stimulus set that it asks for.

`schema` says what a file may hold, `faults` what can be wrong with it and `places` on which line,
`protocol` is one that was read, `sets` what is to be rendered for it, `rendered` whether a set
still is what the protocol says. What only one kind of study may say belongs to its task.
"""
