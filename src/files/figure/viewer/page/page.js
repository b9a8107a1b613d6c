// Combines the parts of the page: the content shown, and the actions of buttons and keys.

const element = (id) => document.getElementById(id);

class Page {
  constructor() {
    this.canvas = element("scene");
    this.renderer = new Renderer(this.canvas);
    this.camera = new Camera();
    this.player = new Player();
    this.look = { contacts: true, grid: true };
    /** Name of the field that colours the rods; null for the colour of the rod. */
    this.colour = null;
    this.cases = new Map();
    this.chart = new Chart((frame) => { this.player.playing = false; this.player.seek(frame); this.changed(); });
    this.exporter = new Exporter(this.canvas, () => this.drawNow());
    element("title").textContent = movie.title;
    element("subtitle").textContent = movie.subtitle;
    this.fillChoices();
    this.setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
    this.showCase(0);
    this.fit(true);
    this.watch();
    takeUpState(this);
    reloadLater(this);
  }

  fillChoices() {
    element("case-choice").hidden = movie.cases.length < 2;
    movie.cases.forEach((one, index) => element("case").add(new Option(one.name, index)));
    SPEEDS.forEach((speed) => element("speed").add(new Option(`× ${String(speed)}`, speed)));
  }

  showCase(index) {
    this.index = (index + movie.cases.length) % movie.cases.length;
    // A few cases stay unpacked, so that switching between them is fast.
    if (!this.cases.has(this.index)) {
      if (this.cases.size > 3) this.cases.delete(this.cases.keys().next().value);
      this.cases.set(this.index, unpackCase(this.index));
    }
    this.shown = this.cases.get(this.index);
    this.player.show(this.shown.times);
    this.renderer.show(this.shown);
    element("case").value = this.index;
    fillList(element("distinction"), this.shown.distinction);
    fillList(element("parameter-list"), this.shown.parameters);
    element("parameters").hidden = !this.shown.parameters.length;
    element("time").max = this.shown.frames - 1;
    // Rods at rest have no time, and equilibria no speed.
    document.body.classList.toggle("at-rest", isAtRest(this.shown));
    document.body.classList.toggle("path", isPath(this.shown));
    this.player.isPath = isPath(this.shown);
    element("time").setAttribute("aria-label", isPath(this.shown) ? "Path parameter" : "Output time");
    element("video").hidden = isAtRest(this.shown) || isPath(this.shown) || !Exporter.canRecord();
    const plots = [new Option("nothing", ""), ...this.shown.series.map(({ name }) => new Option(name, name))];
    element("plot").replaceChildren(...plots);
    element("plot-choice").hidden = isAtRest(this.shown) || !this.shown.series.length;
    this.setPlot(this.chart.name);
    element("speed").value = this.player.speed;
    const choices = [new Option("rod", ""), ...this.shown.fields.map(({ name }) => new Option(name.toLowerCase(), name))];
    element("colour").replaceChildren(...choices);
    element("contact-key").hidden = !this.shown.contacts.length;
    this.setColour(this.shown.fields.some(({ name }) => name === this.colour) ? this.colour : null);
  }

  /** Plots a series beside the motion; no plot without a name. */
  setPlot(name) {
    this.chart.show(this.shown, isAtRest(this.shown) ? null : name || null);
    element("plot").value = this.chart.name ?? "";
    this.changed();
  }

  setColour(name) {
    this.colour = name || null;
    element("colour").value = this.colour ?? "";
    const field = this.shown.fields.find((one) => one.name === this.colour);
    element("scale").hidden = !field;
    element("names").replaceChildren();
    if (field) {
      this.look.range = rangeOverCases(field.name);
      const { low, high, clips } = this.look.range;
      const stops = field.signed ? DIVERGING : SEQUENTIAL;
      element("bar").style.background = `linear-gradient(90deg, ${stops.join(", ")})`;
      const beyond = clips ? "≥ " : "";
      element("low").textContent = (field.signed && clips ? "≤ " : "") + quantity(low, field.unit);
      element("middle").textContent = field.signed ? "0" : "";
      element("high").textContent = beyond + quantity(high, field.unit);
    } else if (this.shown.rods.length <= 12) {
      element("names").append(...this.shown.rods.map((rod, index) => {
        const [line, swatch] = [document.createElement("li"), document.createElement("i")];
        swatch.style.background = movie.palette[colourOfRod(rod, index)];
        line.append(swatch, rod.held ? `${rod.name} (held)` : rod.name);
        return line;
      }));
    }
    const offered = this.shown.fields.map((one) => one.name);
    element("hint").hidden = offered.includes("Twist") || offered.includes("Contact force");
    element("hint").textContent = "Twist and contact force: [output] forces = true";
    this.changed();
  }

  setTheme(dark) {
    document.documentElement.classList.toggle("dark", dark);
    this.look.ink = dark ? [0.75, 0.82, 0.88] : [0.1, 0.14, 0.18];
    this.look.haze = dark ? [0.12, 0.14, 0.17] : [0.91, 0.93, 0.95];
    this.changed();
  }

  /** Fits the whole motion into the view; `fromStart`: from the initial direction of view. */
  fit(fromStart = false) {
    const { room, eye } = this.shown;
    this.camera.moved = !fromStart;
    if (fromStart) this.camera.lookFrom(eye);
    this.camera.fit(room.lower, room.size, this.freePart());
    this.changed();
  }

  /** The part of the canvas that cards leave free. */
  freePart() {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const boxes = (ids) => ids.map((id) => element(id).getBoundingClientRect()).filter((box) => box.height > 0);
    const below = height - Math.min(height, ...boxes(["transport", "chart-card", "ruler"]).map((box) => box.top));
    // In low windows the tools are in a row at the top, otherwise in a column on the right.
    const [tools] = boxes(["tools"]);
    const isRow = tools && tools.width > tools.height;
    const row = isRow ? tools.bottom : 0, right = tools && !isRow ? width - tools.left : 0;
    // There is room beside narrow cards, but not if they span a small screen.
    const cards = width < 640 ? boxes(["about", "legend"]).map((box) => box.bottom) : [];
    const above = Math.max(row, ...cards);
    const least = 0.4 * height, asked = height - above - below;
    const part = asked < least ? (height - least) / (above + below) : 1;
    return { width, height, above: part * above, below: part * below, right };
  }

  lookAlong(eye) {
    this.camera.lookFrom(eye);
    this.fit();
  }

  toggle(what) {
    this.look[what] = !this.look[what];
    element(what).setAttribute("aria-pressed", this.look[what]);
    this.changed();
  }

  setProjection(parallel) {
    this.camera.parallel = parallel;
    element("projection").setAttribute("aria-pressed", parallel);
    this.changed();
  }

  setSpeed(speed) {
    this.player.speed = speed;
    element("speed").value = speed;
  }

  /** Draws in the next animation frame. */
  changed() {
    this.pending ??= requestAnimationFrame((now) => this.draw(now));
  }

  draw(now) {
    this.pending = undefined;
    if (this.player.playing) {
      this.player.advance(Math.min(now - (this.drawn ?? now), 250) / 1000);
      this.drawn = now;
      this.changed();
    } else this.drawn = undefined;
    if (this.exporter.recorder) this.exporter.frame();
    else this.drawNow();
    if (this.exporter.recorder && this.player.time >= this.player.last()) {
      this.player.playing = false;
      this.exporter.end();
    }
  }

  /** Draws the scene; returns the texts of the clock and the ruler. */
  drawNow() {
    const place = this.player.place();
    const field = this.shown.fields.findIndex((one) => one.name === this.colour);
    this.renderer.draw(this.camera, { ...this.look, ...place, field });
    this.chart.follow(place.frame);
    return this.label(place.frame);
  }

  /** Records the motion from start to end, or ends a recording. */
  record() {
    if (this.exporter.recorder) return this.exporter.end();
    this.player.seek(0);
    this.player.playing = true;
    this.drawn = undefined;
    const ended = () => { this.player.playing = false; element("video").setAttribute("aria-pressed", false); this.changed(); };
    this.exporter.begin(this.fileName(), ended);
    element("video").setAttribute("aria-pressed", true);
    this.changed();
  }

  /** The title as a file name. */
  fileName() {
    return movie.title.replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "").toLowerCase() || "rods";
  }

  /** Updates clock, slider, ruler and axes. */
  label(frame) {
    const { firstContact } = this.shown;
    element("time").value = frame;
    element("play").textContent = this.player.playing ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", this.player.playing ? "Pause" : "Play");
    const digits = Math.max(0, 2 - Math.floor(Math.log10(this.player.duration() || 1)));
    const time = (seconds) => seconds.toFixed(Math.min(digits, 9));
    const clock = this.clock(frame, time);
    element("clock").textContent = clock;
    const contacts = firstContact[frame + 1] - firstContact[frame];
    element("contact-count").textContent = contacts === 1 ? "1 contact" : `${contacts} contacts`;
    const metresPerPixel = (2 * this.camera.scale) / this.canvas.clientHeight;
    const length = niceLength(140 * metresPerPixel);
    const ruler = { pixels: length / metresPerPixel, text: quantity(length, "m") };
    element("ruler-bar").style.width = `${ruler.pixels}px`;
    element("ruler-text").textContent = ruler.text;
    this.drawAxes();
    return { clock, ruler };
  }

  /** Text of the clock: the time, or the position on a path of equilibria. */
  clock(frame, time) {
    const { times, frames, branches } = this.shown;
    if (isAtRest(this.shown)) return "";
    if (!branches) return `${time(this.player.smooth ? this.player.time : times[frame])} of ${time(this.player.last())} s`;
    const several = branches.some((branch) => branch !== branches[0]);
    return `parameter ${Number(times[frame].toPrecision(4))}${several ? `, branch ${branches[frame]}` : ""} (${frame + 1} of ${frames})`;
  }

  drawAxes() {
    const { right, up, eye } = this.camera.basis();
    const axes = ["x", "y", "z"].map((name, k) => ({ name, at: [32 * right[k], -32 * up[k]], near: eye[k], colour: movie.palette[[1, 2, 0][k]] }));
    axes.sort((a, b) => a.near - b.near);
    element("axes").innerHTML = axes.map(({ name, at: [x, y], colour }) =>
      `<path d="M0 0L${x} ${y}" stroke="${colour}" stroke-width="3" stroke-linecap="round"/>
       <text x="${1.32 * x}" y="${1.32 * y}" fill="${colour}">${name}</text>`).join("");
  }

  watch() {
    const on = (id, event, action) => element(id).addEventListener(event, () => { action(); this.changed(); });
    on("play", "click", () => this.player.toggle());
    on("time", "input", () => { this.player.playing = false; this.player.seek(Number(element("time").value)); });
    on("speed", "change", () => this.setSpeed(Number(element("speed").value)));
    on("smooth", "change", () => { this.player.smooth = element("smooth").checked; });
    on("colour", "change", () => this.setColour(element("colour").value));
    on("plot", "change", () => this.setPlot(element("plot").value));
    on("picture", "click", () => this.exporter.picture(this.fileName()));
    on("video", "click", () => this.record());
    on("case", "change", () => this.showCase(Number(element("case").value)));
    on("previous-case", "click", () => this.showCase(this.index - 1));
    on("next-case", "click", () => this.showCase(this.index + 1));
    on("fit", "click", () => this.fit(true));
    on("projection", "click", () => this.setProjection(!this.camera.parallel));
    on("contacts", "click", () => this.toggle("contacts"));
    on("grid", "click", () => this.toggle("grid"));
    on("theme", "click", () => this.setTheme(!document.documentElement.classList.contains("dark")));
    on("help", "click", () => element("keys").showModal());
    watchGestures(this.canvas, this.camera, () => { this.camera.moved = true; this.changed(); });
    // If the user has not moved the camera, fit the scene to the window again.
    new ResizeObserver(() => (this.camera.moved ? this.changed() : this.fit(true))).observe(this.canvas);
    // The graphics card has lost its contents: start again.
    this.canvas.addEventListener("webglcontextlost", () => location.reload());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || element("keys").open) return;
    // Selections and the slider handle these keys themselves.
    if (event.target.tagName === "SELECT") return;
    const step = event.shiftKey ? 10 : 1;
    const move = (frames) => { this.player.playing = false; this.player.seek(this.player.frame() + frames); };
    const side = event.shiftKey ? -1 : 1;
    const actions = {
      " ": () => this.player.toggle(),
      arrowleft: () => move(-step),
      arrowright: () => move(step),
      home: () => move(-Infinity),
      end: () => move(Infinity),
      "+": () => { this.player.faster(1); this.setSpeed(this.player.speed); },
      "=": () => { this.player.faster(1); this.setSpeed(this.player.speed); },
      "-": () => { this.player.faster(-1); this.setSpeed(this.player.speed); },
      i: () => element("smooth").click(),
      "[": () => this.showCase(this.index - 1),
      "]": () => this.showCase(this.index + 1),
      x: () => this.lookAlong([side, 0, 0]),
      y: () => this.lookAlong([0, -side, 0]),
      z: () => this.lookAlong([0, 0, side]),
      f: () => this.fit(true),
      p: () => this.setProjection(!this.camera.parallel),
      c: () => this.toggle("contacts"),
      g: () => this.toggle("grid"),
      d: () => this.setTheme(!document.documentElement.classList.contains("dark")),
      s: () => this.exporter.picture(this.fileName()),
      v: () => { if (!element("video").hidden) this.record(); },
      l: () => { const plot = element("plot"); this.setPlot(plot.options[(plot.selectedIndex + 1) % plot.length]?.value); },
      h: () => document.body.classList.toggle("bare"),
      "?": () => element("keys").showModal(),
    };
    const choice = Number(event.key);
    const action = choice >= 1
      ? () => { if (choice <= element("colour").length) this.setColour(element("colour").options[choice - 1].value); }
      : actions[event.key.toLowerCase()];
    // A focused button interprets the space bar as a click.
    if (!action || (event.key === " " && event.target.tagName === "BUTTON")) return;
    event.preventDefault();
    action();
    this.changed();
  }
}

/** Shows pairs of keys and values in a description list. */
function fillList(list, pairs) {
  list.replaceChildren(...pairs.flatMap(([key, value]) => {
    const [term, description] = [document.createElement("dt"), document.createElement("dd")];
    term.textContent = key;
    description.textContent = value;
    return [term, description];
  }));
}

try {
  new Page();
} catch (error) {
  element("fault").hidden = false;
  element("fault").textContent = error.message;
  throw error;
}
