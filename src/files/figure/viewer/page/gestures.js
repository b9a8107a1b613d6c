// Mouse, pen and finger gestures on the canvas rotate, move and zoom the camera.

function watchGestures(canvas, camera, changed) {
  const pointers = new Map();
  const fromMiddle = (x, y) => [x - canvas.clientWidth / 2, y - canvas.clientHeight / 2];

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.classList.add("dragging");
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    pointers.set(event.pointerId, now);
    if (pointers.size === 2) pinch(event.pointerId, before, now);
    else if (pointers.size === 1) {
      if (event.buttons & 6 || event.shiftKey) camera.move(dx, dy, canvas.clientHeight);
      else camera.turn(0.008 * dx, 0.008 * dy);
    }
    changed();
  });
  // Without capture, a pointer released outside the canvas would keep dragging.
  for (const ending of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(ending, (event) => {
      pointers.delete(event.pointerId);
      if (!pointers.size) canvas.classList.remove("dragging");
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const pixels = event.deltaMode === 1 ? 16 * event.deltaY : event.deltaY;
    camera.zoom(Math.exp(-0.0015 * Math.max(-300, Math.min(300, pixels))), ...fromMiddle(event.clientX, event.clientY), canvas.clientHeight);
    changed();
  }, { passive: false });

  /** One of two fingers has moved: their midpoint moves the camera, their distance zooms. */
  function pinch(id, before, now) {
    const other = [...pointers].find(([key]) => key !== id)[1];
    const apart = (place) => Math.hypot(place[0] - other[0], place[1] - other[1]);
    camera.move((now[0] - before[0]) / 2, (now[1] - before[1]) / 2, canvas.clientHeight);
    const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    if (apart(before) > 0) camera.zoom(apart(now) / apart(before), ...fromMiddle(...middle), canvas.clientHeight);
  }
}
