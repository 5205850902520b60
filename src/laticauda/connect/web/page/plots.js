"use strict";
/* Small plots over the last seconds. */

const SPAN = 20; // [s]

class Plot {
  /** `lines`: name of each; `unit` of all; `least`: the axis spans that much at least, from 0 if `fromZero`. */
  constructor(parent, title, unit, lines, least, fromZero = false) {
    Object.assign(this, { lines, least, fromZero, unit });
    const figure = document.createElement("figure"), caption = document.createElement("figcaption");
    this.canvas = document.createElement("canvas");
    this.figure = figure;
    caption.innerHTML = `<b>${title} [${unit}]</b>`;
    lines.forEach((name, i) => {
      if (name === "") return;
      const key = document.createElement("span");
      key.textContent = name;
      key.style.color = `var(--s${i + 1})`;
      caption.append(key);
    });
    figure.append(caption, this.canvas);
    parent.append(figure);
    this.clear();
  }

  clear() {
    this.samples = [];
  }

  /** One number per line at a time [s]; nan leaves a gap. */
  add(time, ...numbers) {
    this.samples.push([time, ...numbers]);
    while (this.samples.length && this.samples[0][0] < time - SPAN) this.samples.shift();
  }

  draw() {
    const canvas = this.canvas, ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const pen = canvas.getContext("2d"), numbers = this.samples.flatMap((one) => one.slice(1)).filter(Number.isFinite).sort((a, b) => a - b);
    // A spike of a few samples, as when steering begins, does not set the scale.
    const few = Math.floor(0.02 * numbers.length), [least, most] = [numbers[few] ?? 0, numbers[numbers.length - 1 - few] ?? 0];
    let low = Math.min(this.fromZero ? 0 : -this.least / 2, least), high = Math.max(this.fromZero ? this.least : this.least / 2, most);
    const step = niceStep((high - low) / 3);
    low = Math.floor(low / step + 1e-9) * step;
    high = Math.ceil(high / step - 1e-9) * step;
    const end = Math.max(SPAN, this.samples.length ? this.samples[this.samples.length - 1][0] : 0);
    const left = 38, bottom = height - 16;
    const x = (time) => left + ((time - end + SPAN) / SPAN) * (width - left - 4), y = (one) => bottom - ((one - low) / (high - low)) * (bottom - 7);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    Object.assign(pen, { font: `11px ${getComputedStyle(document.body).fontFamily}`, lineWidth: 1, strokeStyle: color("line"), fillStyle: color("quiet") });
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    for (let at = low; at <= high + 0.5 * step; at += step) {
      pen.beginPath();
      pen.moveTo(left, y(at));
      pen.lineTo(width - 4, y(at));
      pen.stroke();
      pen.fillText(at.toFixed(digits).replace(/^-(0\.?0*)$/, "$1"), left - 5, y(at));
    }
    pen.textAlign = "center";
    for (let time = Math.ceil((end - SPAN) / 5) * 5; time <= end; time += 5) {
      const at = Math.min(Math.max(x(time), left + 4), width - 14);
      pen.fillText(time === Math.floor(end / 5) * 5 ? `${time} s` : `${time}`, at, height - 6);
    }
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, width, bottom + 1);
    pen.clip();
    this.lines.forEach((_, i) => {
      pen.beginPath();
      for (const sample of this.samples) if (Number.isFinite(sample[i + 1])) pen.lineTo(x(sample[0]), y(sample[i + 1]));
      Object.assign(pen, { strokeStyle: color(`s${i + 1}`), lineWidth: 1.6, lineJoin: "round" });
      pen.stroke();
    });
    pen.restore();
  }
}

function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least || 1));
  return [1, 2, 5, 10].find((one) => one * power >= least * 0.999) * power;
}
