#!/usr/bin/env python3
"""kill_test.py TILTMAP FOLDER TIMES: kills `tiltmap import`, `register` and `relax` with SIGKILL at random moments, TIMES
each, and looks whether the project survived.

Each time: the file opens with `tiltmap info`, `tiltmap verify` finds it whole, what was there before is there bit for bit, and what
the command adds is either absent or complete: all scans of the import, or a stage with a pose for each scan. Exit 1 at the first
time that is not so; the broken file is left in FOLDER. A command that the program does not have is left out, and said so.
"""
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

STOPS = 14


def run(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)


def must(program, *arguments):
    done = run(program, *arguments)
    if done.returncode != 0:
        sys.exit(f"tiltmap {' '.join(map(str, arguments))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def info(program, project):
    return json.loads(must(program, "info", project, "--json"))


def poses(program, project, stage):
    return must(program, "poses", project, "--stage", stage, "--format", "tum")


def copy(source, target):
    for path in target.parent.glob(target.name + "*"):
        path.unlink()
    shutil.copyfile(source, target)


class Case:
    """One command, the project it starts from, and what it may leave behind."""

    def __init__(self, program, name, original, words, stage=None):
        self.program, self.name, self.original, self.words, self.stage = program, name, original, words, stage
        self.before = info(program, original)
        self.kept = {stage: poses(program, original, stage) for stage in self.before["stages"]}

    def arguments(self, project):
        return [self.program, self.words[0], str(project), *map(str, self.words[1:]), "--quiet"]

    def problem(self, project):
        """What is wrong with the project, or nothing; and whether the command's edit is in it."""
        whole = run(self.program, "verify", project)
        if whole.returncode != 0:
            return whole.stderr, False
        after = info(self.program, project)
        if self.stage is None:
            added = len(after["scans"]) - len(self.before["scans"])
            if added not in (0, STOPS):
                return f"{added} of {STOPS} scans were added", False
            return None, added > 0
        for stage, text in self.kept.items():
            if stage != self.stage and poses(self.program, project, stage) != text:
                return f"the stage {stage} changed", False
        if after["scans"] != self.before["scans"]:
            return "the scans changed", False
        if self.stage not in after["stages"]:
            return None, False
        count = sum(1 for line in poses(self.program, project, self.stage).splitlines() if line.strip())
        if count != len(self.before["scans"]):
            return f"the stage {self.stage} holds {count} of {len(self.before['scans'])} poses", True
        return None, True


def kill_at_random(case, work, times):
    copy(case.original, work)
    begin = time.monotonic()
    subprocess.run(case.arguments(work), check=True, stdout=subprocess.DEVNULL)
    whole = time.monotonic() - begin
    killed = survived = accepted = 0
    while killed < times:
        if survived > 20 * times + 100:
            sys.exit(f"{case.name} was never still running when it was to be killed")
        copy(case.original, work)
        child = subprocess.Popen(case.arguments(work), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0.0, whole))
        child.kill()
        if child.wait() != -signal.SIGKILL:
            survived += 1
            whole = max(0.02, 0.8 * whole)  # the machine has become quicker
            continue
        killed += 1
        whole *= 1.05
        problem, there = case.problem(work)
        accepted += there
        if problem:
            sys.exit(f"{case.name}, after kill {killed}: {problem}; the file is {work}")
    print(f"{case.name}: killed {killed} times, at the end within {whole:.2f} s; the edit was already in {accepted} times "
          f"({survived} times the command was done before)", flush=True)


def main():
    program, folder, times = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    empty, simulated, registered = folder / "empty.tiltmap", folder / "simulated.tiltmap", folder / "registered.tiltmap"
    must(program, "new", empty)
    copy(empty, simulated)
    must(program, "simulate", simulated, "--experiment", "exp2fixed", "--quiet")
    copy(simulated, registered)
    must(program, "register", registered, "--quiet")
    must(program, "export", simulated, folder / "scan.pcd", "--per-scan", "--colour", "none", "--quiet")
    files = sorted(folder.glob("scan*.pcd"))

    cases = [Case(program, "import", empty, ["import", *files]),
             Case(program, "register", simulated, ["register"], "pairwise")]
    if run(program, "parameters", "relax").returncode == 0:
        cases.append(Case(program, "relax", registered, ["relax"], "relaxed"))
    else:
        print("relax: left out, the program has no such command")
    random.seed(1)
    for case in cases:
        kill_at_random(case, folder / "work.tiltmap", times)


if __name__ == "__main__":
    main()
