// node trials.js FOLDER: a trial of the page for each link that is read, one a line; one line of JSON each.
const { readFileSync } = require("node:fs");
const { join } = require("node:path");
const { runInThisContext } = require("node:vm");

const sources = ["kernels.js", "robots.js", "simulation.js", "setting.js"];
runInThisContext(sources.map((name) => readFileSync(join(process.argv[2], name), "utf8")).join("\n"));
const trial = runInThisContext(`async (link) => {
  const setting = fromLink(link), found = await trialOf(setting, 30);
  const { shell, python } = { shell: inShell(setting, 30), python: inPython(setting, 30) };
  return { link: toLink(setting), refusal: refusal(setting), csv: inCsv(found), figures: figuresOf(found), shell, python };
}`);
(async () => {
  for (const link of readFileSync(0, "utf8").split("\n")) console.log(JSON.stringify(await trial(link)));
})();
