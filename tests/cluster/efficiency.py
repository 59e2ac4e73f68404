#!/usr/bin/env python3
"""Processor time of a study in 16 shards and their merge beside that of the undivided study, in one run; and the time that
merging 1000 shards takes.

    tests/cluster/efficiency.py PROGRAM STUDY.toml MEMBERS SHORT-STUDY.toml

Shards and the whole take turns, so that what else the machine does weighs on both.
"""
import json, os, resource, shutil, subprocess, sys, tempfile, time

program, study, members, short = sys.argv[1:5]
home = tempfile.mkdtemp()


def seconds(*arguments):
    """Processor time and wall time of one command, and what it prints."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    out = subprocess.run([program, "--json", *arguments], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return spent, time.monotonic() - begun, json.loads(out)


def study_of(out, count, *more, study=study):
    return seconds("study", study, "--backend", "cpu", "--members", str(count), "--out", os.path.join(home, out), *more)


def timeless(document):
    return {name: value for name, value in document.items() if name not in ("seconds", "backend", "out", "shards")}


shards, wholes = [], []
for k in range(16):
    shards.append(study_of("shards", members, "--shard", f"{k + 1}/16")[0])
    if k in (3, 11):
        spent, _, whole = study_of("whole", members)
        wholes.append(spent)
merge, _, merged = seconds("merge", os.path.join(home, "shards"))
assert timeless(whole) == timeless(merged), "another answer"
whole = sum(wholes) / len(wholes)
print(f"{members} members, {merged['member_steps']:.3g} member-steps: undivided {wholes[0]:.2f} and {wholes[1]:.2f} s, "
      f"16 shards {sum(shards):.2f} s, merge {merge:.2f} s: efficiency {100 * whole / (sum(shards) + merge):.1f} %", flush=True)

many = 1000
for k in range(many):
    study_of("many", 256 * many, "--shard", f"{k + 1}/{many}", study=short)
size = sum(entry.stat().st_size for entry in os.scandir(os.path.join(home, "many")))
spent, wall, _ = seconds("merge", os.path.join(home, "many"))
print(f"merging {many} shards of {256 * many} members, {size / 1e6:.0f} MB: {wall:.2f} s ({spent:.2f} s of processor time)")
shutil.rmtree(home)
