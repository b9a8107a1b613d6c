// Draws a case with WebGL 2. Only the nodes of two outputs are on the graphics card at a time; it
// generates the tubes.

/** Nodes in a row of a texture; the shaders use the same number. */
const ROW = 1024;
/** Bytes of an instance: four node numbers; radius, colour; half width and half thickness of a strip; its placed axes at both ends. */
const INSTANCE_BYTES = 80;
/** Components of the attributes after the node numbers. */
const ROD_PARTS = [2, 2, 3, 3, 3, 3];
/** Triangles that a modest graphics card draws smoothly. */
const TRIANGLES = 400000;
/** Number of contacts up to which rings have their full size. */
const FEW_CONTACTS = 20;

class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, premultipliedAlpha: false });
    if (!gl) throw new Error("This page needs WebGL 2, which this browser does not offer or has switched off.");
    this.gl = gl;
    this.tube = this.program("tube", ["ring", "nodes", "rod", "strip", "tangentAtStart", "acrossAtStart", "tangentAtEnd", "acrossAtEnd"]);
    this.plane = this.program("plane", []);
    this.obstacle = this.program("obstacle", ["corner"]);
    this.corners = gl.createBuffer();
    this.contact = this.program("contact", ["contact"]);
    this.bars = { sequential: this.barTexture(SEQUENTIAL), diverging: this.barTexture(DIVERGING) };
    this.palette = new Float32Array(movie.palette.flatMap((hex) => channels(hex).map((c) => c / 255)));
    this.instances = gl.createBuffer();
    this.rings = gl.createBuffer();
    this.triangles = gl.createBuffer();
    this.contacts = gl.createBuffer();
    gl.enable(gl.DEPTH_TEST);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Compiles the shaders with a name; the location of an attribute is its index. */
  program(name, attributes) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, ending] of [[gl.VERTEX_SHADER, "vert"], [gl.FRAGMENT_SHADER, "frag"]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, document.getElementById(`${name}.${ending}`).textContent.trim());
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`${name}.${ending}: ${gl.getShaderInfoLog(shader)}`);
      gl.attachShader(program, shader);
    }
    attributes.forEach((attribute, location) => gl.bindAttribLocation(program, location, attribute));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`${name}: ${gl.getProgramInfoLog(program)}`);
    const uniforms = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
      const uniform = gl.getActiveUniform(program, k).name.replace("[0]", "");
      uniforms[uniform] = gl.getUniformLocation(program, uniform);
    }
    return { program, uniforms };
  }

  barTexture(stops) {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colourBar(stops));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    return texture;
  }

  nodeTexture(format, rows) {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, ROW, rows);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return texture;
  }

  /** Prepares to draw a case. */
  show(shown) {
    const gl = this.gl;
    this.shown = shown;
    for (const texture of [...(this.positions ?? []), ...(this.values ?? [])]) gl.deleteTexture(texture);
    const rows = Math.ceil(shown.nodes / ROW);
    this.positions = [0, 1].map(() => this.nodeTexture(gl.RGB16UI, rows));
    this.values = [0, 1].map(() => this.nodeTexture(gl.R8, rows));
    this.loaded = [];
    this.makeInstances(shown);
    this.makeRings();
  }

  /** Makes an instance for each segment of a rod: four node numbers, radius at its start, colour. */
  makeInstances(shown) {
    const segments = [];
    let first = 0;
    shown.rods.forEach((rod, index) => {
      const last = first + rod.nodes - 1;
      const node = (k) => rod.closed ? first + (k + rod.nodes) % rod.nodes : Math.min(Math.max(first + k, first), last);
      for (let k = 0; k < (rod.closed ? rod.nodes : rod.nodes - 1); k++) {
        // A repeated node makes the segment straight at this end.
        const nodes = (rod.straight ? [k, k, k + 1, k + 1] : [k - 1, k, k + 1, k + 2]).map(node);
        const radius = (one) => rod.radii ? rod.radii[one - first] : rod.radius;
        // A tube has its second radius in place of the half thickness.
        const { width, thickness, placed } = rod.strip ?? { width: 0, thickness: 2 * radius(nodes[2]) };
        const lay = [nodes[1], nodes[2]].flatMap((one) => placed ? placed.slice(6 * (one - first), 6 * (one - first + 1)) : Array(6).fill(0));
        segments.push({ nodes, numbers: [radius(nodes[1]), colourOfRod(rod, index), 0.5 * width, 0.5 * thickness, ...lay] });
      }
      first += rod.nodes;
    });
    this.segments = segments.length;
    // Segments at the ends of rods occur again, for their round ends.
    const ends = segments.filter(({ nodes }) => nodes[0] === nodes[1] || nodes[2] === nodes[3]);
    this.ends = ends.length;
    const view = new DataView(new ArrayBuffer(INSTANCE_BYTES * (this.segments + this.ends)));
    [...segments, ...ends].forEach((segment, k) => {
      const at = INSTANCE_BYTES * k;
      segment.nodes.forEach((node, n) => view.setInt32(at + 4 * n, node, true));
      segment.numbers.forEach((number, n) => view.setFloat32(at + 16 + 4 * n, number, true));
    });
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, view.buffer, gl.STATIC_DRAW);
  }

  /** Makes the meshes of a segment and of its round ends, with as many and as fine rings as the number of segments allows. */
  makeRings() {
    const budget = TRIANGLES / Math.max(this.segments, 1);
    // Multiples of eight, so that strips have corners.
    const around = budget > 4000 ? 48 : budget > 400 ? 24 : budget > 160 ? 16 : 8;
    const along = Math.max(1, Math.min(6, Math.floor(budget / (2 * around))));
    const rings = [], triangles = [];
    // Rings at places (along the segment, on the round end), each joined to the previous one.
    const sleeve = (places) => places.forEach(([s, cap], row) => {
      for (let k = 0; k <= around; k++) {
        rings.push(s, cap, (2 * Math.PI * k) / around);
        if (row > 0 && k > 0) {
          const b = rings.length / 3 - 1, a = b - around - 1;
          triangles.push(a - 1, a, b, a - 1, b, b - 1);
        }
      }
    });
    sleeve(Array.from({ length: along + 1 }, (_, k) => [k / along, 0]));
    this.bodyCorners = triangles.length;
    const caps = Array.from({ length: around / 4 + 1 }, (_, k) => (4 * k) / around);
    sleeve(caps.map((cap) => [0, cap - 1]));
    sleeve(caps.map((cap) => [1, cap]));
    this.endCorners = triangles.length - this.bodyCorners;
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.rings);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(rings), gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles), gl.STATIC_DRAW);
  }

  /** Copies the numbers of all nodes at a frame into a texture. */
  upload(texture, array, frame, components, format, type) {
    const gl = this.gl, nodes = this.shown.nodes, rows = Math.floor(nodes / ROW), rest = nodes % ROW;
    const start = components * nodes * frame, full = components * ROW * rows;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    if (rows) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, rows, format, type, array.subarray(start, start + full));
    if (rest) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, rows, rest, 1, format, type, array.subarray(start + full, start + components * nodes));
  }

  /** Uploads two frames and a field to the graphics card, unless they are there already. */
  load(frames, field) {
    const gl = this.gl;
    frames.forEach((frame, side) => {
      const key = `${frame} ${field}`;
      if (this.loaded[side] === key) return;
      this.loaded[side] = key;
      this.upload(this.positions[side], this.shown.positions, frame, 3, gl.RGB_INTEGER, gl.UNSIGNED_SHORT);
      if (field >= 0) this.upload(this.values[side], this.shown.values[field], frame, 1, gl.RED, gl.UNSIGNED_BYTE);
    });
  }

  /**
   * Draws the scene. `look`: frame, next frame, blend between them, field (−1: colour of the rod), range of its
   * colour bar, ink and haze of the theme as RGB, whether contacts and grid are shown.
   */
  draw(camera, look) {
    const gl = this.gl, canvas = gl.canvas;
    const density = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth * density, canvas.clientHeight * density].map(Math.round);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    // The scene may be moved to the side, or zoomed in far.
    const centre = this.shown.lower.map((x, k) => x + 0.5 * this.shown.size[k]);
    const reach = 5 * camera.reach + norm(add(centre, camera.target, -1));
    const projection = camera.matrix(width / height, reach);
    this.load([look.frame, look.next], look.field);
    this.drawTubes(camera, projection, look);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    this.drawPlanes(camera, projection, look);
    this.drawObstacles(camera, projection, look);
    if (look.contacts) this.drawContacts(projection, look, density);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawTubes(camera, projection, look) {
    const gl = this.gl, { program, uniforms } = this.tube, shown = this.shown;
    gl.useProgram(program);
    const texture = (number, texture) => {
      gl.activeTexture(gl.TEXTURE0 + number);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    };
    const field = shown.fields[look.field];
    [...this.positions, ...this.values, this.bars[field?.signed ? "diverging" : "sequential"]]
      .forEach((one, number) => texture(number, one));
    gl.uniform1iv(uniforms.positions, [0, 1]);
    gl.uniform1iv(uniforms.values, [2, 3]);
    gl.uniform1i(uniforms.bar, 4);
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1f(uniforms.blend, look.blend);
    gl.uniform3fv(uniforms.lower, shown.lower);
    gl.uniform3fv(uniforms.level, shown.level);
    gl.uniformMatrix4fv(uniforms.projection, false, projection);
    const { right, up, eye } = camera.basis();
    gl.uniform3fv(uniforms.eye, camera.position());
    gl.uniform3fv(uniforms.light, unit(add(add(eye, up, 0.75), right, -0.55)));
    const distance = norm(add(camera.position(), camera.target, -1));
    gl.uniform2f(uniforms.depths, distance - 0.1 * camera.reach, distance + 1.6 * camera.reach);
    gl.uniform3fv(uniforms.haze, look.haze);
    gl.uniform1i(uniforms.mode, field ? 1 : 0);
    if (field) {
      const span = look.range.high - look.range.low;
      gl.uniform2f(uniforms.range, (field.low - look.range.low) / span, (field.high - field.low) / span);
    }
    gl.uniform3fv(uniforms.palette, this.palette);

    gl.bindBuffer(gl.ARRAY_BUFFER, this.rings);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
    gl.vertexAttribDivisor(0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    const locations = [1, ...ROD_PARTS.map((_, part) => part + 2)];
    for (const location of locations) {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribDivisor(location, 1);
    }
    const drawInstances = (first, count, firstCorner, corners) => {
      const at = INSTANCE_BYTES * first;
      gl.vertexAttribIPointer(1, 4, gl.INT, INSTANCE_BYTES, at);
      let offset = at + 16;
      ROD_PARTS.forEach((components, part) => {
        gl.vertexAttribPointer(part + 2, components, gl.FLOAT, false, INSTANCE_BYTES, offset);
        offset += 4 * components;
      });
      gl.drawElementsInstanced(gl.TRIANGLES, corners, gl.UNSIGNED_SHORT, 2 * firstCorner, count);
    };
    drawInstances(0, this.segments, 0, this.bodyCorners);
    if (this.ends) drawInstances(this.segments, this.ends, this.bodyCorners, this.endCorners);
    for (const location of [0, ...locations]) {
      gl.vertexAttribDivisor(location, 0);
      gl.disableVertexAttribArray(location);
    }
  }

  drawPlanes(camera, projection, look) {
    const gl = this.gl, { program, uniforms } = this.plane, shown = this.shown;
    const centre = shown.lower.map((x, k) => x + 0.5 * shown.size[k]);
    const planes = shown.planes.map((plane) => ({ ...plane, fill: 0.1 }));
    if (look.grid && !planes.length) {
      const thickest = Math.max(...shown.rods.map((rod) => rod.radius));
      planes.push({ point: [0, 0, shown.lower[2] - 1.5 * thickest], normal: [0, 0, 1], fill: 0 });
    }
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.projection, false, projection);
    gl.uniform3fv(uniforms.ink, look.ink);
    for (const { point, normal, fill } of planes) {
      const foot = add(centre, normal, dot(add(point, centre, -1), normal));
      const first = Math.abs(normal[0]) < 0.9 ? unit(add([1, 0, 0], normal, -normal[0])) : [0, 1, 0];
      const second = [normal[1] * first[2] - normal[2] * first[1], normal[2] * first[0] - normal[0] * first[2],
                      normal[0] * first[1] - normal[1] * first[0]];
      gl.uniform3fv(uniforms.centre, foot);
      gl.uniform3fv(uniforms.across, [...first, ...second]);
      gl.uniform1f(uniforms.size, 2.4 * camera.reach);
      gl.uniform1f(uniforms.spacing, niceLength(camera.reach / 4));
      gl.uniform2f(uniforms.offset, dot(foot, first), dot(foot, second));
      gl.uniform1f(uniforms.fill, fill);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
  }

  /** Draws rigid bodies: those that belong to rods opaque, others translucent. */
  drawObstacles(camera, projection, look) {
    const gl = this.gl, { program, uniforms } = this.obstacle;
    if (!this.shown.obstacles.length) return;
    const { right, up, eye } = camera.basis();
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.projection, false, projection);
    gl.uniform3fv(uniforms.light, unit(add(add(eye, up, 0.75), right, -0.55)));
    gl.uniform3fv(uniforms.ink, look.ink);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
    for (const { corners, poses, carried } of this.shown.obstacles) {
      gl.uniform1f(uniforms.opacity, carried ? 1 : 0.55);
      const still = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
      const [from, to] = [poses[look.frame] || still, poses[look.next] || still];
      gl.uniformMatrix4fv(uniforms.pose, false, from.map((x, k) => x + look.blend * (to[k] - x)));
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STREAM_DRAW);
      // Draw depths first, so that only the nearest face of each body is visible.
      gl.depthMask(true);
      gl.colorMask(false, false, false, false);
      gl.drawArrays(gl.TRIANGLES, 0, corners.length / 3);
      gl.colorMask(true, true, true, true);
      gl.depthMask(false);
      gl.depthFunc(gl.LEQUAL);
      gl.drawArrays(gl.TRIANGLES, 0, corners.length / 3);
      gl.depthFunc(gl.LESS);
    }
    gl.disableVertexAttribArray(0);
  }

  /** Draws rings at the contacts: clear if visible, pale if behind rods; smaller and paler if there are many. */
  drawContacts(projection, look, density) {
    const gl = this.gl, { program, uniforms } = this.contact, shown = this.shown;
    const [from, to] = [shown.firstContact[look.frame], shown.firstContact[look.frame + 1]];
    if (from === to) return;
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.projection, false, projection);
    gl.uniform3fv(uniforms.lower, shown.lower);
    gl.uniform3fv(uniforms.level, shown.level);
    // Many rings would hide the rods.
    const share = Math.min(1, FEW_CONTACTS / (to - from));
    gl.uniform1f(uniforms.diameter, (6 + 5 * share) * density);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.contacts);
    gl.bufferData(gl.ARRAY_BUFFER, shown.contacts.subarray(3 * from, 3 * to), gl.STREAM_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, false, 6, 0);
    for (const [test, opacity] of [[gl.GREATER, 0.55 * share], [gl.LEQUAL, 0.45 + 0.55 * share]]) {
      gl.depthFunc(test);
      gl.uniform1f(uniforms.opacity, opacity);
      gl.drawArrays(gl.POINTS, 0, to - from);
    }
    gl.depthFunc(gl.LESS);
    gl.disableVertexAttribArray(0);
  }
}

/** The largest of 1, 2, 5 times a power of ten that is not above a length. */
function niceLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * [5, 2, 1].find((step) => step * power <= length * 1.000001);
}
