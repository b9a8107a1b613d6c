#version 300 es
// A contact: a ring that faces the eye.
precision highp float;

in vec3 contact;           // in levels of the bounding box

uniform mat4 projection;
uniform vec3 lower;
uniform vec3 level;
uniform float diameter;    // pixels

void main() {
  gl_Position = projection * vec4(lower + level * contact, 1.0);
  gl_PointSize = diameter;
}
