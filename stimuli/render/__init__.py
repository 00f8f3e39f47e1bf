"""A motion drawn: the body of a skeleton, the camera that holds it, light, pictures, video files.

Built once for a skeleton: the reference pose (`reference`), its landmarks (`landmarks`), the parts
of a body between them (`parts`, `shapes`), a skin over them (`bodies`: separate parts lofted one
by one, or one closed surface of their distance field; sticks, dots) and the bones that carry it
(`rig`). `staging` chooses one camera for the clips of a group from what the figure does in them.
Drawn for each frame: the ground and the skin in one picture (`scene`, with `context`, `programs`,
`target` and `floor` for what OpenGL needs, which is imported when the first picture is drawn).
`video` writes and reads clips.
"""

from stimuli.render.appearance import Appearance
from stimuli.render.clip import group_camera, render_frames, write_clip
from stimuli.render.strip import strip, write_png
from stimuli.render.video import decode_video, write_video

__all__ = [
    "Appearance",
    "decode_video",
    "group_camera",
    "render_frames",
    "strip",
    "write_clip",
    "write_png",
    "write_video",
]
