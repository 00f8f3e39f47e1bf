"""A set looked at before people are invited: a page in which clips play, and a picture of strips.

`gathered` has each motion's distinct pictures and what the manifest says of its clips; `page`
writes them as one HTML file that needs no network, `strips` as one PNG.
"""

from stimuli.sheet.gathered import MotionSheet, gather
from stimuli.sheet.page import write_page
from stimuli.sheet.strips import write_strips

__all__ = ["MotionSheet", "gather", "write_page", "write_strips"]
