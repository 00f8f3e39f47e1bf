"""Motion graphs (Arikan and Forsyth 2002): motions that meet demands, made of pieces of clips.

`cost` says how far two frames are apart as places to cut between, `edges` where clips may be cut to
one another, `build` puts these into a hierarchy (`graph`), which `store` keeps. `demands` reads
what is wanted, `search` looks for it at random among paths, `plan` says how well one meets it,
`assemble` makes the motion; `shortest` is the exact way from one frame to another. Loops are
compiled, in modules of their own.
"""

from stimuli.graph.aim import faults_of
from stimuli.graph.assemble import assembled, way_motion
from stimuli.graph.build import build_graph
from stimuli.graph.cluster import on_scheduler
from stimuli.graph.demands import Demands, read_demands
from stimuli.graph.graph import MotionGraph
from stimuli.graph.near import near_answer
from stimuli.graph.plan import Plan, Stretch, document_of, plan_of
from stimuli.graph.plots import draw_graph, draw_plan, draw_reach
from stimuli.graph.reach import places_reached, shares
from stimuli.graph.search import Search, begin
from stimuli.graph.shortest import shortest_way
from stimuli.graph.space import search_space
from stimuli.graph.store import graph_place, read_graph, write_graph

__all__ = [
    "Demands",
    "MotionGraph",
    "Plan",
    "Search",
    "Stretch",
    "assembled",
    "begin",
    "build_graph",
    "document_of",
    "draw_graph",
    "draw_plan",
    "draw_reach",
    "faults_of",
    "graph_place",
    "near_answer",
    "on_scheduler",
    "places_reached",
    "plan_of",
    "read_demands",
    "read_graph",
    "search_space",
    "shares",
    "shortest_way",
    "way_motion",
    "write_graph",
]
