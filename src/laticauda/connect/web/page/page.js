"use strict";
/* The page: what is set acts at once, and one clock moves robot, picture and plots. */

const $ = (id) => document.getElementById(id);
const PACES = [0.25, 0.5, 1, 2, 5, 10];
const TRIAL = 30; // [s]
const PATIENCE = 0.012; // of a frame that may be spent on swimming [s]; beyond it, time goes slower
const fresh = () => ({ first: null, frames: 0, spent: 0, most: 0 });

const page = {
  setting: fromLink(location.hash.slice(1)),
  swimmer: null, // none until the kernels are there
  offset: 0, // of the gait [rad]
  paused: false,
  pace: 1,
  rest: 0, // time that has gone by since the last sample [s]
  history: [], // samples of the last gait cycle: time, x, y, work
  timing: fresh(), // when the robot first moved [ms], and what frames cost [ms]
};

// ---- robot and clock ------------------------------------------------------------------------------------------------

/** Begin anew with what is set now. */
async function restart() {
  const swimmer = await Swimmer.of(bodyOf(page.setting));
  if (swimmer.body !== bodyOf(page.setting)) return; // somebody has chosen another one meanwhile
  const isOther = page.swimmer?.body !== swimmer.body;
  page.swimmer = swimmer;
  page.offset = apply(page.setting, swimmer);
  swimmer.begin(page.offset);
  page.rest = 0;
  page.history = [];
  view.forget();
  if (isOther || view.follows) view.home(swimmer.body);
  plots.forEach((plot) => plot.clear());
  sampled();
}

/** What is done with every sample. */
function sampled() {
  const { swimmer } = page, values = swimmer.values, get = (name) => swimmer.get(name);
  view.remember(values, swimmer.body);
  const time = get("time"), work = get("electrical_work") ?? get("mechanical_work");
  page.history.push([time, get("center_of_mass.x"), get("center_of_mass.y"), work]);
  const period = (2 * Math.PI) / get("gait.frequency");
  while (page.history.length > 2 && page.history[1][0] <= time - period + 1e-9) page.history.shift();
  const [first] = page.history, since = time - first[0], whole = since > 0 && since > period - PAGE.interval && Number.isFinite(period);
  page.speed = whole ? Math.hypot(get("center_of_mass.x") - first[1], get("center_of_mass.y") - first[2]) / since : NaN;
  const swum = ["x", "y"].map((axis, k) => get(`center_of_mass.${axis}`) - first[k + 1] - get(`current.${axis}`) * since);
  page.through = whole && Math.hypot(get("current.x"), get("current.y")) > 0 ? Math.hypot(...swum) / since : NaN;
  page.power = whole ? (work - first[3]) / since : NaN;
  const degrees = (one) => (one * 180) / Math.PI, n = swimmer.body.limits.length, now = (name) => degrees(get(name));
  const speed = Math.hypot(get("center_of_mass_velocity.x"), get("center_of_mass_velocity.y"));
  plots[0].add(time, speed, page.speed);
  plots[1].add(time, now("joint_angle[0]"), now(`joint_angle[${n >> 1}]`), now(`joint_angle[${n - 1}]`));
  plots[2].add(time, get("electrical_power") ?? get("mechanical_power"), page.power);
  plots[3].add(time, now("heading"), swimmer.path ? degrees(swimmer.steering.found.heading_ref) : NaN);
  page.error = swimmer.path ? swimmer.steering.found.error : NaN;
}

let last = null;
function frame(now) {
  requestAnimationFrame(frame);
  const { swimmer } = page, passed = last === null ? 0 : Math.min((now - last) / 1000, 0.1);
  last = now;
  if (swimmer === null) return;
  const begin = performance.now();
  let ran = 0;
  if (!page.paused && !swimmer.failed) {
    page.rest += passed * page.pace;
    while (page.rest >= PAGE.interval && !swimmer.failed) {
      swimmer.step(page.offset);
      sampled();
      page.rest -= PAGE.interval;
      ran += PAGE.interval;
      if (performance.now() - begin > 1000 * PATIENCE) page.rest = Math.min(page.rest, PAGE.interval);
    }
  }
  const values = swimmer.ahead(swimmer.failed ? 0 : page.rest), spent = performance.now() - begin, { timing } = page;
  if (!page.paused) {
    timing.frames += 1;
    timing.spent += spent;
    timing.most = Math.max(timing.most, spent);
    if (timing.first === null && values[swimmer.body.number.time] > 0) timing.first = now;
  }
  const current = ["current.x", "current.y"].map((name) => swimmer.get(name));
  view.draw(swimmer.body, values, current, page.paused ? 0 : passed * page.pace);
  show(values, passed, ran);
}

// ---- what is said ---------------------------------------------------------------------------------------------------

let smoothed = 1, shownAt = 0;
function show(values, passed, ran) {
  const now = performance.now();
  if (passed > 0 && !page.paused) smoothed += 0.02 * (ran / passed - smoothed);
  if (now - shownAt < 100) return; // numbers that change faster cannot be read
  shownAt = now;
  const { swimmer } = page, said = (number, digits, unit) => (Number.isFinite(number) ? `${number.toFixed(digits)} ${unit}` : "\u2013");
  const rows = [
    ["time", said(values[swimmer.body.number.time], 1, "s")],
    ["speed over a cycle", said(page.speed, 3, "m/s")],
    ...(Number.isFinite(page.through) ? [["through the water", said(page.through, 3, "m/s")]] : []),
    ["power over a cycle", said(page.power, 1, "W")],
    ...(swimmer.path ? [["beside the path", said(page.error, 2, "m")]] : []),
  ];
  $("readouts").innerHTML = rows.map(([name, value]) => `<dt>${name}</dt><dd>${value}</dd>`).join("");
  $("factor").textContent = page.paused ? "paused" : `${smoothed.toFixed(smoothed < 0.95 ? 2 : 1)} \u00d7 real time`;
  $("note").textContent = swimmer.failed ? "The motion has diverged; reset, or change a setting." : refusal(page.setting);
  plots.forEach((plot) => plot.draw());
}

let pending = 0;
/** After a change: link, texts, and figures of a trial from rest, a moment after the last change. */
function tell() {
  const { setting } = page;
  history.replaceState(null, "", `#${toLink(setting)}`);
  $("shell").textContent = inShell(setting, TRIAL);
  $("python").textContent = inPython(setting, TRIAL);
  for (const { slider, box, range, number } of page.sliders) {
    const has = numberOf(setting, slider);
    range.value = has;
    if (document.activeElement !== number) number.value = Number(has.toPrecision(6));
    box.classList.toggle("changed", isChanged(setting, slider));
    box.hidden = slider.variable !== "" && !(slider.variable in bodyOf(setting).number);
  }
  $("of-fin").hidden = Object.keys(robotOf(setting).fins).length < 2;
  $("integral_gain").hidden = setting.guidance !== "integral_line_of_sight";
  $("following").hidden = setting.waypoints === null;
  clearTimeout(pending);
  pending = setTimeout(async () => {
    const found = figuresOf(await trialOf(setting, TRIAL));
    $("basis").textContent = robotOf(setting).basis;
    $("figures").textContent = found.failed || refusal(setting)
      ? refusal(setting) || `The motion diverges after ${found.duration.toFixed(1)} s.`
      : inWords(setting, found);
  }, 150);
}

// ---- controls -------------------------------------------------------------------------------------------------------

/** Change the setting; a robot, a fin or a kind of gait begins anew, everything else acts on what swims. */
function change(what) {
  const before = page.setting;
  page.setting = { ...before, ...what };
  const { setting, swimmer } = page;
  if (setting.robot !== before.robot || setting.fin !== before.fin || setting.gait !== before.gait || swimmer === null) restart();
  else {
    const kept = swimmer.values.slice();
    page.offset = apply(setting, swimmer);
    if (PAGE.sliders.some(({ group, variable }) => ["water", "fin"].includes(group) && swimmer.get(variable) !== kept[swimmer.body.number[variable]])) {
      swimmer.takeUp();
    }
    if (swimmer.failed) restart();
  }
  view.waypoints = setting.waypoints;
  page.showChoices();
  tell();
}

function setNumber(slider, number) {
  if (!Number.isFinite(number)) return tell();
  const numbers = { ...page.setting.numbers, [slider.flag]: Math.min(Math.max(number, slider.low), slider.high) };
  if (numbers[slider.flag] === usual(page.setting, slider)) delete numbers[slider.flag];
  change({ numbers });
}

function element(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

function addSlider(parent, slider) {
  const { low: min, high: max, step } = slider, unit = slider.unit && ` [${slider.unit}]`;
  const range = element("input", { type: "range", min, max, step, id: slider.flag, title: slider.text });
  const number = element("input", { type: "number", min, max, step: "any", ariaLabel: slider.label });
  const label = element("label", { htmlFor: slider.flag, title: slider.text }, slider.label, element("small", {}, unit));
  const box = element("div", { className: "slider", id: slider.field === "integral_gain" ? slider.field : "" }, label, number, range);
  range.oninput = () => setNumber(slider, Number(range.value));
  range.ondblclick = () => setNumber(slider, usual(page.setting, slider));
  number.onchange = () => setNumber(slider, number.value === "" ? NaN : Number(number.value));
  parent.append(box);
  page.sliders.push({ slider, box, range, number });
}

function addChoice(parent, id, choices, shown, chosen) {
  const select = element("select", { id, ariaLabel: id }, ...choices.map((one) => element("option", { value: one }, shown(one))));
  select.onchange = () => chosen(select.value);
  parent.append(select);
  return select;
}

const plain = (name) => name.replaceAll("_", " ");
const fill = (select, choices) => select.replaceChildren(...choices.map((one) => element("option", { value: one }, plain(one))));

function build() {
  page.sliders = [];
  const names = PAGE.robots.map((one) => one.name);
  const robots = addChoice($("of-robot"), "robot", names, (name) => name, (robot) => {
    change({ robot, fin: Object.keys(PAGE.robots.find((one) => one.name === robot).fins)[0] });
  });
  const title = element("p", { className: "quiet" });
  $("of-robot").append(title);
  const gaits = addChoice($("of-gait"), "gait", gaitNames, plain, (gait) => change({ gait }));
  const fins = addChoice($("of-fin"), "fin", [], plain, (fin) => change({ fin }));
  const follow = element("input", { type: "checkbox", id: "follow" });
  follow.onchange = () => change({ waypoints: follow.checked ? newPath() : null });
  const following = element("div", { id: "following" });
  $("of-path").append(element("label", { className: "check" }, follow, "follow a path"), following);
  following.append(element("p", { className: "quiet" }, "Drag its points; a double click adds one, or removes one."));
  const guidance = addChoice(following, "guidance", PAGE.choices.guidance, plain, (one) => change({ guidance: one }));
  const heading = addChoice(following, "heading", PAGE.choices.heading_estimate, (one) => `heading: ${plain(one)}`, (one) => change({ headingEstimate: one }));
  for (const slider of PAGE.sliders) addSlider(slider.group === "path" ? following : $(`of-${slider.group}`), slider);
  page.showChoices = () => {
    const { setting } = page;
    fill(fins, Object.keys(robotOf(setting).fins));
    Object.assign(robots, { value: setting.robot });
    title.textContent = robotOf(setting).title;
    Object.assign(gaits, { value: setting.gait });
    Object.assign(fins, { value: setting.fin });
    Object.assign(guidance, { value: setting.guidance });
    Object.assign(heading, { value: setting.headingEstimate });
    follow.checked = setting.waypoints !== null;
  };
  for (const pace of PACES) $("pace").append(element("option", { value: pace, selected: pace === 1 }, `\u00d7 ${pace}`));
}

/** Some way to the right of where the robot heads, with a bend in it: so that it can be seen to come to it. */
function newPath() {
  const { swimmer } = page, x = swimmer.get("center_of_mass.x"), y = swimmer.get("center_of_mass.y"), angle = swimmer.get("heading");
  const place = (ahead, left) => [x + ahead * Math.cos(angle) - left * Math.sin(angle), y + ahead * Math.sin(angle) + left * Math.cos(angle)];
  return [place(0.2, -0.5), place(2.4, -0.5), place(3.8, 0.6), place(6, 0.6)].map((one) => one.map((number) => Math.round(100 * number) / 100));
}

function togglePause() {
  page.paused = !page.paused;
  $("play").textContent = page.paused ? "play" : "pause";
}

function toggleLecture() {
  const is = document.body.classList.toggle("lecture");
  if (is) document.documentElement.requestFullscreen?.().catch(() => {});
  else if (document.fullscreenElement) document.exitFullscreen();
}

async function copy(text, button) {
  try {
    await navigator.clipboard.writeText(text);
  } catch { // a page from a disk, or by plain http, may do it the old way only
    const area = element("textarea", { value: text });
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  const was = button.textContent;
  button.textContent = "copied";
  setTimeout(() => { button.textContent = was; }, 1200);
}

function download(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

function setTheme(dark) {
  document.documentElement.classList.toggle("dark", dark);
}

// ---- all together ---------------------------------------------------------------------------------------------------

const view = new View($("view"), (waypoints) => change({ waypoints: waypoints.map((point) => point.slice()) }));
const plots = [
  new Plot($("plots"), "speed", "m/s", ["now", "over a cycle"], 0.2, true),
  new Plot($("plots"), "joints", "\u00b0", ["tail", "middle", "head"], 40),
  new Plot($("plots"), "power", "W", ["now", "over a cycle"], 10, true),
  new Plot($("plots"), "heading", "\u00b0", ["now", "asked for"], 20),
];
build();
setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
$("version").textContent = `laticauda ${PAGE.version}`;
$("theme").onclick = () => setTheme(!document.documentElement.classList.contains("dark"));
$("lecture").onclick = toggleLecture;
$("play").onclick = togglePause;
$("reset").onclick = restart;
$("home").onclick = () => view.home(page.swimmer.body);
$("pace").onchange = () => { page.pace = Number($("pace").value); };
$("usual").onclick = () => { openSetting(firstSetting()); };
$("csv").onclick = async () => download("trial.csv", inCsv(await trialOf(page.setting, TRIAL)));
$("link").onclick = () => copy(location.href, $("link"));
for (const button of document.querySelectorAll(".copy")) button.onclick = () => copy($(button.dataset.of).textContent, button);
addEventListener("resize", () => { if (view.follows && page.swimmer) view.home(page.swimmer.body); });
addEventListener("keydown", (event) => {
  if (event.target.closest("input, select, textarea, button") && event.key !== "Escape") return;
  const action = { " ": togglePause, r: restart, f: () => view.home(page.swimmer.body), l: toggleLecture }[event.key.toLowerCase()];
  if (action === undefined || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  action();
});
document.addEventListener("fullscreenchange", () => { if (!document.fullscreenElement) document.body.classList.remove("lecture"); });

/** Show a setting from elsewhere, from rest. */
function openSetting(setting) {
  page.swimmer = null;
  change(setting);
}
addEventListener("hashchange", () => { if (location.hash.slice(1) !== toLink(page.setting)) openSetting(fromLink(location.hash.slice(1))); });
openSetting(page.setting);
requestAnimationFrame(frame);
