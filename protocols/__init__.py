"""Study definitions as data: one TOML file describes a study whole."""
