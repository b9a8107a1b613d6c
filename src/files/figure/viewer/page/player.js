// Selects the output shown: play, pause, speed.

/** Speeds, simulated seconds per second. */
const SPEEDS = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
/** Longest duration of a whole run at the initial speed, s. */
const WHOLE_RUN = 16;

class Player {
  constructor() {
    this.playing = false;
    this.smooth = false;
    this.times = [0];
    this.time = 0;
    this.speed = 1;
    /** Whether outputs are equilibria along a path, which have an order, but no time and no speed. */
    this.isPath = false;
    this.at = 0;
  }

  /** Sets the times of another case, and keeps the present time. */
  show(times) {
    const isFirst = this.times.length === 1;
    this.times = times;
    this.time = Math.min(Math.max(this.time, times[0]), this.last());
    this.at = Math.min(this.at, times.length - 1);
    if (isFirst) this.speed = SPEEDS.find((speed) => this.duration() / speed <= WHOLE_RUN) ?? SPEEDS.at(-1);
    if (times.length < 2) this.playing = false;
  }

  last() {
    return this.times[this.times.length - 1];
  }

  duration() {
    return this.last() - this.times[0];
  }

  /** The last output that is not after the time shown. */
  frame() {
    if (this.isPath) return this.at;
    let [low, high] = [0, this.times.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= this.time) low = middle; else high = middle;
    }
    return low;
  }

  /** The outputs to draw: frame, next frame, and the fraction between them. */
  place() {
    const frame = this.frame();
    if (this.isPath || !this.smooth || frame + 1 === this.times.length) return { frame, next: frame, blend: 0 };
    const step = this.times[frame + 1] - this.times[frame];
    return { frame, next: frame + 1, blend: step > 0 ? (this.time - this.times[frame]) / step : 0 };
  }

  seek(frame) {
    this.at = Math.min(Math.max(frame, 0), this.times.length - 1);
    this.time = this.times[this.at];
  }

  toggle() {
    if (this.isPath || this.times.length < 2) return;
    this.playing = !this.playing;
    if (this.playing && this.time >= this.last()) this.time = this.times[0];
  }

  faster(steps) {
    const at = SPEEDS.indexOf(this.speed) + steps;
    this.speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
  }

  /** Advances by real seconds; starts again at the end. */
  advance(seconds) {
    if (this.time >= this.last()) this.time = this.times[0];
    else this.time = Math.min(this.time + seconds * this.speed, this.last());
  }
}
