"""Motion in, clips out: captured motions, the transitions between them and their rendering.

Knows nothing of studies or of people. `stimuli.motion` reads motions, `stimuli.transition` joins
them, `stimuli.render` draws them, `stimuli.sets` makes a set of clips with its manifest.
"""
