"""The errors of laticauda.

A bad argument is a `ValueError` that names the argument, the rule with its unit and the value
received; `laticauda.values.checks` raises them. Errors caused by the outside world rather than by
an argument derive from `LaticaudaError`.
"""

from laticauda.values.installation import advise_extra


class LaticaudaError(Exception):
    """Base of all errors raised by laticauda, apart from the `ValueError` for a bad argument."""


def as_sentence(text: str) -> str:
    """Return a text with a period at its end, unless it ends in a suggestion: "did you mean this?".

    Args:
        text: The text, without a final period.
    """
    if text.endswith("?"):
        return text
    return f"{text}."


class BadArgument(ValueError):
    """An argument that breaks a rule: a sentence for people, and its parts for callers that name it differently.

    Args:
        name: Name of the argument.
        rule: The rule with its unit, and the value received, without a final period.
    """

    def __init__(self, name: str, rule: str) -> None:
        super().__init__(name, rule)

    @property
    def name(self) -> str:
        """Name of the argument, with an index in brackets if it is one of several."""
        return self.args[0]

    @property
    def rule(self) -> str:
        """The rule with its unit, and the value received, without a final period."""
        return self.args[1]

    def __str__(self) -> str:
        """Return the sentence shown to the user."""
        return self.sentence_about(f"`{self.name}`")

    def sentence_about(self, subject: str, rule: str = "") -> str:
        """Return the sentence for people who know the argument by another name.

        Args:
            subject: What they call it, such as ``--robot``.
            rule: The rule with other arguments named as they call them; "": as it is.
        """
        return as_sentence(f"{subject} {rule or self.rule}")


class InfeasibleWarning(UserWarning):
    """A run demands more of a joint than the robot offers; the run itself went well."""


class UnitWarning(UserWarning):
    """A number that is accepted, but was probably meant in another unit."""


class ImplausibleWarning(UserWarning):
    """Something described that hardly is, such as a robot that sinks; the text says which unit was probably meant."""


class SkippedRowsWarning(UserWarning):
    """Rows of a table that are left out, because they lack what is asked for."""


class TableWarning(UserWarning):
    """A table that was not taken as it is written: whole turns, times since 1970, markers that were lost."""


class StoredResultsWarning(UserWarning):
    """Stored results that are damaged and made anew, or of which nobody can tell whether they are intact."""


class SimulationFailed(LaticaudaError, RuntimeError):
    """A run that blew up: the message states when, and what to try."""


class RunFailed(LaticaudaError, ValueError):
    """A figure asked of a run that did not reach its end, and has none: the message states how the run ended.

    Args:
        status: How the run ended, in a sentence.
    """

    def __init__(self, status: str) -> None:
        super().__init__(status)

    def __str__(self) -> str:
        """Return the sentence shown to the user."""
        return f"A run that failed has no figures: {self.args[0]}"


class TrialFileError(LaticaudaError, ValueError):
    """A trial file that cannot be read: the message states which file, and why."""


class RobotFileError(LaticaudaError, ValueError):
    """A wrong robot, water, ground or parameter file: the message states the file, key, rule and value."""


class StorageFailed(LaticaudaError, OSError):
    """Results that cannot be written or read, as on a full disk: the message states where, why, and what is left."""


class ClusterFailed(LaticaudaError, RuntimeError):
    """A failure of a computer cluster: the message states which one, what happened, and what is left."""


class MissingExtra(LaticaudaError, ImportError):
    """A feature that needs a package belonging to one of laticauda's extras.

    Args:
        feature: Requested feature, in words.
        package: Required package.
        extra: Extra of laticauda that installs the package.
    """

    def __init__(self, feature: str, package: str, extra: str) -> None:
        # All three are stored in `args`: an error that crosses a process boundary is rebuilt from
        # them.
        super().__init__(feature, package, extra)

    def __str__(self) -> str:
        """Return the sentence shown to the user."""
        feature, package, extra = self.args
        return f"{feature} needs {package}; {advise_extra(extra)}."


class MissingProgram(LaticaudaError, RuntimeError):
    """A feature that needs something that the operating system does not have.

    Args:
        feature: Requested feature, in words.
        program: What it needs.
        packages: Packages of Debian and Ubuntu that install it.
    """

    def __init__(self, feature: str, program: str, packages: str) -> None:
        super().__init__(feature, program, packages)

    def __str__(self) -> str:
        """Return the sentence shown to the user."""
        feature, program, packages = self.args
        return f"{feature} needs {program}; on Debian and Ubuntu run `apt-get install {packages}`."
