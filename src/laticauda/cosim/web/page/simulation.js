"use strict";
/* A robot that swims: laticauda's compiled kernels (kernels.js) and the arrays of numbers that they work on (robots.js).
   What a step does is in the kernels; the steering, a few lines at the end, is held against Python by the tests. */

const compiledKernels = {};

/** The compiled kernels of a drag law. */
function kernelsOf(law) {
  compiledKernels[law] ??= WebAssembly.compile(Uint8Array.from(atob(KERNELS[law]), (letter) => letter.charCodeAt(0)));
  return compiledKernels[law];
}

class Swimmer {
  /** A robot of robots.js, at rest once `begin` was called. */
  static async of(body) {
    return new Swimmer(body, await WebAssembly.instantiate(await kernelsOf(body.law)));
  }

  constructor(body, instance) {
    const { memory, laticauda_move, laticauda_reserve, _initialize } = instance.exports;
    _initialize?.();
    const sizes = {
      whole: body.whole.length, real: body.real.length, values: body.first.length, rows: body.n_rows,
      valuesAhead: body.first.length, rowsAhead: body.n_rows,
    };
    const at = {};
    for (const name in sizes) at[name] = laticauda_reserve(8 * sizes[name]);
    // Only now: reserving may have moved the memory.
    for (const name in sizes) {
      const Kind = name === "whole" ? BigInt64Array : Float64Array;
      this[name] = new Kind(memory.buffer, at[name], sizes[name]);
    }
    this.whole.set(body.whole.map(BigInt));
    this.real.set(body.real);
    this.values.set(body.first);
    this.body = body;
    this.path = null; // what is followed how: the numbers of `Steering.step`; null: nothing
    this.steering = new Steering();
    this.failed = false;
    this.move = (interval) => laticauda_move(at.whole, at.real, at.values, at.rows, interval) === 1n;
    this.moveAhead = (interval) => laticauda_move(at.whole, at.real, at.valuesAhead, at.rowsAhead, interval) === 1n;
  }

  get(name) {
    return this.values[this.body.number[name]];
  }

  set(name, value) {
    this.values[this.body.number[name]] = value;
  }

  /** Straight and at rest at the origin. `offset` is that of the gait, without the steering [rad]. */
  begin(offset) {
    this.set("time", 0);
    this.steering = new Steering();
    this.steered = 0;
    this.#rest(offset);
    this.#ask();
    this.#rest(offset); // the first sample is under the first command
  }

  /** Take up other numbers of the water, which the kernels read at the start only, and go on from the same state. */
  takeUp() {
    const state = this.body.state.map((row) => this.rows[row]), values = this.values.slice();
    this.rows.fill(0);
    this.move(0);
    this.values.set(values);
    this.body.state.forEach((row, i) => { this.rows[row] = state[i]; });
  }

  /** Let the time between two samples go by, which is that between two control instants; `offset` as for `begin`. */
  step(offset) {
    if (this.failed) return;
    this.set("gait.offset", offset + this.steered);
    this.failed = !this.move(PAGE.interval);
    this.#ask();
  }

  #rest(offset) {
    this.set("gait.offset", offset + this.steered);
    this.rows.fill(0);
    this.failed = !this.move(0);
  }

  /** A control instant: what the steering adds to the offset until the next one. */
  #ask() {
    const seen = ["time", "center_of_mass.x", "center_of_mass.y", "heading"].map((name) => this.get(name));
    this.steered = this.path === null ? 0 : this.steering.step(this.path, ...seen);
  }

  /** The values some time after the last sample, for a picture in between [s]; the robot itself stays where it is. */
  ahead(time) {
    this.valuesAhead.set(this.values);
    if (time > 0) {
      this.rowsAhead.set(this.rows);
      this.moveAhead(time);
    }
    return this.valuesAhead;
  }
}

// ---- path following: `PathFollowing.step` of laticauda.control, for straight legs ------------------------------------

/** The same direction in [-pi, pi). */
function wrapped(angle) {
  const rest = angle % (2 * Math.PI);
  return rest >= Math.PI ? rest - 2 * Math.PI : rest < -Math.PI ? rest + 2 * Math.PI : rest;
}

class Steering {
  leg = 0;
  integral = 0; // y of the integral law [s]
  isSaturated = false;
  headings = []; // in the window, oldest first: time, heading, its integral
  error = NaN; // cross-track [m]
  headingRef = NaN; // [rad]

  /** One control instant: the offset until the next one [rad]. */
  step({ waypoints, lookAhead, integralGain, gain, maxOffset, window }, time, x, y, heading) {
    const dt = this.headings.length ? time - this.headings[this.headings.length - 1][0] : 0;
    const used = this.#mean(window, time, heading);
    const angleOf = (leg) => Math.atan2(waypoints[leg + 1][1] - waypoints[leg][1], waypoints[leg + 1][0] - waypoints[leg][0]);
    const seenFrom = ([x0, y0], angle) => {
      const c = Math.cos(angle), s = Math.sin(angle);
      return [c * (x - x0) + s * (y - y0), c * (y - y0) - s * (x - x0)];
    };
    this.leg = Math.min(this.leg, waypoints.length - 2);
    while (this.leg < waypoints.length - 2 && seenFrom(waypoints[this.leg + 1], angleOf(this.leg))[0] >= 0) this.leg += 1;
    const angle = angleOf(this.leg), error = (this.error = seenFrom(waypoints[this.leg], angle)[1]);
    if (!this.isSaturated) {
      const aim = error + integralGain * this.integral;
      this.integral += (dt * lookAhead * error) / (aim * aim + lookAhead * lookAhead);
    }
    const slope = (error + integralGain * this.integral) / lookAhead;
    this.headingRef = used + wrapped(wrapped(angle) - Math.atan(slope) - used);
    const asked = gain * wrapped(this.headingRef - used);
    this.isSaturated = Math.abs(asked) > maxOffset;
    return this.isSaturated ? Math.sign(asked) * maxOffset : asked;
  }

  /** The heading as its mean over a window, or as it is [rad]; see `HeadingEstimate.step`. */
  #mean(window, time, heading) {
    const last = this.headings[this.headings.length - 1];
    if (window === 0 || last === undefined) {
      this.headings = [[time, heading, 0]];
      return heading;
    }
    const integral = last[2] + 0.5 * (time - last[0]) * (last[1] + heading);
    const begin = Math.max(time - window, this.headings[0][0]);
    while (this.headings.length > 1 && this.headings[1][0] <= begin + 1e-9) this.headings.shift();
    this.headings.push([time, heading, integral]);
    const [[t0, first, before], [t1, second]] = this.headings;
    const there = first + ((begin - t0) / (t1 - t0)) * (second - first);
    return (integral - (before + 0.5 * (begin - t0) * (first + there))) / (time - begin);
  }
}

/** Where the parts of a robot are: center of mass, the body's line from tail to head, and the fin's [m]. */
function postureOf(body, values) {
  const x = values[body.number["center_of_mass.x"]], y = values[body.number["center_of_mass.y"]];
  const angles = body.angles.map((shares) => shares.reduce((sum, [i, factor]) => sum + factor * values[i], 0));
  const cos = angles.map(Math.cos), sin = angles.map(Math.sin);
  const point = (levers) => [
    levers.reduce((sum, lever, k) => sum + lever * cos[k], x), levers.reduce((sum, lever, k) => sum + lever * sin[k], y),
  ];
  return { center: [x, y], line: body.ends.map(point), fin: body.fin.map(point), angles };
}
