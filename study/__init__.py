"""The study: protocols, trial order, staircases, observers, the record, the session, the screen."""
