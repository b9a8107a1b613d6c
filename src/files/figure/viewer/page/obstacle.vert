#version 300 es
// The surface of a rigid body.
precision highp float;

in vec3 corner;

uniform mat4 projection;
uniform mat4 pose;

out vec3 place;

void main() {
  vec4 placed = pose * vec4(corner, 1.0);
  place = placed.xyz;
  gl_Position = projection * placed;
}
