"""The command that the package brings, for comparison with its functions."""

import json
import subprocess
import sys

import pytest


class Command:
    """``python -m proofmass`` in a folder of its own."""

    def __init__(self, folder):
        self.folder = folder

    def run(self, *words, **options):
        whole = [sys.executable, "-m", "proofmass", *map(str, words)]
        return subprocess.run(whole, cwd=self.folder, capture_output=True, text=True, timeout=300, **options)

    def json(self, *words):
        done = self.run("--json", *words)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)


@pytest.fixture
def command(tmp_path):
    return Command(tmp_path)
