// Colour bars that colour-blind readers can distinguish.

// Viridis (Smith and van der Walt 2015) for unsigned values, without its darkest end, which would
// be invisible in the dark theme.
const SEQUENTIAL = ["#5a4aa5", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"];
// Blue through grey to orange for signed values.
const DIVERGING = ["#0b4f9c", "#2f86c9", "#86bfe0", "#d4d8dc", "#eeb07a", "#d9762b", "#9c3f06"];

/** Index of a rod's colour in the palette; obstacles have the last one, a grey. */
function colourOfRod(rod, index) {
  return rod.held ? movie.palette.length - 1 : index % movie.palette.length;
}

function channels(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

/** 256 colours along a bar, as RGBA bytes. */
function colourBar(stops) {
  const bytes = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; k++) {
    const place = (k / 255) * (stops.length - 1);
    const before = Math.min(Math.floor(place), stops.length - 2);
    const [a, b] = [channels(stops[before]), channels(stops[before + 1])];
    for (let c = 0; c < 3; c++) bytes[4 * k + c] = a[c] + (place - before) * (b[c] - a[c]);
    bytes[4 * k + 3] = 255;
  }
  return bytes;
}
