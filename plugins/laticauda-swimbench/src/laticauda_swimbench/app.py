"""`swimbench`: score policies, print the table, and regenerate what the benchmark is made of."""

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import tyro

from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import (
    BadFlag,
    FileArguments,
    Folder,
    NameList,
    OptionalFolder,
    parse_command,
)
from laticauda.cli.progress import SHARE, show_progress
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    check_choice,
    check_whole_number,
    option,
    quantity,
    value_class,
    write,
)
from laticauda_gym.packages import NotInstalled
from laticauda_swimbench.challenges import CHALLENGES, challenge

PROGRAM = "swimbench"
RESULTS = Path(__file__).parent / "results"
"""The baselines' score files."""
Policies = Annotated[NameList, tyro.conf.Positional]


@value_class
class List(Command):
    """List the scenarios and the baselines."""

    def run(self) -> Outcome:
        """Collect both."""
        from laticauda_swimbench.methods import NUMBERS

        lines = ["Scenarios:"]
        scenarios: dict[str, dict[str, Any]] = {}
        for name in CHALLENGES:
            scenario = challenge(name)
            lines.append(f"  {name:12} version {scenario.version}: {scenario.description}")
            scenarios[name] = {"version": scenario.version, "sha256": scenario.sha256}
        lines.append("Baselines:")
        for name, numbers in NUMBERS.items():
            lines.append(f"  {name:12} {numbers['note']}")
        facts = {"scenarios": scenarios, "baselines": list(NUMBERS)}
        return Outcome(facts=facts, text="\n".join(lines))


@value_class
class Score(Command):
    """Score policies in the scenarios: baselines by name, .onnx and .npz files, Python callables as module:name.

    Where {scenario} stands in such a name, there is one for each scenario. Without any, all
    baselines are scored, those that plan with CasADi. Each has its score file, and they are
    compared in the table.

    For example: swimbench score ilos my_policy.onnx my_module:act --output scores
    """

    policies: Policies = option("Policies to score; all baselines if omitted", default=())
    scenarios: NameList = option("Scenarios to score in", default=CHALLENGES)
    output: OptionalFolder = option("Folder for the score files, created if missing", default=None)

    def run(self) -> Outcome:
        """Score one after the other."""
        from laticauda_swimbench.methods import NUMBERS, Method, method
        from laticauda_swimbench.scoring import score
        from laticauda_swimbench.table import table

        for name in self.scenarios:
            check_choice("scenarios", name, CHALLENGES)
        methods: dict[str, Method] = {}
        missing: list[str] = []
        for policy in self.policies or NUMBERS:  # refuse a bad one before the first is scored
            try:
                methods[policy] = method(policy, self.scenarios)
            except NotInstalled as lack:
                if self.policies:
                    raise
                missing.append(f"Not scored: {policy}. {lack}")
        contents: list[dict[str, Any]] = []
        for policy, scored in methods.items():
            progress = show_progress(SHARE, what=f"scored {scored.name}", patience=2.0)
            content = score(scored, self.scenarios, progress)
            if self.output is not None:
                _write_scores(content, policy, Path(self.output))
            contents.append(content)
        seconds = sum(content["seconds"] for content in contents)
        text = f"{table(contents)}\n\nScored in {seconds:.0f} s."
        return Outcome(facts={"scores": contents}, text=text, problem="\n".join(missing))


def _write_scores(content: dict[str, Any], policy: str, folder: Path) -> None:
    from laticauda_swimbench.scoring import text_of

    folder.mkdir(parents=True, exist_ok=True)
    write(folder / f"{_file_name(policy)}.json", text_of(content))


def _file_name(policy: str) -> str:
    """Return a policy's file name without folder and extension, or both parts of module:name."""
    name = policy
    if Path(policy).suffix in (".onnx", ".npz"):
        name = Path(policy).stem
    return re.sub(r"[^\w.-]", "-", name)


@value_class
class Table(Command):
    """Print the table of score files, after a look at their checksums; of the baselines' own if there are none.

    For example: swimbench table scores/*.json
    """

    files: FileArguments = option("Score files", default=())
    baselines: bool = option("Include the baselines' own score files", default=False)

    def run(self) -> Outcome:
        """Read the files."""
        from laticauda_swimbench.scoring import read_scores
        from laticauda_swimbench.table import row, table

        files: list[str | Path] = list(self.files)
        if self.baselines or not self.files:
            files = [*sorted(RESULTS.glob("*.json")), *files]
        contents = [read_scores(file) for file in files]
        facts: dict[str, dict[str, Any]] = {}
        for content in contents:
            estimates = row(content)
            facts[content["method"]["name"]] = {
                name: estimate._asdict() for name, estimate in estimates.items()
            }
        return Outcome(facts=facts, text=table(contents))


@value_class
class Train(Command):
    """Train a learner in scenarios: hours for all of them. It goes on where it stopped, and needs stable-baselines3.

    For example: swimbench train ppo --steps 1000000 --output runs
    """

    learner: Annotated[str, tyro.conf.Positional] = option("ppo or sac")
    scenarios: NameList = option("Scenarios to learn in", default=CHALLENGES)
    seeds: tuple[int, ...] = quantity("", "Seeds of the runs", ge=0, default=(1, 2, 3, 4, 5))
    steps: int = quantity("", "Steps of each run", ge=1, default=1_000_000)
    output: Folder = option(
        "Folder for the runs and the networks, one .npz file per scenario", default="runs"
    )

    def run(self) -> Outcome:
        """Train all runs of a seed before those of the next."""
        from laticauda_swimbench.train import collect, train

        folder = Path(self.output)
        folder.mkdir(parents=True, exist_ok=True)
        seconds = 0.0
        for seed in self.seeds:
            for name in self.scenarios:
                challenge(name)
                progress = train(self.learner, name, seed, self.steps, folder, self._tell)
                seconds += progress["seconds"]
                collect(self.learner, name, folder, folder / f"{self.learner}-{name}.npz")
        return Outcome(
            facts={"seconds": seconds},
            text=f"Trained in {seconds:.0f} s; the networks are in {folder}.",
        )

    def _tell(self, line: str) -> None:
        self.announce({"told": line}, line)


@value_class
class Search(Command):
    """Search for the numbers of a scenario's reference, as they stand in its file. It needs cma."""

    scenario: Annotated[str, tyro.conf.Positional] = option("Scenario to search in")
    evaluations: int = quantity("", "Number of passes over all tuning episodes", ge=1, default=120)

    def run(self) -> Outcome:
        """Search, then swim the scored episodes with the result."""
        from laticauda_swimbench.search import ends, search

        check_whole_number("evaluations", self.evaluations, 1)
        numbers = search(
            self.scenario, self.evaluations, lambda line: self.announce({"told": line}, line)
        )
        scale = ends(self.scenario, numbers)._asdict()
        facts = {**scale, "laws": numbers}
        lines = [f"{name} = {number!r}" for name, number in {**scale, **numbers}.items()]
        return Outcome(facts=facts, text="\n".join(lines))


@value_class
class Missions(Command):
    """Score who steers by sensors alone in the two missions; all of their baselines if nothing is given.

    A policy is a baseline (reference, dead-reckoning, rest), a mission file *.toml, or module:name of
    a laticauda controller or its class.

    For example: swimbench missions my_mission.toml my_module:Controller --output scores
    """

    policies: Policies = option("Who is scored; all baselines if omitted", default=())
    missions: NameList = option("Missions to score in", default=("inspection", "station"))
    output: OptionalFolder = option("Folder for the score files, created if missing", default=None)

    def run(self) -> Outcome:
        """Score one after the other."""
        from laticauda_swimbench.missions import (
            BASELINES,
            mission_challenge,
            mission_table,
            score_missions,
            write_mission_scores,
        )

        for name in self.missions:
            mission_challenge(name)
        contents: list[dict[str, Any]] = []
        for policy in self.policies or BASELINES:
            content = score_missions(policy, self.missions)
            if self.output is not None:
                write_mission_scores(content, Path(self.output))
            contents.append(content)
        seconds = sum(content["seconds"] for content in contents)
        text = f"{mission_table(contents)}\n\nScored in {seconds:.0f} s."
        return Outcome(facts={"scores": contents}, text=text)


COMMANDS: dict[str, type[Command]] = {
    "list": List,
    "score": Score,
    "table": Table,
    "train": Train,
    "search": Search,
    "missions": Missions,
}


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: Words after the program's name; None takes those of this process.

    Returns:
        The exit status: 0 success, 2 bad input, 130 stopped by the user.
    """
    words = list(sys.argv[1:] if args is None else args)
    if not words or words[0] in ("-h", "--help"):
        _print_usage()
        return 0
    try:
        command = COMMANDS[check_choice("command", words[0], tuple(COMMANDS))]
        return parse_command(command, words[1:], f"{PROGRAM} {words[0]}")()
    except SystemExit as end:  # tyro has printed its help or an error
        return end.code if isinstance(end.code, int) else 2
    except KeyboardInterrupt:
        print(f"{PROGRAM}: stopped.", file=sys.stderr)
        return 130
    except (BadArgument, BadFlag, LaticaudaError, ValueError, OSError) as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 2


def _print_usage() -> None:
    print(f"usage: {PROGRAM} COMMAND; `{PROGRAM} COMMAND --help` explains a command.\n")
    for name, command in COMMANDS.items():
        first_line = (command.__doc__ or "").splitlines()[0]
        print(f"  {name:8} {first_line}")


if __name__ == "__main__":
    sys.exit(main())
