#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts small faults into the code, one at a time, and counts how many the tests notice.

Each mutant is built in a copy of the tree. The unit tests that link it judge first, then all others. A mutant that does
not compile is no mutant; another one is drawn. Those that no test can notice stand with their reason in
unnoticeable.txt and are not drawn. The last line printed is `score NN %`.
"""
import argparse
import collections
import json
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import mutants  # noqa: E402

TOP = Path(__file__).resolve().parents[2]
# Where a fault would reach the beam, the hand or a figure. Programs' flags and drawings are looked at by other tests.
FOLDERS = [
    "common/bus", "common/codec", "common/control", "common/geometry", "common/protocol", "common/recording",
    "common/reporting", "common/robot", "common/runtime", "common/streaming", "common/vision", "common/workpiece",
    "master", "slave", "netem/core", "netem/verify", "experiments/simulation",
]


children = set()


def end(child):
    """Ends a command with all that it started."""
    try:
        os.killpg(child.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def run(words, folder, seconds, log):
    """The exit code of a command, or None if it took longer than `seconds`. Nothing of it is left running."""
    with open(log, "a", encoding="utf-8") as file:
        child = subprocess.Popen(words, cwd=folder, stdout=file, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                 start_new_session=True)
        children.add(child)
        try:
            return child.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        finally:
            end(child)
            child.wait()
            children.discard(child)


class Worker:
    """A copy of the tree with a build of its own, in `folder`."""

    def __init__(self, folder, compile_jobs):
        # The build lies in the copy, as it does in a checkout: only then does ccache find what that one compiled.
        self.folder, self.source, self.build = folder, folder / "source", folder / "source" / "build"
        self.log = folder / "log.txt"
        self.compile_jobs = compile_jobs
        self.seconds = {}

    def prepare(self, seconds=None):
        """Copies the tracked files and builds everything. `seconds`: what each unit test takes; without it they are run,
        and must be green."""
        for entry in self.source.iterdir() if self.source.exists() else []:
            if entry != self.build:
                shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
        names = subprocess.run(["git", "-C", TOP, "ls-files", "-z"], check=True, capture_output=True).stdout
        for name in names.decode().rstrip("\0").split("\0"):
            if (TOP / name).exists():
                (self.source / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(TOP / name, self.source / name)  # as of now: what was built of a mutant is older
        self.log.write_text("")
        # As build/ is, so that ccache finds what was compiled there.
        cache = TOP / "build" / "CMakeCache.txt"
        werror = cache.exists() and "TELEKERF_WERROR:BOOL=ON" in cache.read_text(encoding="utf-8")
        configured = run(["cmake", "-S", self.source, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                          f"-DTELEKERF_WERROR={'ON' if werror else 'OFF'}"], self.folder, 300, self.log)
        if configured != 0 or self.compile([]) != 0:
            sys.exit(f"mutation: the tree as it is does not build: see {self.log}")
        tests = json.loads(subprocess.run(["ctest", "--show-only=json-v1", "-L", "unit"], cwd=self.build, check=True,
                                          capture_output=True).stdout)["tests"]
        names = {Path(test["command"][0]).name for test in tests if test.get("command")}
        # The others judge with the system tests; test_structure looks at the text, not at what it does.
        self.tests = sorted(name for name in names if name.startswith("test_") and name != "test_structure")
        if seconds:
            self.seconds = seconds
            return
        for name in self.tests:
            begun = time.monotonic()
            if self.test(name, 300) != 0:
                sys.exit(f"mutation: {name} is red without a mutant: see {self.log}")
            self.seconds[name] = time.monotonic() - begun

    def compile(self, targets):
        return run(["ninja", "-C", self.build, "-j", str(self.compile_jobs), *targets], self.folder, 7200, self.log)

    def test(self, name, seconds):
        return run([self.build / "bin" / name, "--gtest_fail_fast", "--gtest_brief=1"], self.build, seconds, self.log)

    def linked(self):
        """When each unit test was linked."""
        return {name: (self.build / "bin" / name).stat().st_mtime_ns for name in self.tests}

    def judge(self, mutant, quick):
        """(`unbuildable`, `noticed` or `survived`, by which test)."""
        file = self.source / mutant.path
        original = file.read_text(encoding="utf-8")
        lines = original.split("\n")
        assert lines[mutant.line - 1] == mutant.before
        lines[mutant.line - 1] = mutant.after
        self.log.write_text(f"{mutant}\n")
        try:
            file.write_text("\n".join(lines), encoding="utf-8")
            before = self.linked()
            if self.compile(self.tests) != 0:
                return "unbuildable", ""
            after = self.linked()
            # The quickest first: most mutants are noticed before it is the turn of the larger ones.
            for name in sorted((name for name in self.tests if after[name] != before[name]), key=self.seconds.get):
                if self.test(name, 20 + 5 * self.seconds[name]) != 0:
                    return "noticed", name
            if not quick:
                if self.compile([]) != 0:
                    return "noticed", "the build"
                if run(["ctest", "-L", "integration|fuzz|example", "--stop-on-failure", "-j", str(self.compile_jobs)],
                       self.build, 1800, self.log) != 0:
                    return "noticed", "system tests"
            return "survived", ""
        finally:
            file.write_text(original, encoding="utf-8")


def unnoticeable(top=TOP, file=Path(__file__).parent / "unnoticeable.txt"):
    """{(path, line as it is, line as changed)} of unnoticeable.txt: blocks of path, `- line`, `+ line`, reason."""
    listed = set()
    for block in re.split(r"\n\s*\n", file.read_text(encoding="utf-8")):
        words = [line for line in block.splitlines() if not line.startswith("#")]
        if not words:
            continue
        if len(words) < 4 or words[1][:2] != "- " or words[2][:2] != "+ ":
            sys.exit(f"mutation: unnoticeable.txt: expected path, '- line', '+ line', reason; got: {words}")
        if any(line[:2] in ("- ", "+ ") for line in words[3:]):
            sys.exit(f"mutation: unnoticeable.txt: two entries in one, put an empty line between them: {words}")
        text = (top / words[0]).read_text(encoding="utf-8")
        if words[1][2:] not in (line.strip() for line in text.splitlines()):
            sys.exit(f"mutation: unnoticeable.txt: {words[0]} holds no line '{words[1][2:]}'; remove or mend the entry")
        listed.add((words[0], words[1][2:], words[2][2:]))
    return listed


def sources(folder):
    names = subprocess.run(["git", "-C", TOP, "ls-files", "*.cpp", "*.h"], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    chosen = [folder] if folder else FOLDERS
    return [name for name in names if any(name.startswith(prefix) for prefix in chosen)
            and not name.startswith("tests/") and not name.endswith("main.cpp")]


def main():
    parser = argparse.ArgumentParser(prog="./telekerf check mutation", description=__doc__.split("\n\n")[0])
    parser.add_argument("--count", type=int, default=100, help="how many mutants (100)")
    parser.add_argument("--seed", type=int, default=1, help="which ones (1)")
    parser.add_argument("--folder", default="", help="only files whose path begins so, e.g. common/streaming")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="copies of the tree that work side by side")
    parser.add_argument("--build", type=Path, default=TOP / "build" / "mutation", help="where the copies are built")
    parser.add_argument("--quick", action="store_true", help="only the unit tests judge")
    parser.add_argument("--list", action="store_true", help="print the mutants that are drawn, and end")
    options = parser.parse_args()

    listed = unnoticeable()
    paths = sources(options.folder)
    if not paths:
        parser.error(f"--folder {options.folder}: no C++ source's path begins so")
    drawn = (mutant for mutant in mutants.draw(TOP, paths, options.seed)
             if (mutant.path, mutant.before.strip(), mutant.after.strip()) not in listed)
    if options.list:
        for _, mutant in zip(range(options.count), drawn):
            print(mutant)
        return

    options.build.mkdir(parents=True, exist_ok=True)
    workers = [Worker(options.build / str(number), max(1, os.cpu_count() // options.jobs))
               for number in range(options.jobs)]
    for worker in workers:
        worker.folder.mkdir(exist_ok=True)
        print(f"mutation: building copy {worker.folder}", file=sys.stderr, flush=True)
        worker.prepare(workers[0].seconds)

    lock = threading.Lock()
    judged, failures = {}, queue.Queue()

    def work(worker):
        try:
            while True:
                with lock:
                    counted = sum(verdict != "unbuildable" for verdict, _ in judged.values())
                    if counted >= options.count:
                        return
                    mutant = next(drawn, None)
                    if mutant is None:
                        return
                    judged[mutant] = ("pending", "")
                verdict = worker.judge(mutant, options.quick)
                with lock:
                    judged[mutant] = verdict
                    if verdict[0] != "unbuildable":
                        print(f"{verdict[0]:9} {mutant.path}:{mutant.line} {mutant.kind} {verdict[1]}", flush=True)
                        if verdict[0] == "survived":
                            print(str(mutant), flush=True)
        except BaseException as error:  # a worker that fails ends the run, in main's thread
            failures.put(error)

    threads = [threading.Thread(target=work, args=(worker,), daemon=True) for worker in workers]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        time.sleep(0.5)
        if not failures.empty():
            raise failures.get()

    score = collections.defaultdict(lambda: [0, 0])
    for mutant, (verdict, _) in judged.items():
        if verdict != "unbuildable":
            score[mutant.room][0] += verdict == "noticed"
            score[mutant.room][1] += 1
    print("\nmutants that survived:")
    for mutant, (verdict, _) in judged.items():
        if verdict == "survived":
            print(mutant)
    print("\nnoticed, by room:")
    for room, (noticed, all_of_them) in sorted(score.items()):
        print(f"  {room:32} {noticed:3} of {all_of_them:3}")
    noticed, all_of_them = (sum(column) for column in zip(*score.values()))
    print(f"seed {options.seed}, {all_of_them} mutants, {noticed} noticed")
    print(f"score {100 * noticed / all_of_them:.0f} %")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(130))
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        for child in list(children):
            end(child)
