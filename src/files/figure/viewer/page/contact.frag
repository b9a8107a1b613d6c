#version 300 es
precision highp float;

uniform float opacity;

out vec4 fragment;

void main() {
  float r = 2.0 * length(gl_PointCoord - 0.5), soft = fwidth(r);
  float ring = smoothstep(0.55 - soft, 0.55, r) * (1.0 - smoothstep(0.9 - soft, 0.9, r));
  float rim = smoothstep(0.42 - soft, 0.42, r) * (1.0 - smoothstep(1.0 - soft, 1.0, r));
  vec3 colour = mix(vec3(1.0), vec3(0.9, 0.0, 0.49), ring);
  fragment = vec4(colour, opacity * rim);
}
