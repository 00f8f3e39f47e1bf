"""Motion graphs (Arikan and Forsyth 2002): motions that meet demands, made of pieces of clips.

`cost` says how far two frames are apart as places to cut between, `edges` where clips may be cut to
one another, `build` puts these into a hierarchy (`graph`), which `store` keeps. `demands` reads
what is wanted, `search` looks for it at random among paths, `plan` says how well one meets it,
`assemble` makes the motion; `shortest` is the exact way from one frame to another. Loops are
compiled, in modules of their own.
"""

from stimuli.graph.aim import unmet_faults
from stimuli.graph.assemble import assembled, route_of, way_motion
from stimuli.graph.build import build_graph
from stimuli.graph.cluster import on_scheduler
from stimuli.graph.demands import Demands, read_demands
from stimuli.graph.graph import MotionGraph
from stimuli.graph.near import near_answer
from stimuli.graph.plan import MotionPlan, Stretch, motion_plan, plan_document
from stimuli.graph.plots import draw_graph, draw_plan, draw_reach
from stimuli.graph.prune import largest_part
from stimuli.graph.reach import places_reached, shares
from stimuli.graph.search import Search, begin_search
from stimuli.graph.shortest import shortest_way
from stimuli.graph.space import search_space
from stimuli.graph.store import graph_kept, graph_place, read_graph, write_graph

__all__ = [
    "Demands",
    "MotionGraph",
    "MotionPlan",
    "Search",
    "Stretch",
    "assembled",
    "begin_search",
    "build_graph",
    "draw_graph",
    "draw_plan",
    "draw_reach",
    "graph_kept",
    "graph_place",
    "largest_part",
    "motion_plan",
    "near_answer",
    "on_scheduler",
    "places_reached",
    "plan_document",
    "read_demands",
    "read_graph",
    "route_of",
    "search_space",
    "shares",
    "shortest_way",
    "unmet_faults",
    "way_motion",
    "write_graph",
]
