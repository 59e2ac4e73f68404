"""The command that pip installs behaves as the program does: exit codes, errors, signals."""

import os
import signal
import subprocess
import sys
import time

import pytest

LONG = """
name = "long"
members = 100000000
duration_s = 1000.0
step_s = 0.001
[accelerometer]
bias_mg = { mean = 0.0, sd = 1.0 }
"""


def test_help_version_and_errors(command):
    import proofmass

    assert command.run("--version").stdout.split() == ["proofmass", proofmass.__version__]
    assert "Usage: proofmass" in command.run("--help").stdout
    wrong = command.run("stduy")
    assert wrong.returncode == 2 and wrong.stderr.startswith("error: ") and "hint:" in wrong.stderr
    absent = command.run("study", "nowhere.toml")
    assert absent.returncode == 2 and "nowhere.toml" in absent.stderr and "Traceback" not in absent.stderr


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_signals_stop_it_with_their_codes_and_the_state_is_kept(command, number, code):
    (command.folder / "long.toml").write_text(LONG)
    words = [sys.executable, "-m", "proofmass", "study", "long.toml", "--backend", "cpu", "--out", "out"]
    with subprocess.Popen(words, cwd=command.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        # Signals are heard before the folder is locked.
        while not (command.folder / "out" / ".proofmass.json").exists() and run.poll() is None:
            time.sleep(0.01)
        time.sleep(1)
        run.send_signal(number)
        _, said = run.communicate(timeout=60)
    assert run.returncode == code, said
    assert "--resume" in said and "Traceback" not in said


@pytest.mark.skipif(os.name != "posix", reason="pipes are POSIX's")
def test_a_reader_that_has_seen_enough_ends_it_quietly(command):
    line = f"{sys.executable} -m proofmass candidates | head -n 1"
    done = subprocess.run(line, shell=True, cwd=command.folder, capture_output=True, text=True, timeout=60)
    assert done.stdout and done.stderr == ""


def test_it_starts_without_numpy(command):
    script = "import sys; sys.modules['numpy'] = None; import proofmass; sys.argv = ['proofmass', '--version']; proofmass.main()"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
