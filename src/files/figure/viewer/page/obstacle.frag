#version 300 es
// Flat, pale faces; translucent if rods behind them should be visible.
precision highp float;

in vec3 place;

uniform vec3 light;
uniform vec3 ink;
uniform float opacity;

out vec4 fragment;

void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float shade = abs(dot(normal, light));
  fragment = vec4(mix(ink, vec3(0.8, 0.83, 0.87), 0.35 + 0.6 * shade), opacity);
}
