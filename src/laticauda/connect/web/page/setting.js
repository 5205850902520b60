"use strict";
/* What can be set, as a value: a link, a command line and a piece of Python say the same. */

const MOST_WAYPOINTS = 40;
const gaitNames = Object.keys(PAGE.robots[0].fins[Object.keys(PAGE.robots[0].fins)[0]].kinds);

function firstSetting() {
  const robot = PAGE.robots[0];
  return {
    robot: robot.name, fin: Object.keys(robot.fins)[0], gait: gaitNames[0], numbers: {},
    waypoints: null, guidance: PAGE.choices.guidance[0], headingEstimate: PAGE.choices.heading_estimate[0],
  };
}

const robotOf = (setting) => PAGE.robots.find((one) => one.name === setting.robot);
const bodyOf = (setting) => robotOf(setting).fins[setting.fin];
const kindOf = (setting) => bodyOf(setting).kinds[setting.gait];

/** What a slider has if nobody moves it, in its own unit. */
function usual(setting, slider) {
  return kindOf(setting).water[slider.variable] ?? slider.usual;
}

function numberOf(setting, slider) {
  return setting.numbers[slider.flag] ?? usual(setting, slider);
}

/** The sliders that say something about this robot. */
function slidersOf(setting) {
  return PAGE.sliders.filter((one) => one.variable === "" || one.variable in bodyOf(setting).number);
}

const isChanged = (setting, slider) => numberOf(setting, slider) !== usual(setting, slider);

/** Give a robot the numbers of a setting; returns the offset of its gait [rad]. */
function apply(setting, swimmer) {
  const body = swimmer.body, si = {};
  for (const slider of PAGE.sliders) {
    const number = numberOf(setting, slider) * slider.factor;
    si[slider.flag] = number;
    if (slider.variable in body.number) swimmer.set(slider.variable, number);
  }
  kindOf(setting).envelope.forEach((share, i) => swimmer.set(`gait.envelope[${i}]`, share));
  // The longest step at which no element's drag makes it shake, as the models of laticauda choose it.
  const rates = body.slopes.map(([p, q, c, m, k, d]) => (p + q * swimmer.values[c]) / (m + k * swimmer.values[d]));
  swimmer.set("dt", Math.min(body.dt, 1 / Math.max(...rates)));
  swimmer.path = setting.waypoints && {
    waypoints: setting.waypoints,
    window: setting.headingEstimate === "raw" ? 0 : (2.0 * Math.PI) / si["frequency-deg-s"],
    laws: {
      look_ahead_distance: si["look-ahead-distance"],
      integral_gain: setting.guidance === "integral_line_of_sight" ? si["integral-gain"] : 0,
      gain: si["gain"],
      max_offset: si["max-offset-deg"],
    },
  };
  return si["offset-deg"];
}

/** Why laticauda would refuse a setting; "" if it would not. */
function refusal(setting) {
  if (setting.waypoints === null) return "";
  const number = (flag) => numberOf(setting, PAGE.sliders.find((one) => one.flag === flag)) * Math.PI / 180;
  const used = number("amplitude-deg"), steered = number("max-offset-deg") + Math.abs(number("offset-deg"));
  const beyond = bodyOf(setting).limits.findIndex((limit, i) => used * Math.abs(kindOf(setting).envelope[i]) + steered > limit);
  if (number("frequency-deg-s") === 0 && setting.headingEstimate !== "raw") return "The mean over a cycle needs a frequency.";
  return beyond < 0 ? "" : `With this steering joint ${beyond} may go beyond its limit; laticauda refuses that.`;
}

// ---- links ----------------------------------------------------------------------------------------------------------

/** The part of a link behind #, with all that differs from the first setting. */
function toLink(setting) {
  const found = new URLSearchParams(), first = firstSetting();
  if (setting.robot !== first.robot) found.set("robot", setting.robot);
  if (setting.fin !== Object.keys(robotOf(setting).fins)[0]) found.set("fin", setting.fin);
  if (setting.gait !== first.gait) found.set("gait", setting.gait);
  for (const slider of PAGE.sliders) if (isChanged(setting, slider)) found.set(slider.flag, numberOf(setting, slider));
  if (setting.waypoints !== null) found.set("waypoints", setting.waypoints.flat().join(" "));
  if (setting.guidance !== first.guidance) found.set("guidance", setting.guidance);
  if (setting.headingEstimate !== first.headingEstimate) found.set("heading-estimate", setting.headingEstimate);
  return found.toString();
}

/** The setting of a link; what it does not say, or says wrongly, is as at first. */
function fromLink(text) {
  const said = new URLSearchParams(text), setting = firstSetting();
  const among = (name, choices, first) => (choices.includes(said.get(name)) ? said.get(name) : first);
  setting.robot = among("robot", PAGE.robots.map((one) => one.name), setting.robot);
  const fins = Object.keys(robotOf(setting).fins);
  setting.fin = among("fin", fins, fins[0]);
  setting.gait = among("gait", gaitNames, setting.gait);
  setting.guidance = among("guidance", PAGE.choices.guidance, setting.guidance);
  setting.headingEstimate = among("heading-estimate", PAGE.choices.heading_estimate, setting.headingEstimate);
  for (const slider of PAGE.sliders) {
    const number = said.has(slider.flag) ? Number(said.get(slider.flag)) : NaN;
    if (Number.isFinite(number)) setting.numbers[slider.flag] = Math.min(Math.max(number, slider.low), slider.high);
  }
  const points = (said.get("waypoints") ?? "").split(" ").map(Number);
  if (points.length >= 4 && points.length % 2 === 0 && points.length <= 2 * MOST_WAYPOINTS && points.every(Number.isFinite)) {
    setting.waypoints = [];
    for (let i = 0; i < points.length; i += 2) setting.waypoints.push([points[i], points[i + 1]]);
  }
  return setting;
}

// ---- the same elsewhere ---------------------------------------------------------------------------------------------

/** The sliders that a text names: those of the gait that make it one, and what was changed. */
function named(setting) {
  const always = ["amplitude-deg", "frequency-deg-s", "phase-shift-deg"];
  return slidersOf(setting).filter((one) => one.group !== "path" && (always.includes(one.flag) || isChanged(setting, one)));
}

function ofPath(setting) {
  return setting.waypoints === null ? [] : PAGE.sliders.filter((one) => one.group === "path" && isChanged(setting, one)
    && (one.field !== "integral_gain" || setting.guidance === "integral_line_of_sight"));
}

const spelled = (name) => name.replaceAll("_", "-");
const rigidityOf = (setting) => numberOf(setting, PAGE.sliders.find((one) => one.group === "fin"));
const currentOf = (setting) => PAGE.sliders.filter((one) => one.group === "current").map((one) => numberOf(setting, one));

/** The fin as it swims, and what of it is not as the robot's own file has it. */
function finOf(setting) {
  const fin = { ...bodyOf(setting).plate }, own = Object.values(robotOf(setting).fins)[0].plate;
  if (fin.n_hinges) fin.flexural_rigidity = rigidityOf(setting);
  return { fin, changed: Object.entries(fin).filter(([name, number]) => number !== own[name]) };
}

/** Lines for a shell that run the setting from straight and at rest. */
function inShell(setting, duration) {
  let robot = setting.robot, lines = "";
  const { fin, changed } = finOf(setting);
  if (changed.length) {
    const numbers = Object.entries(fin).map(([name, number]) => `${name} = ${JSON.stringify(number)}\n`).join("");
    lines = `cat > robot.toml <<'END'\nkind = "robot"\nextends = "${robot}"\nname = "${robot}"\n\n[caudal_fin]\n${numbers}END\n`;
    robot = "robot.toml";
  }
  const follows = setting.waypoints !== null, words = [`laticauda ${follows ? "follow" : "swim"} --robot ${robot}`];
  if (robotOf(setting).parameters) words.push(`--parameters ${robotOf(setting).parameters}`);
  if (setting.gait !== gaitNames[0]) words.push(`--gait ${spelled(setting.gait)}`);
  for (const one of [...named(setting), ...ofPath(setting)]) {
    if (one.group !== "current" && one.group !== "fin") words.push(`--${one.flag} ${numberOf(setting, one)}`);
  }
  if (currentOf(setting).some((one) => one !== 0)) words.push(`--current ${currentOf(setting).join(" ")}`);
  if (follows) {
    words.push(`--waypoints ${setting.waypoints.flat().join(" ")}`, "--position 0 0");
    if (setting.guidance !== PAGE.choices.guidance[0]) words.push(`--guidance ${spelled(setting.guidance)}`);
    if (setting.headingEstimate !== "raw") words.push(`--heading-estimate ${setting.headingEstimate}`);
  }
  return `${lines}${[...words, `--duration ${duration}`].join(" \\\n  ")}\n`;
}

/** A script in Python that does the same; its `trial` is the run. */
function inPython(setting, duration) {
  const by = (group, sliders) => sliders.filter((one) => one.group === group)
    .map((one) => `${one.group === "water" ? one.field : spelled(one.flag).replaceAll("-", "_")}=${numberOf(setting, one)}`);
  const water = by("water", named(setting)), { changed } = finOf(setting);
  const lines = [`gait = lc.${setting.gait}(${by("gait", named(setting)).join(", ")})`];
  let robot = `"${setting.robot}"`, motion = "gait";
  if (changed.length) {
    lines.push(`robot = lc.load_robot(${robot})`,
      `fin = replace(robot.caudal_fin, ${changed.map(([name, number]) => `${name}=${number}`).join(", ")})`,
      "robot = replace(robot, caudal_fin=fin)");
    robot = "robot";
  }
  if (setting.waypoints !== null) {
    const points = setting.waypoints.map(([x, y]) => `(${x}, ${y})`).join(", "), said = by("path", ofPath(setting));
    if (setting.guidance !== PAGE.choices.guidance[0]) said.push(`guidance="${setting.guidance}"`);
    if (setting.headingEstimate !== "raw") said.push(`heading_estimate="${setting.headingEstimate}"`);
    lines.push(`following = lc.Following(${[`waypoints=(${points})`, ...said].join(", ")})`);
    motion = "following.controller(gait)";
  }
  const current = currentOf(setting).some((one) => one !== 0) ? `, current=(${currentOf(setting).join(", ")})` : "";
  const { parameters } = robotOf(setting), identified = parameters ? `, parameters="${parameters}"` : "";
  lines.push(`scenario = lc.build_scenario(${robot}, ${motion}, ${duration}${identified}${current})`);
  if (water.length) lines.push(`water = replace(scenario.environment, ${water.join(", ")})`, "scenario = replace(scenario, environment=water)");
  lines.push("trial = lc.swim(scenario)", "print(trial.forward_velocity, trial.mean_power)");
  const imports = `${changed.length || water.length ? "from dataclasses import replace\n\n" : ""}import laticauda as lc\n\n`;
  return `${imports}${lines.join("\n")}\n`;
}

// ---- a trial --------------------------------------------------------------------------------------------------------

/** A run of a setting from straight and at rest: one row of all values per sample. */
async function trialOf(setting, duration) {
  const swimmer = await Swimmer.of(bodyOf(setting)), rows = [];
  const offset = apply(setting, swimmer);
  swimmer.begin(offset);
  rows.push(swimmer.values.slice());
  for (let k = 0; k < Math.round(duration / PAGE.interval) && !swimmer.failed; k++) {
    swimmer.step(offset);
    if (!swimmer.failed) rows.push(swimmer.values.slice());
  }
  return { rows, body: swimmer.body, failed: swimmer.failed };
}

/** Its figures, as `Trial` has them: displacement per second (5), power of the joints, their quotient. */
function figuresOf({ rows, body, failed }) {
  const last = rows[rows.length - 1], value = (name) => last[body.number[name]] - rows[0][body.number[name]];
  const duration = value("time"), electrical = "electrical_work" in body.number;
  const speed = Math.hypot(value("center_of_mass.x"), value("center_of_mass.y")) / duration;
  const power = value(electrical ? "electrical_work" : "mechanical_work") / duration;
  const current = ["x", "y"].map((axis) => last[body.number[`current.${axis}`]]);
  const swum = ["x", "y"].map((axis, k) => value(`center_of_mass.${axis}`) / duration - current[k]);
  const through = current.some((one) => one !== 0) ? Math.hypot(...swum) : NaN;
  return { failed, duration, speed, through, power, electrical, share: shareOf({ rows, body }) };
}

/** The largest share of a joint's angle and of its motor's torque at its speed that a run takes, after its first cycle; NaN if
 * no motor is stated. A motor that is turned by the water brakes, which is not beyond it. */
function shareOf({ rows, body }) {
  if (body.motors.length === 0) return NaN;
  const at = (row, name) => row[body.number[name]];
  const end = 2 * Math.PI / at(rows[0], "gait.frequency"), settled = rows.filter((row) => at(row, "time") >= end);
  let most = 0;
  for (const row of settled.length ? settled : rows) {
    body.motors.forEach(([stallTorque, noLoadSpeed], i) => {
      const duty = at(row, `joint_torque[${i}]`) / stallTorque + at(row, `joint_rate[${i}]`) / noLoadSpeed;
      most = Math.max(most, Math.abs(duty), Math.abs(at(row, `joint_angle[${i}]`)) / body.limits[i]);
    });
  }
  return most;
}

/** What was measured in just this setting: speed and power, either may be null; undefined if nothing was. */
function measuredIn(setting) {
  const moved = setting.waypoints !== null || currentOf(setting).some((one) => one !== 0);
  if (moved || setting.fin !== Object.keys(robotOf(setting).fins)[0]) return undefined;
  const sliders = ["amplitude-deg", "frequency-deg-s", "phase-shift-deg"].map((flag) => PAGE.sliders.find((one) => one.flag === flag));
  const numbers = sliders.map((one) => numberOf(setting, one) * one.factor);
  const offset = PAGE.sliders.find((one) => one.flag === "offset-deg");
  if (numberOf(setting, offset) !== 0) return undefined;
  return robotOf(setting).measured.find((one) => one.gait === setting.gait && one.numbers.every((number, i) => Math.abs(number - numbers[i]) < 1e-6));
}

/** The figures of a trial in words: speed, power and whether the robot can do it, beside what was measured. */
function inWords(setting, { speed, through, power, electrical, share }) {
  const measured = measuredIn(setting), tank = (number, digits) => (number ? ` (tank ${number.toFixed(digits)})` : "");
  const kind = electrical ? "electrical" : "mechanical", used = `${(100 * share).toFixed(0)} % of angle, speed and torque`;
  const moving = Number.isFinite(through) ? ` over ground, ${through.toFixed(3)} m/s through the water` : "";
  const words = [`speed ${speed.toFixed(3)} m/s${moving}${tank(measured?.speed, 3)}`, `power ${power.toFixed(electrical ? 0 : 2)} W ${kind}${electrical ? tank(measured?.power, 0) : ""}`];
  if (share <= 1) words.push(`the joints can do it: they use ${used}`);
  if (share > 1) words.push(`the joints cannot do it: they would need ${used}`);
  return `${words.join("; ")}.`;
}

/** A trial as text, columns as `laticauda trial convert` writes them. */
function inCsv({ rows, body }) {
  const head = body.columns.map(([name]) => name).join(",");
  return [head, ...rows.map((row) => body.columns.map(([, i]) => row[i]).join(","))].join("\n") + "\n";
}
