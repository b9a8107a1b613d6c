#version 300 es
// Flat faces, pale and half clear, so that rods behind them show.
precision highp float;

in vec3 place;

uniform vec3 light;
uniform vec3 ink;

out vec4 fragment;

void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float shade = abs(dot(normal, light));
  fragment = vec4(mix(ink, vec3(0.62, 0.66, 0.72), 0.45 + 0.5 * shade), 0.38);
}
