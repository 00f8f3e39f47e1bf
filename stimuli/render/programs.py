"""What runs on the card, or in its stead: skinning, light, shadows and lines.

A skin is moved by dual quaternions (Kavan and others 2008) of its bones, as `rig.moved` does it.
Colours are interpolated at centroids: at the middle of a pixel that a triangle only touches they
would be extrapolated, and speckle the figure's outline. Lines of the grid fade over a pixel on each
side, so that one sample a pixel is enough for them.
"""

from typing import Any

from stimuli.render.light import SHADE

INFLUENCES = 6  # bones that may carry a point of a skin
SKIN_VERTEX = """#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;  // and openness
layout(location = 2) in vec3 colour;
layout(location = 3) in vec2 rim;
layout(location = 4) in vec3 weights;
layout(location = 5) in vec3 indices;
layout(location = 6) in vec3 more_weights;
layout(location = 7) in vec3 more_indices;
uniform vec4 bones[BONES];
uniform mat4 view;
uniform mat4 lens;
uniform vec3 key;
uniform vec3 fill;
uniform float lit;
uniform vec2 disc;  // radius in metres, and in metres for each metre from the camera
centroid out vec3 shown;
SHADE
void main() {
    vec4 real = vec4(0.0), dual = vec4(0.0);
    for (int k = 0; k < 3; k++) {
        int first = 2 * int(indices[k]), second = 2 * int(more_indices[k]);
        real += weights[k] * bones[first] + more_weights[k] * bones[second];
        dual += weights[k] * bones[first + 1] + more_weights[k] * bones[second + 1];
    }
    float scale = inversesqrt(dot(real, real));
    real *= scale;
    dual *= scale;
    vec3 r = real.yzw;
    vec3 shift = real.x * dual.yzw - dual.x * r + cross(r, dual.yzw);
    vec3 p = position + 2.0 * (cross(r, cross(r, position) + real.x * position) + shift);
    vec3 n = normal.xyz + 2.0 * cross(r, cross(r, normal.xyz) + real.x * normal.xyz);
    vec4 seen = view * vec4(p, 1.0);
    seen.xy += rim * (disc.x - disc.y * seen.z);
    gl_Position = lens * seen;
    shown = colour * (lit > 0.5 ? shade(n, normal.w, key, fill) : 1.0);
}
""".replace("SHADE", SHADE)
SKIN_FRAGMENT = """#version 330 core
centroid in vec3 shown;
out vec4 colour;
void main() { colour = vec4(shown, 1.0); }
"""
SHADOW_VERTEX = """#version 330 core
layout(location = 0) in vec2 corner;  // -1..1
uniform mat4 view;
uniform mat4 lens;
uniform vec4 square;  // x, floor, z, half its side
uniform vec4 part;  // of the square that is drawn: left, right, near and far side, -1..1
out vec2 place;
void main() {
    vec2 here = mix(part.xz, part.yw, 0.5 + 0.5 * corner);
    place = 0.5 + 0.5 * here;
    vec2 at = square.xz + square.w * here;
    gl_Position = lens * (view * vec4(at.x, square.y, at.y, 1.0));
}
"""
SHADOW_FRAGMENT = """#version 330 core
in vec2 place;
uniform sampler2D dark;
uniform float darkest;
out vec4 colour;
void main() { colour = vec4(0.0, 0.0, 0.0, darkest * texture(dark, place).r); }
"""
GRID_VERTEX = """#version 330 core
layout(location = 0) in vec2 at;  // metres from the grid's middle line
layout(location = 1) in vec2 way;  // of the line, as long as one
layout(location = 2) in float side;
uniform mat4 view;
uniform mat4 lens;
uniform vec3 origin;  // x, floor, z of the grid's middle, a crossing of lines
uniform vec2 middle;  // x, z where the grid is darkest
uniform vec3 fading;  // darkness; where it fades and is gone (m)
uniform vec2 half_picture;  // pixels
uniform float half_line;  // pixels
out float dark;
noperspective out float off;  // pixels from the line's middle
void main() {
    vec2 place = origin.xz + at;
    float away = distance(place, middle);
    float left = clamp((fading.z - away) / (fading.z - fading.y), 0.0, 1.0);
    dark = fading.x * left * left;
    vec4 here = lens * (view * vec4(place.x, origin.y, place.y, 1.0));
    vec2 on = place + 0.01 * way;
    vec4 there = lens * (view * vec4(on.x, origin.y, on.y, 1.0));
    vec2 along = (there.xy / there.w - here.xy / here.w) * half_picture;
    vec2 across = normalize(vec2(-along.y, along.x) + vec2(0.0, 1e-9));
    off = side * (half_line + 1.0);
    gl_Position = here + vec4(off * across / half_picture * here.w, 0.0, 0.0);
}
"""
GRID_FRAGMENT = """#version 330 core
in float dark;
noperspective in float off;
uniform float half_line;
out vec4 colour;
void main() {  // as much of a pixel as the line covers
    float covered = clamp(half_line + 0.5 - abs(off), 0.0, min(2.0 * half_line, 1.0));
    colour = vec4(0.0, 0.0, 0.0, dark * covered);
}
"""


class Program:
    """A compiled program and where its uniforms are."""

    def __init__(self, gl: Any, vertex: str, fragment: str) -> None:
        self._gl = gl
        self.name = gl.glCreateProgram()
        for kind, source in ((gl.GL_VERTEX_SHADER, vertex), (gl.GL_FRAGMENT_SHADER, fragment)):
            shader = gl.glCreateShader(kind)
            gl.glShaderSource(shader, source)
            gl.glCompileShader(shader)
            if not gl.glGetShaderiv(shader, gl.GL_COMPILE_STATUS):
                raise RuntimeError(gl.glGetShaderInfoLog(shader))
            gl.glAttachShader(self.name, shader)
        gl.glLinkProgram(self.name)
        if not gl.glGetProgramiv(self.name, gl.GL_LINK_STATUS):
            raise RuntimeError(gl.glGetProgramInfoLog(self.name))
        self._places: dict[str, int] = {}

    def use(self) -> None:
        """Draw with it from now on."""
        self._gl.glUseProgram(self.name)

    def at(self, uniform: str) -> int:
        """Where a uniform is."""
        if uniform not in self._places:
            self._places[uniform] = int(self._gl.glGetUniformLocation(self.name, uniform))
        return self._places[uniform]
