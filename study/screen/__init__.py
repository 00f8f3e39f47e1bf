"""The real stage: PsychoPy's window and keyboard, clips shown frame by frame by index.

Only this package imports PsychoPy, and only when a window is opened.
"""
