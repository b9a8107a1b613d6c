// A series beside the motion: a curve with a mark at the output that is shown. Click or drag to
// select another output.

/** Size of the drawing in its own units. */
const [CHART_WIDTH, CHART_HEIGHT] = [360, 110];

class Chart {
  /** `seek` is called with the output that the user points at. */
  constructor(seek) {
    this.name = null;
    this.svg = document.getElementById("chart");
    [this.curve, this.mark] = this.svg.querySelectorAll("path");
    this.svg.setAttribute("viewBox", `0 0 ${CHART_WIDTH} ${CHART_HEIGHT}`);
    const point = (event) => {
      if (event.type === "pointermove" && !event.buttons) return;
      seek(this.nearest(event));
    };
    for (const kind of ["pointerdown", "pointermove"]) this.svg.addEventListener(kind, point);
  }

  /** Sets the series of a case; null for none. */
  show(shown, name) {
    const number = shown.series.findIndex((one) => one.name === name);
    this.name = number >= 0 ? name : null;
    document.getElementById("chart-card").hidden = number < 0;
    if (number < 0) return;
    const { unit } = shown.series[number];
    const values = shown.seriesValues[number];
    const held = Array.from(values.keys()).filter((k) => Number.isFinite(values[k]));
    const range = (numbers) => {
      const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
      return high > low ? [low, high] : [low - 0.5, high + 0.5];
    };
    const [x, y] = [range(shown.times), range(held.map((k) => values[k]))];
    this.places = Array.from(shown.times, (time, k) => [
      ((time - x[0]) / (x[1] - x[0])) * CHART_WIDTH,
      Number.isFinite(values[k]) ? 4 + (1 - (values[k] - y[0]) / (y[1] - y[0])) * (CHART_HEIGHT - 8) : null,
    ]);
    this.shown = shown;
    this.values = values;
    this.unit = unit;
    document.getElementById("chart-high").textContent = quantity(y[1], unit);
    document.getElementById("chart-low").textContent = quantity(y[0], unit);
    this.curve.setAttribute("d", this.path());
  }

  /** The curve, interrupted at missing values and between branches. */
  path() {
    let path = "", isBroken = true;
    this.places.forEach(([x, y], k) => {
      const branches = this.shown.branches;
      if (branches && k > 0 && branches[k] !== branches[k - 1]) isBroken = true;
      if (y === null) isBroken = true;
      else {
        path += `${isBroken ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`;
        isBroken = false;
      }
    });
    return path;
  }

  /** Marks an output. */
  follow(frame) {
    if (!this.name) return;
    const [x, y] = this.places[frame];
    const dot = y === null ? "" : `M${x - 4} ${y}a4 4 0 1 1 8 0a4 4 0 1 1 -8 0`;
    this.mark.setAttribute("d", `M${x} 0V${CHART_HEIGHT}${dot}`);
    const value = this.values[frame];
    document.getElementById("chart-value").textContent = Number.isFinite(value) ? quantity(value, this.unit) : "–";
  }

  /** The output nearest to the pointer. */
  nearest(event) {
    const box = this.svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * CHART_WIDTH;
    const y = ((event.clientY - box.top) / box.height) * CHART_HEIGHT;
    // On a path of equilibria, several outputs may have the same horizontal position.
    const away = ([a, b]) => Math.abs(a - x) + (this.shown.branches && b !== null ? Math.abs(b - y) : 0);
    return this.places.reduce((best, place, k) => (away(place) < away(this.places[best]) ? k : best), 0);
  }
}
