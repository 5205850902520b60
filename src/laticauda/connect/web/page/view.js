"use strict";
/* The picture: the robot in the water, seen from above. World axes x to the right, y up, in meters. */

const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const HANDLE = 9; // radius of a waypoint [px]
const TRAIL = 1200; // samples
const STREAKS = 70;

/** How far outlines reach from the origin along an axis [m]. */
const farthest = (outlines, axis) => Math.max(...outlines.flat().map((point) => Math.abs(point[axis])));

class View {
  /** `changed(waypoints)` is called when somebody moves, adds or removes one. */
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.changed = changed;
    this.center = [0, 0];
    this.scale = 0; // [px/m]; 0: not chosen yet
    this.follows = true;
    this.waypoints = null;
    this.trail = [];
    this.pointers = new Map();
    this.streaks = Array.from({ length: STREAKS }, () => [Math.random(), Math.random(), 0.3 + 0.7 * Math.random()]);
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#moved(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.#up(event));
    canvas.addEventListener("dblclick", (event) => this.#double(event));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.#zoom(Math.exp(-0.0015 * event.deltaY), this.#place(event));
    }, { passive: false });
  }

  /** Look at the robot again. */
  home(body) {
    this.follows = true;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.scale = Math.min(0.42 * width, 0.8 * height) / this.#length(body);
    // Places that are farther away are seen, too.
    for (const { outlines } of PAGE.places) {
      const [x, y] = [0, 1].map((axis) => farthest(outlines, axis));
      this.scale = Math.min(this.scale, (0.48 * width) / x, (0.48 * height) / y);
    }
  }

  #length(body) {
    const along = (levers) => levers.reduce((sum, lever) => sum + lever, 0);
    return along(body.ends[body.ends.length - 1]) - Math.min(along(body.fin[0]), along(body.ends[0]));
  }

  forget() {
    this.trail = [];
  }

  /** Remember where the center of mass was, once per sample. */
  remember(values, body) {
    this.trail.push([values[body.number["center_of_mass.x"]], values[body.number["center_of_mass.y"]]]);
    if (this.trail.length > TRAIL) this.trail.shift();
  }

  // ---- drawing ------------------------------------------------------------------------------------------------------

  /** Draw; `passed` is the time of the world since the last picture [s], for what drifts in the water. */
  draw(body, values, current, passed) {
    const canvas = this.canvas, ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    if (!this.scale) this.home(body);
    const posture = postureOf(body, values), pen = canvas.getContext("2d");
    if (this.follows) this.center = posture.center.slice();
    this.size = [width, height];
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.#water(pen, current, passed);
    this.#places(pen);
    this.#path(pen);
    this.#line(pen, this.trail.concat([posture.center]), color("trail"), 1.6, 0.75);
    this.#robot(pen, body, posture);
    this.#ruler(pen, current);
  }

  #at([x, y]) {
    return [0.5 * this.size[0] + this.scale * (x - this.center[0]), 0.5 * this.size[1] - this.scale * (y - this.center[1])];
  }

  #world([x, y]) {
    return [this.center[0] + (x - 0.5 * this.size[0]) / this.scale, this.center[1] - (y - 0.5 * this.size[1]) / this.scale];
  }

  #line(pen, points, stroke, width, alpha = 1) {
    pen.beginPath();
    for (const point of points) pen.lineTo(...this.#at(point));
    Object.assign(pen, { strokeStyle: stroke, lineWidth: width, globalAlpha: alpha, lineJoin: "round", lineCap: "round" });
    pen.stroke();
    pen.globalAlpha = 1;
  }

  #water(pen, current, passed) {
    const [width, height] = this.size, shade = pen.createLinearGradient(0, 0, 0, height);
    shade.addColorStop(0, color("water"));
    shade.addColorStop(1, color("deep"));
    pen.fillStyle = shade;
    pen.fillRect(0, 0, width, height);
    // A grid of half a meter or what suits the scale: fixed to the world, so that motion is seen.
    const step = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20].find((one) => one * this.scale > 45) ?? 50;
    const [left, top] = this.#world([0, 0]), [right, bottom] = this.#world([width, height]);
    Object.assign(pen, { strokeStyle: color("grid"), lineWidth: 1 });
    pen.beginPath();
    for (let x = Math.ceil(left / step) * step; x < right; x += step) {
      const [at] = this.#at([x, 0]);
      pen.moveTo(at, 0);
      pen.lineTo(at, height);
    }
    for (let y = Math.ceil(bottom / step) * step; y < top; y += step) {
      const [, at] = this.#at([0, y]);
      pen.moveTo(0, at);
      pen.lineTo(width, at);
    }
    pen.stroke();
    this.#drift(pen, current, passed, left, bottom, right - left, top - bottom);
  }

  /** Streaks that the current carries along; without one there are none. */
  #drift(pen, [vx, vy], passed, left, bottom, wide, high) {
    const speed = Math.hypot(vx, vy);
    if (speed === 0) return;
    Object.assign(pen, { strokeStyle: color("streak"), fillStyle: color("streak"), lineCap: "round" });
    const within = (value) => value - Math.floor(value);
    for (const streak of this.streaks) {
      // Places are kept as shares of what is seen, moved with the world: as water that fills all of it.
      streak[0] += (vx * passed) / wide;
      streak[1] += (vy * passed) / high;
      const x = left + wide * within(streak[0] - left / wide), y = bottom + high * within(streak[1] - bottom / high);
      const length = ((8 + 110 * Math.min(speed, 0.5)) * (0.4 + 0.6 * streak[2])) / this.scale;
      const [headX, headY] = this.#at([x, y]), [tailX, tailY] = this.#at([x - (vx / speed) * length, y - (vy / speed) * length]);
      pen.globalAlpha = 0.35 + 0.5 * streak[2];
      pen.lineWidth = 1.4;
      pen.beginPath();
      pen.moveTo(tailX, tailY);
      pen.lineTo(headX, headY);
      pen.stroke();
      this.#tip(pen, headX, headY, Math.atan2(headY - tailY, headX - tailX), 4);
    }
    pen.globalAlpha = 1;
  }

  #tip(pen, x, y, angle, size) {
    pen.beginPath();
    for (const turn of [0, 2.6, -2.6]) pen.lineTo(x + size * Math.cos(angle + turn), y + size * Math.sin(angle + turn));
    pen.fill();
  }

  /** What stands in the water, each with its name above it. */
  #places(pen) {
    Object.assign(pen, { fillStyle: color("place"), strokeStyle: color("place"), lineWidth: 1.5, lineJoin: "round" });
    Object.assign(pen, { textAlign: "center", font: `12px ${getComputedStyle(document.body).fontFamily}` });
    for (const { name, outlines } of PAGE.places) {
      for (const outline of outlines) {
        pen.beginPath();
        for (const point of outline) pen.lineTo(...this.#at(point));
        pen.closePath();
        pen.fill();
        pen.stroke();
      }
      const corners = outlines.flat().map((point) => this.#at(point)), [xs, ys] = [0, 1].map((k) => corners.map((corner) => corner[k]));
      if (corners.length) pen.fillText(name, 0.5 * (Math.min(...xs) + Math.max(...xs)), Math.min(...ys) - 6);
    }
  }

  #path(pen) {
    const points = this.waypoints;
    if (points === null) return;
    // After its end the last leg goes on.
    const [a, b] = points.slice(-2), length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    const beyond = [b[0] + (100 * (b[0] - a[0])) / length, b[1] + (100 * (b[1] - a[1])) / length];
    pen.setLineDash([2, 7]);
    this.#line(pen, [b, beyond], color("path"), 2, 0.6);
    pen.setLineDash([]);
    this.#line(pen, points, color("path"), 2.5, 0.9);
    points.forEach((point, i) => {
      const [x, y] = this.#at(point);
      pen.beginPath();
      pen.arc(x, y, HANDLE, 0, 2 * Math.PI);
      pen.fillStyle = i === this.held ? color("path") : color("card");
      pen.fill();
      Object.assign(pen, { strokeStyle: color("path"), lineWidth: 2.5 });
      pen.stroke();
    });
  }

  /** Every link a capsule of its own length and width, the head with a nose and eyes, the fin a blade seen from above. */
  #robot(pen, body, { line, fin, angles }) {
    const n = body.width.length, outline = Math.max(1, 0.012 * this.scale * body.width[n - 1] * 10);
    if (Math.hypot(fin[0][0] - fin[fin.length - 1][0], fin[0][1] - fin[fin.length - 1][1]) > 1e-6) {
      this.#line(pen, fin, color("edge"), Math.max(4, 0.016 * this.scale));
      this.#line(pen, fin, color("fin"), Math.max(2.5, 0.011 * this.scale));
    }
    for (const isFill of [false, true]) {
      for (let i = 0; i < n; i++) {
        const wide = 2 * Math.max(body.width[i], 0.004) * this.scale, [tail, head] = [line[i], line[i + 1]];
        // Ends are round: a capsule begins half its width inside, unless the link is shorter than it is wide.
        const length = Math.hypot(head[0] - tail[0], head[1] - tail[1]), inside = Math.min(body.width[i], 0.45 * length) * 0.6;
        const along = [(head[0] - tail[0]) / length, (head[1] - tail[1]) / length];
        const ends = [tail, head].map((end, k) => [end[0] + (k ? -1 : 1) * inside * along[0], end[1] + (k ? -1 : 1) * inside * along[1]]);
        this.#line(pen, ends, isFill ? color(i % 2 ? "body-2" : "body") : color("edge"), isFill ? wide : wide + 2 * outline);
      }
    }
    const [x, y] = line[n], angle = angles[angles.length - 1], side = 0.5 * body.width[n - 1], back = 0.9 * body.width[n - 1];
    for (const turn of [1, -1]) {
      const eye = [
        x - back * Math.cos(angle) - turn * side * Math.sin(angle), y - back * Math.sin(angle) + turn * side * Math.cos(angle),
      ];
      pen.beginPath();
      pen.arc(...this.#at(eye), Math.max(1.3, 0.2 * body.width[n - 1] * this.scale), 0, 2 * Math.PI);
      pen.fillStyle = color("water");
      pen.fill();
    }
  }

  #ruler(pen, [vx, vy]) {
    const [width, height] = this.size, meters = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((one) => one * this.scale > 60) ?? 100;
    const right = width - 14, left = right - meters * this.scale, y = height - 14;
    Object.assign(pen, { strokeStyle: color("ink"), fillStyle: color("ink"), lineWidth: 1.5, textAlign: "center" });
    pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    pen.beginPath();
    for (const [x, up] of [[left, -5], [left, 0], [right, 0], [right, -5]]) pen.lineTo(x, y + up);
    pen.stroke();
    pen.fillText(`${meters} m`, 0.5 * (left + right), y - 5);
    const speed = Math.hypot(vx, vy);
    if (speed === 0) return;
    const [x0, y0] = [width - 34, 34], angle = Math.atan2(-vy, vx), size = 14;
    pen.beginPath();
    pen.moveTo(x0 - size * Math.cos(angle), y0 - size * Math.sin(angle));
    pen.lineTo(x0 + size * Math.cos(angle), y0 + size * Math.sin(angle));
    pen.stroke();
    this.#tip(pen, x0 + size * Math.cos(angle), y0 + size * Math.sin(angle), angle, 8);
    pen.textAlign = "right";
    pen.fillText(`current ${speed.toFixed(2)} m/s`, width - 12, y0 + 34);
  }

  // ---- fingers and mice ---------------------------------------------------------------------------------------------

  #place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  #waypointAt([x, y], reach) {
    const near = (this.waypoints ?? []).map((point) => Math.hypot(this.#at(point)[0] - x, this.#at(point)[1] - y));
    const i = near.indexOf(Math.min(...near));
    return near[i] < reach ? i : -1;
  }

  #down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    const place = this.#place(event);
    this.pointers.set(event.pointerId, place);
    this.held = this.pointers.size === 1 ? this.#waypointAt(place, event.pointerType === "touch" ? 28 : 15) : -1;
    this.dragged = false;
  }

  #moved(event) {
    const last = this.pointers.get(event.pointerId), place = this.#place(event);
    if (last === undefined) {
      this.canvas.style.cursor = this.#waypointAt(place, 15) < 0 ? "grab" : "move";
      return;
    }
    const before = [...this.pointers.values()];
    this.pointers.set(event.pointerId, place);
    const now = [...this.pointers.values()];
    this.dragged = true;
    if (this.held >= 0) {
      this.waypoints[this.held] = this.#world(place).map((one) => Math.round(100 * one) / 100);
      this.changed(this.waypoints);
    } else if (now.length === 2) {
      const apart = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]), middle = ([a, b]) => [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
      if (apart(before) > 0) this.#zoom(apart(now) / apart(before), middle(now));
    } else {
      this.follows = false;
      this.center[0] -= (place[0] - last[0]) / this.scale;
      this.center[1] += (place[1] - last[1]) / this.scale;
    }
  }

  #up(event) {
    this.pointers.delete(event.pointerId);
    this.held = -1;
  }

  /** A waypoint more at the end; or one less, if there is one here and two are left. */
  #double(event) {
    if (this.waypoints === null) return;
    const place = this.#place(event), i = this.#waypointAt(place, 20);
    if (i >= 0 && this.waypoints.length > 2) this.waypoints.splice(i, 1);
    else if (i < 0 && this.waypoints.length < MOST_WAYPOINTS) {
      this.waypoints.push(this.#world(place).map((one) => Math.round(100 * one) / 100));
    }
    this.changed(this.waypoints);
  }

  #zoom(by, place) {
    const fixed = this.#world(place), scale = Math.min(Math.max(this.scale * by, 8), 2000);
    this.scale = scale;
    if (!this.follows) {
      const moved = this.#world(place);
      this.center[0] += fixed[0] - moved[0];
      this.center[1] += fixed[1] - moved[1];
    }
  }
}
