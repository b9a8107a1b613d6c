#version 300 es
// Grid lines of constant width on the screen, every fifth a little stronger.
precision highp float;

in vec2 place;

uniform float size;
uniform float spacing;     // of the lines, m
uniform vec2 offset;       // of the patch's centre on the grid, m
uniform vec3 ink;
uniform float fill;        // opacity between the lines; 0 for a grid without a plane

out vec4 fragment;

float lines(float apart) {
  vec2 at = (place + offset) / apart;
  vec2 width = fwidth(at);
  vec2 from = abs(fract(at - 0.5) - 0.5) / width;
  // Lines closer than a few pixels are replaced by a uniform tone.
  vec2 clear = 1.0 - smoothstep(0.2, 0.5, width);
  vec2 line = (1.0 - smoothstep(0.4, 1.1, from)) * clear;
  return max(line.x, line.y);
}

void main() {
  float fade = 1.0 - smoothstep(0.35, 1.0, length(place) / size);
  float strength = max(0.13 * lines(spacing), 0.26 * lines(5.0 * spacing));
  fragment = vec4(ink, fade * max(strength, fill));
}
