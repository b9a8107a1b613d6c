#version 300 es
// A tube of true radius, or a strip of true width, around the Catmull–Rom spline through the nodes
// of a rod; an instance is a segment. Positions come from textures of the two outputs around the
// time shown.
precision highp float;
precision highp int;
precision highp usampler2D;

in vec3 ring;       // along the segment 0…1, on the round ends −1…1, angle around the axis
in ivec4 nodes;     // before, start, end, after; repeats the neighbour at the end of a rod
in vec2 rod;        // radius at the start in m, colour index
in vec2 strip;      // half width and half thickness in m; for a tube zero and the radius at the end
in vec3 tangentAtStart, acrossAtStart, tangentAtEnd, acrossAtEnd;   // of the segment of a strip as placed

uniform usampler2D positions[2];
uniform sampler2D values[2];
uniform float blend;
uniform vec3 lower;
uniform vec3 level;
uniform mat4 projection;

out vec3 normal;
out vec3 place;
out float value;
flat out int colour;

ivec2 texel(int node) {
  return ivec2(node & 1023, node >> 10);
}

vec3 at(int node) {
  ivec2 where = texel(node);
  vec3 before = vec3(texelFetch(positions[0], where, 0).xyz);
  vec3 after = vec3(texelFetch(positions[1], where, 0).xyz);
  return lower + level * mix(before, after, blend);
}

float valueAt(int node) {
  ivec2 where = texel(node);
  return mix(texelFetch(values[0], where, 0).r, texelFetch(values[1], where, 0).r, blend);
}

// A vector normal to a tangent, after the smallest rotation to another tangent.
vec3 turned(vec3 vector, vec3 from, vec3 to) {
  float along = dot(from, to);
  vec3 axis = cross(from, to);
  vec3 result = along < -0.9999 ? vector : vector * along + cross(axis, vector) + axis * (dot(axis, vector) / (1.0 + along));
  return normalize(result - to * dot(to, result));
}

void main() {
  vec3 a = at(nodes.y), b = at(nodes.z), chord = b - a;
  bool starts = nodes.x == nodes.y, ends = nodes.z == nodes.w;
  vec3 leaving = starts ? chord : 0.5 * (b - at(nodes.x));
  vec3 arriving = ends ? chord : 0.5 * (at(nodes.w) - a);

  float s = ring.x, r = 1.0 - s;
  vec3 centre = r * r * (1.0 + 2.0 * s) * a + s * s * (3.0 - 2.0 * s) * b
    + s * r * (r * leaving - s * arriving);
  vec3 tangent = normalize(6.0 * s * r * chord + r * (1.0 - 3.0 * s) * leaving + s * (3.0 * s - 2.0) * arriving);

  float cap = (ring.y < 0.0 && !starts) || (ring.y > 0.0 && !ends) ? 0.0 : 1.5707963 * ring.y;
  vec2 around = vec2(cos(ring.z), sin(ring.z));
  if (strip.x > 0.0) {
    vec3 across = turned(normalize(mix(acrossAtStart, acrossAtEnd, s)), normalize(mix(tangentAtStart, tangentAtEnd, s)), tangent);
    vec3 second = cross(tangent, across);
    // Convert a circle to a square, whose corners are at an eighth of a turn; ends are flat.
    vec2 square = around / max(abs(around.x), abs(around.y));
    place = centre + cos(cap) * (strip.x * square.x * across + strip.y * square.y * second);
    normal = cap != 0.0 ? sign(cap) * tangent : abs(square.y) > 0.999 ? sign(square.y) * second : sign(square.x) * across;
  } else {
    // Directions around the axis: fixed for the segment, made normal to the tangent of the ring.
    vec3 along = normalize(chord);
    vec3 aside = abs(along.z) < 0.8 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    vec3 first = normalize(aside - tangent * dot(tangent, aside));
    vec3 second = cross(tangent, first);
    normal = cos(cap) * (around.x * first + around.y * second) + sin(cap) * tangent;
    place = centre + mix(rod.x, strip.y, s) * normal;
  }
  value = mix(valueAt(nodes.y), valueAt(nodes.z), s);
  colour = int(rod.y);
  gl_Position = projection * vec4(place, 1.0);
}
