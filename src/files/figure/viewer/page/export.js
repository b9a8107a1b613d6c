// Exports the view: a picture, or a video of the motion.

/** Frames of a video per second. */
const RATE = 30;
/** Formats of videos, in order of preference. */
const VIDEOS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

class Exporter {
  /** `draw` draws the scene on its canvas immediately and returns the texts below it: clock, ruler. */
  constructor(scene, draw) {
    this.scene = scene;
    this.draw = draw;
    this.recorder = null;
  }

  /** The scene on its background with scale and time, on a separate canvas. */
  compose(canvas) {
    const { clock, ruler } = this.draw();
    const [width, height] = [this.scene.width, this.scene.height];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const pen = canvas.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const background = pen.createLinearGradient(0, 0, 0, height);
    background.addColorStop(0, style.getPropertyValue("--top").trim());
    background.addColorStop(1, style.getPropertyValue("--bottom").trim());
    pen.fillStyle = background;
    pen.fillRect(0, 0, width, height);
    pen.drawImage(this.scene, 0, 0);
    const density = width / this.scene.clientWidth;
    pen.setTransform(density, 0, 0, density, 0, 0);
    pen.fillStyle = pen.strokeStyle = style.getPropertyValue("--ink").trim();
    pen.font = "14px system-ui, sans-serif";
    const [right, bottom] = [this.scene.clientWidth - 20, this.scene.clientHeight - 20];
    pen.textAlign = "left";
    pen.fillText(clock, 20, bottom);
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(right - ruler.pixels, bottom - 6);
    pen.lineTo(right - ruler.pixels, bottom);
    pen.lineTo(right, bottom);
    pen.lineTo(right, bottom - 6);
    pen.stroke();
    pen.textAlign = "center";
    pen.fillText(ruler.text, right - ruler.pixels / 2, bottom - 10);
    pen.setTransform(1, 0, 0, 1, 0, 0);
    return canvas;
  }

  /** Saves a picture. */
  picture(name) {
    this.compose(document.createElement("canvas")).toBlob((blob) => save(blob, `${name}.png`), "image/png");
  }

  /** Begins a video; `ended` is called when it is saved. Each `frame()` adds the current view. */
  begin(name, ended) {
    const canvas = this.compose(document.createElement("canvas"));
    const stream = canvas.captureStream(RATE);
    const mimeType = VIDEOS.find((format) => MediaRecorder.isTypeSupported(format));
    const parts = [];
    this.canvas = canvas;
    this.recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: 12e6 });
    this.recorder.ondataavailable = ({ data }) => parts.push(data);
    this.recorder.onstop = () => {
      const ending = this.recorder.mimeType.includes("mp4") ? "mp4" : "webm";
      save(new Blob(parts, { type: this.recorder.mimeType }), `${name}.${ending}`);
      this.recorder = null;
      ended();
    };
    this.recorder.start();
  }

  frame() {
    if (this.recorder) this.compose(this.canvas);
  }

  /** Ends the video after the last frame has been drawn. */
  end() {
    if (this.recorder?.state === "recording") setTimeout(() => this.recorder?.stop(), 2000 / RATE);
  }

  static canRecord() {
    return typeof MediaRecorder === "function" && VIDEOS.some((format) => MediaRecorder.isTypeSupported(format));
  }
}

/** Offers a file for download. */
function save(blob, name) {
  const link = document.createElement("a");
  link.download = name;
  const address = link.href = URL.createObjectURL(blob);
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
