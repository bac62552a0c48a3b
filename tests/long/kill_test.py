#!/usr/bin/env python3
"""kill_test.py TILTMAP FOLDER TIMES: kills `tiltmap register` with SIGKILL at random moments and looks whether the
project survived.

Each time: the file opens with `tiltmap info`, SQLite finds it whole, its scans, odometry and truth are those from
before, and the stage `pairwise` is either absent or complete. Exit 1 at the first time that is not so; the broken file
is left in FOLDER.
"""
import json
import pathlib
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time


def run(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)


def must(program, *arguments):
    done = run(program, *arguments)
    if done.returncode != 0:
        sys.exit(f"tiltmap {' '.join(map(str, arguments))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def poses(program, project, stage):
    return must(program, "poses", project, "--stage", stage, "--format", "tum")


def state(program, project):
    """What must not change while pairs are registered."""
    return (json.loads(must(program, "info", project, "--json"))["scans"],
            poses(program, project, "odometry"), poses(program, project, "truth"))


def check(program, project, before, stops):
    if state(program, project) != before:
        return "scans, odometry or truth changed"
    with sqlite3.connect(f"file:{project}?mode=ro", uri=True) as database:
        verdict = database.execute("PRAGMA integrity_check").fetchone()[0]
    database.close()
    if verdict != "ok":
        return f"SQLite says: {verdict}"
    stages = json.loads(must(program, "info", project, "--json"))["stages"]
    names = [stage["name"] if isinstance(stage, dict) else stage for stage in stages]
    if "pairwise" in names:
        count = sum(1 for line in poses(program, project, "pairwise").splitlines() if line.strip() and line[0] != "#")
        if count != stops:
            return f"the stage pairwise holds {count} of {stops} poses"
    return None


def copy(source, target):
    for path in target.parent.glob(target.name + "*"):
        path.unlink()
    shutil.copyfile(source, target)


def main():
    program, folder, times = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    original, work = folder / "original.tiltmap", folder / "work.tiltmap"
    must(program, "new", original)
    must(program, "simulate", original, "--experiment", "exp2fixed", "--quiet")
    before = state(program, original)

    copy(original, work)
    begin = time.monotonic()
    must(program, "register", work, "--quiet")
    whole = time.monotonic() - begin

    random.seed(1)
    killed = survived = 0
    while killed < times:
        if survived > 20 * times:
            sys.exit("the program was never still running when it was to be killed")
        copy(original, work)
        child = subprocess.Popen([program, "register", str(work), "--quiet"], stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0.0, whole))
        child.kill()
        if child.wait() != -signal.SIGKILL:
            survived += 1
            continue
        killed += 1
        problem = check(program, work, before, len(before[0]))
        if problem:
            sys.exit(f"after kill {killed}: {problem}; the file is {work}")
    print(f"killed {killed} times within {whole:.2f} s of registering ({survived} times it was done before)")


if __name__ == "__main__":
    main()
