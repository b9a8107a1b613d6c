// The movie: its description is JSON, its numbers are packed bytes in base64; a case is unpacked
// when it is shown.

const movie = JSON.parse(document.getElementById("movie").textContent);

const MAXIMUM_LEVEL = 65535;

/** A case with its numbers as typed arrays, which are views of one buffer in the packed order. */
function unpackCase(index) {
  const element = document.getElementById(`case-${index}`);
  const text = atob(element.textContent);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);

  const description = movie.cases[index];
  const frames = description.frames;
  const nodes = description.rods.reduce((sum, rod) => sum + rod.nodes, 0);
  let at = 0;
  const next = (Type, length) => {
    const array = new Type(bytes.buffer, at, length);
    at += array.byteLength;
    return array;
  };
  const times = next(Float32Array, frames);
  const firstContact = next(Uint32Array, frames + 1);
  const seriesValues = description.series.map(() => next(Float32Array, frames));
  const positions = next(Uint16Array, 3 * frames * nodes);
  const contacts = next(Uint16Array, 3 * firstContact[frames]);
  const values = description.fields.map(() => next(Uint8Array, frames * nodes));
  return { ...description, nodes, times, seriesValues, firstContact, positions, contacts, values,
           level: description.size.map((size) => size / MAXIMUM_LEVEL) };
}

/** The range of a field over all cases, so that a colour has the same meaning in each. */
function rangeOverCases(name) {
  const fields = movie.cases.flatMap((one) => one.fields.filter((field) => field.name === name));
  return {
    low: Math.min(...fields.map((field) => field.low)),
    high: Math.max(...fields.map((field) => field.high)),
    clips: fields.some((field) => field.clips),
  };
}

/** Kind of content of a case: rods at rest, a path of equilibria, or motion. */
const isAtRest = (shown) => shown.frames < 2;
const isPath = (shown) => shown.branches !== null;

/** A number with its unit, to three digits, with a prefix if the unit allows one. */
function quantity(value, unit) {
  if (value === 0) return `0 ${unit}`;
  const prefixes = { "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M" };
  const takesPrefix = ["m", "s", "N", "m/s"].includes(unit);
  const power = takesPrefix
    ? Math.min(Math.max(3 * Math.floor(Math.log10(Math.abs(value) * 1.0000001) / 3), -9), unit === "N" ? 6 : 0)
    : 0;
  const digits = Number((value / 10 ** power).toPrecision(3));
  const text = Math.abs(digits) >= 1e5 || Math.abs(digits) < 1e-3 ? digits.toExponential() : String(digits);
  return `${text.replace("-", "−")} ${prefixes[power]}${unit}`;
}
