// A surface of triangles, coloured by a number at each corner, with the three axes.

const SURFACE_VERTEX = `#version 300 es
precision highp float;
uniform mat4 projection;
in vec3 point;
in float value;
out vec3 place;
out float height;
void main() {
  place = point;
  height = value;
  gl_Position = projection * vec4(point, 1.0);
}`;

const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 eye;
uniform sampler2D bar;
uniform bool plain;
in vec3 place;
in float height;
out vec4 colour;
void main() {
  if (plain) { colour = vec4(0.25, 0.28, 0.31, 1.0); return; }
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.45 + 0.55 * abs(dot(normal, eye));
  colour = vec4(texture(bar, vec2(height, 0.5)).rgb * light, 1.0);
}`;

function bytesOf(id) {
  return Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0)).buffer;
}

function program(gl) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, SURFACE_VERTEX], [gl.FRAGMENT_SHADER, SURFACE_FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.bindAttribLocation(made, 0, "point");
  gl.bindAttribLocation(made, 1, "value");
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

/** Points with their numbers as a vertex array: x, y, z, value for each. */
function vertices(gl, numbers, indices) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 16, 0);
  gl.enableVertexAttribArray(1);
  gl.vertexAttribPointer(1, 1, gl.FLOAT, false, 16, 12);
  if (indices) {
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  }
  return array;
}

function showSurface() {
  const header = JSON.parse(document.getElementById("surface").textContent);
  const canvas = document.getElementById("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) {
    document.getElementById("trouble").hidden = false;
    return;
  }
  const points = new Float32Array(bytesOf("points")), triangles = new Uint32Array(bytesOf("triangles"));
  const lower = [0, 0, 0], upper = [0, 0, 0];
  for (let k = 0; k < points.length; k += 4) {
    for (let axis = 0; axis < 3; axis++) {
      lower[axis] = Math.min(lower[axis], points[k + axis]);
      upper[axis] = Math.max(upper[axis], points[k + axis]);
    }
  }
  const used = program(gl);
  const uniform = (name) => gl.getUniformLocation(used, name);
  const surface = vertices(gl, points, triangles);
  const ends = [0, 1, 2].flatMap((axis) => [lower, upper].map((end) => [0, 1, 2].map((k) => (k === axis ? 1.08 * end[k] : 0))));
  const lines = vertices(gl, new Float32Array(ends.flatMap((end) => [...end, 0])));
  const labels = ends.map((end, k) => {
    const label = document.createElement("div");
    label.className = "axis";
    label.textContent = norm(end) > 0 ? (k % 2 ? "" : "−") + header.axes[k >> 1] : "";
    document.body.append(label);
    return label;
  });
  const stops = SEQUENTIAL;
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colourBar(stops));
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  document.getElementById("bar").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  document.getElementById("quantity").textContent = header.quantity;
  document.getElementById("low").textContent = header.low.toFixed(2);
  document.getElementById("high").textContent = header.high.toFixed(2);

  const camera = new Camera();
  camera.lookFrom(unit([1, -1, 0.6]));
  let waiting = false, fitted = false;
  const draw = () => {
    waiting = false;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    const aspect = canvas.width / canvas.height;
    if (!fitted) camera.fit(lower, add(upper, lower, -1), { width: canvas.width, height: canvas.height, above: 0, below: 0 });
    fitted = true;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(used);
    const projection = camera.matrix(aspect, 5 * camera.reach + norm(camera.target));
    gl.uniformMatrix4fv(uniform("projection"), false, projection);
    gl.uniform3fv(uniform("eye"), camera.basis().eye);
    gl.uniform1i(uniform("plain"), 0);
    gl.bindVertexArray(surface);
    gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);
    gl.uniform1i(uniform("plain"), 1);
    gl.bindVertexArray(lines);
    gl.drawArrays(gl.LINES, 0, 6);
    labels.forEach((label, k) => {
      const at = [0, 1, 2, 3].map((row) => [...ends[k], 1].reduce((sum, x, column) => sum + projection[4 * column + row] * x, 0));
      label.style.left = `${50 * (1 + at[0] / at[3])}%`;
      label.style.top = `${50 * (1 - at[1] / at[3])}%`;
    });
    document.body.dataset.drawn = "yes";
  };
  const changed = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };
  watchGestures(canvas, camera, changed);
  window.addEventListener("resize", changed);
  changed();
}

showSurface();
