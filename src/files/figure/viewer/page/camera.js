// The camera rotates about a target, with z up, like a turntable. Vectors are arrays of three
// numbers.

const add = (a, b, factor = 1) => a.map((x, k) => x + factor * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const norm = (a) => Math.sqrt(dot(a, a));
const unit = (a) => a.map((x) => x / norm(a));

class Camera {
  /** Half of the field of view, rad. */
  static HALF_ANGLE = 0.24;

  constructor() {
    this.target = [0, 0, 0];
    /** Half of the visible height at the target, m. */
    this.scale = 1;
    this.yaw = 0;
    this.pitch = 0;
    this.parallel = false;
    this.reach = 1;
  }

  lookFrom(eye) {
    this.pitch = Math.asin(Math.max(-1, Math.min(1, eye[2])));
    // In a view from above or below, x runs to the right.
    this.yaw = Math.hypot(eye[0], eye[1]) > 1e-6 ? Math.atan2(eye[0], -eye[1]) : 0;
  }

  /** Unit vectors to the right, up, and to the eye. */
  basis() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    return { right: [cy, sy, 0], up: [-sy * sp, cy * sp, cp], eye: [sy * cp, -cy * cp, sp] };
  }

  turn(dx, dy) {
    this.yaw -= dx;
    this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + dy));
  }

  /** Moves by pixels on a canvas of the given height. */
  move(dx, dy, height) {
    const { right, up } = this.basis();
    const metres = (2 * this.scale) / height;
    this.target = add(add(this.target, right, -dx * metres), up, dy * metres);
  }

  /** Zooms by a factor about a point at (x, y) pixels from the middle, y downwards. */
  zoom(factor, x, y, height) {
    const scale = Math.max(this.reach * 1e-5, Math.min(this.reach * 50, this.scale / factor));
    const { right, up } = this.basis();
    const shift = (2 * (this.scale - scale)) / height;
    this.target = add(add(this.target, right, x * shift), up, -y * shift);
    this.scale = scale;
  }

  /** Fits the box into the free part of a canvas, which excludes `above`, `below` and `right`, pixels. */
  fit(lower, size, { width, height, above, below, right: beside = 0 }) {
    this.reach = 0.5 * norm(size);
    const { right, up, eye } = this.basis();
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => size.map((extent, k) => (corner >> k & 1 ? 0.5 : -0.5) * extent));
    // A corner nearer than the target by d appears larger: |r| / (distance − d) ≤ tan, with the
    // lateral offset r.
    const tangent = Math.tan(Camera.HALF_ANGLE) / 1.12;
    const distance = Math.max(...corners.map((corner) => {
      const aside = Math.max(Math.abs(dot(up, corner)) * height / (height - above - below), Math.abs(dot(right, corner)) * height / (width - beside));
      return aside / tangent + (this.parallel ? 0 : dot(eye, corner));
    }));
    this.scale = distance * Math.tan(Camera.HALF_ANGLE);
    const metresPerPixel = 2 * this.scale / height;
    const centre = lower.map((x, k) => x + 0.5 * size[k]);
    // The centre of the free part is offset from that of the canvas by half of the difference of
    // the excluded margins.
    this.target = add(add(centre, up, -0.5 * (below - above) * metresPerPixel), right, 0.5 * beside * metresPerPixel);
  }

  distance() {
    return this.scale / Math.tan(Camera.HALF_ANGLE);
  }

  /** Position of the eye; far away in a parallel view. */
  position() {
    return add(this.target, this.basis().eye, this.parallel ? 1e3 * this.reach : this.distance());
  }

  /** Columns of the matrix from the scene to the canvas. `reach`: visible radius around the target, m. */
  matrix(aspect, reach) {
    const { right, up, eye } = this.basis();
    const distance = this.distance();
    const far = distance + reach, near = this.parallel ? distance - reach : Math.max(distance - reach, 2e-3 * far);
    const row = (axis, factor) => [...axis.map((x) => x * factor), -dot(axis, this.target) * factor];
    // Depth: z = (eye · x) − distance in front of the camera is negative.
    const z = [...eye, -dot(eye, this.target) - distance];
    let rows;
    if (this.parallel) {
      const depth = z.map((x) => (-2 * x) / (far - near));
      depth[3] -= (far + near) / (far - near);
      rows = [row(right, 1 / (this.scale * aspect)), row(up, 1 / this.scale), depth, [0, 0, 0, 1]];
    } else {
      const focus = 1 / Math.tan(Camera.HALF_ANGLE);
      const depth = z.map((x) => (-x * (far + near)) / (far - near));
      depth[3] -= (2 * far * near) / (far - near);
      rows = [row(right, focus / aspect), row(up, focus), depth, z.map((x) => -x)];
    }
    return new Float32Array([0, 1, 2, 3].flatMap((column) => rows.map((line) => line[column])));
  }
}
