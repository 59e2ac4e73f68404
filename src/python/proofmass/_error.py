"""The one error type: what was tried, what was wrong, and what to do about it."""


class Error(Exception):
    """Something a person can act on.

    ``str(error)`` is what the command prints; its three parts stand alone too.
    """

    #: What was tried, as a clause: "could not read model.toml".
    attempt: str
    #: What was wrong, with file, line and column where they exist.
    cause: str
    #: What to do now.
    hint: str

    def __init__(self, attempt: str, cause: str, hint: str):
        super().__init__(attempt, cause, hint)
        self.attempt, self.cause, self.hint = attempt, cause, hint

    def __str__(self) -> str:
        return f"{self.attempt}\n  cause: {self.cause}\n  hint:  {self.hint}"
