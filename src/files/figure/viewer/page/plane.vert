#version 300 es
// A square patch of a plane, far larger than the scene; the fragment shader fades it out.
precision highp float;

uniform mat4 projection;
uniform vec3 centre;
uniform vec3 across[2];    // unit vectors in the plane
uniform float size;        // m

out vec2 place;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  place = corner * size;
  gl_Position = projection * vec4(centre + place.x * across[0] + place.y * across[1], 1.0);
}
