#version 300 es
// Light from above the left shoulder, sky and ground, a soft highlight; rims are darker, distant
// parts fade.
precision highp float;

in vec3 normal;
in vec3 place;
in float value;
flat in int colour;

uniform vec3 eye;          // position; in a parallel view, far away along its direction
uniform vec3 light;        // unit vector towards the light
uniform vec2 depths;       // distances from the eye where fading begins and ends, m
uniform vec3 haze;
uniform int mode;          // 0: colour of the rod; 1: value
uniform vec2 range;        // value on the colour bar = range.x + range.y · value of the texture
uniform vec3 palette[7];
uniform sampler2D bar;

out vec4 fragment;

vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }

void main() {
  vec3 n = normalize(normal), towards = normalize(eye - place);
  float position = clamp(range.x + range.y * value, 0.0, 1.0);
  vec3 base = linear(mode == 0 ? palette[colour % 7] : texture(bar, vec2((position * 255.0 + 0.5) / 256.0, 0.5)).rgb);
  float facing = max(dot(n, towards), 0.0);
  float diffuse = max(dot(n, light), 0.0);
  float sky = 0.5 + 0.5 * n.z;
  vec3 halfway = normalize(light + towards);
  float shine = pow(max(dot(n, halfway), 0.0), 48.0);
  vec3 shade = base * (0.26 + 0.16 * sky + 0.68 * diffuse) * mix(0.5, 1.0, smoothstep(0.0, 0.55, facing));
  shade += 0.2 * shine;
  float far = clamp((distance(eye, place) - depths.x) / (depths.y - depths.x), 0.0, 1.0);
  shade = mix(shade, linear(haze), (mode == 0 ? 0.4 : 0.2) * far);
  fragment = vec4(pow(shade, vec3(1.0 / 2.2)), 1.0);
}
