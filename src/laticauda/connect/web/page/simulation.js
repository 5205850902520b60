"use strict";
/* A robot that swims: laticauda's compiled kernels (kernels.js) and the arrays of numbers that they work on (robots.js).
   What a step and a control instant do is in the kernels. */

const compiledKernels = {};

/** The compiled kernels of a name. */
function kernelsOf(name) {
  compiledKernels[name] ??= WebAssembly.compile(Uint8Array.from(atob(KERNELS[name]), (letter) => letter.charCodeAt(0)));
  return compiledKernels[name];
}

class Swimmer {
  /** A robot of robots.js, at rest once `begin` was called. */
  static async of(body) {
    Steering.instant ??= await instantOf();
    return new Swimmer(body, await WebAssembly.instantiate(await kernelsOf(body.kernels)));
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
    this.path = null; // what is followed how, as `Steering.step` takes it; null: nothing
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

// ---- path following: one control instant is compiled; here is what varies in length -----------------------------------

/** The compiled control instant, a function of numbers by their names. */
async function instantOf() {
  const { exports } = await WebAssembly.instantiate(await kernelsOf("steering")), { numbers, results } = PAGE.steering;
  exports._initialize?.();
  const at = exports.laticauda_reserve(8 * numbers.length), room = new Float64Array(exports.memory.buffer, at, numbers.length);
  return (given) => {
    room.set(numbers.map((name) => given[name]));
    exports.laticauda_steer(at);
    return Object.fromEntries(results.map((name, i) => [name, room[i]]));
  };
}

class Steering {
  static instant = null; // once there is a swimmer
  leg = 0;
  headings = []; // in the window, oldest first: time, heading, its integral
  found = { error: NaN, heading_ref: NaN, integral: 0, is_saturated: 0 };

  /** One control instant: the offset until the next one [rad]. */
  step({ waypoints, window, laws }, time, x, y, heading) {
    const { headings } = this, last = waypoints.length - 2, begin = Math.max(time - window, headings[0]?.[0] ?? time);
    while (headings.length > 1 && headings[1][0] <= begin + PAGE.steering.rounding) headings.shift();
    const now = [time, heading, 0], [[t1, heading1, integral1], [t2, heading2]] = [...headings.slice(0, 2), now, now];
    const [t3, heading3, integral3] = headings.at(-1) ?? now, { integral, is_saturated } = this.found;
    const seen = { time, x, y, heading, begin, t1, heading1, integral1, t2, heading2, t3, heading3, integral3, integral, is_saturated };
    for (this.leg = Math.min(this.leg, last); ; this.leg += 1) {
      const [[x0, y0], [x1, y1]] = waypoints.slice(this.leg);
      this.found = Steering.instant({ ...laws, ...seen, x0, y0, x1, y1 });
      if (this.leg === last || this.found.beyond < 0) break;
    }
    headings.push([time, heading, this.found.heading_integral]);
    return this.found.offset;
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
