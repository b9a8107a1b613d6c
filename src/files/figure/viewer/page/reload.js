// The page of an active run reloads itself repeatedly. The choices of the user are stored in the
// address after the #, which also works for files.

/** Stores camera, colour, plot, case, and the output shown; null stands for the last output. */
function keepState(page) {
  const { target, scale, yaw, pitch, parallel } = page.camera;
  const isLast = page.player.frame() === page.shown.frames - 1;
  const state = {
    camera: { target, scale, yaw, pitch, parallel },
    frames: page.shown.frames,
    index: page.index,
    colour: page.colour,
    plot: page.chart.name,
    look: { contacts: page.look.contacts, grid: page.look.grid },
    moved: page.camera.moved === true,
    frame: isLast && !page.player.playing ? null : page.player.frame(),
    playing: page.player.playing,
    speed: page.player.speed,
    smooth: page.player.smooth,
  };
  location.hash = encodeURIComponent(JSON.stringify(state));
}

/** Restores the state stored before the reload; without one, an active run is shown at its last output. */
function takeUpState(page) {
  let state = null;
  try {
    state = JSON.parse(decodeURIComponent(location.hash.slice(1)));
  } catch {
    // The address has no state, or a damaged one.
  }
  if (!state?.camera) {
    if (movie.reload) page.player.seek(page.shown.frames - 1);
    return;
  }
  if (state.index > 0 && state.index < movie.cases.length) page.showCase(state.index);
  // If the user has not moved the camera, it keeps fitting the growing motion.
  if (state.moved) {
    Object.assign(page.camera, state.camera, { moved: true });
    page.setProjection(state.camera.parallel);
  }
  for (const what of ["contacts", "grid"]) if (page.look[what] !== state.look[what]) page.toggle(what);
  page.setColour(state.colour);
  page.setPlot(state.plot);
  page.setSpeed(state.speed);
  page.player.smooth = element("smooth").checked = state.smooth;
  page.player.seek(state.frame ?? page.shown.frames - 1);
  page.player.playing = state.playing;
  page.changed();
}

/** Reloads the page later, but not while the user is dragging. */
function reloadLater(page) {
  if (!movie.reload) return;
  element("subtitle").textContent += " · running";
  const reload = () => {
    if (page.canvas.classList.contains("dragging") || page.exporter.recorder) return setTimeout(reload, 200);
    keepState(page);
    location.reload();
  };
  setTimeout(reload, 1000 * movie.reload);
}
