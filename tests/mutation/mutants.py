# SPDX-License-Identifier: Apache-2.0
"""Small faults to put into C++ source, one at a time: where they can stand, and which are drawn for a seed.

The kinds are those that reviews find in control code: a sign, a scale, a bound, a guard, a constant, a function's
neighbour, a statement that is missing.
"""
import random
import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Mutant:
    """One changed line. `path` is relative to the repository's top; `line` counts from 1."""

    path: str
    line: int
    kind: str
    before: str
    after: str

    def __str__(self):
        return f"{self.path}:{self.line} {self.kind}\n    - {self.before.strip()}\n    + {self.after.strip()}"

    @property
    def room(self):
        """The folder, at most two deep."""
        return "/".join(self.path.split("/")[:-1][:2])


def blank(text):
    """`text` with comments, strings, characters and preprocessor lines blanked out; every position is kept."""
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])\'|^[ \t]*#[^\n]*',
        re.S | re.M,
    )
    return pattern.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def next_number(found):
    """A neighbour of a number as it is written: 3 -> 4, 0.5 -> 0.55, 1e-6 -> 1e-5."""
    word = found[0]
    if re.fullmatch(r"\d[\d']*e-?\d+", word):
        base, power = word.split("e")
        return f"{base}e{int(power) + 1}"
    if re.fullmatch(r"\d[\d']*(U|u|L|l|Z|z)*", word):
        digits = re.match(r"[\d']+", word)[0]
        return str(int(digits.replace("'", "")) + 1) + word[len(digits):]
    return repr(round(float(word.replace("'", "")) * 1.1, 12)) if float(word.replace("'", "")) != 0 else "0.1"


# kind, what is looked for in the blanked line, and what takes its place
SWAPS = {" + ": " - ", " - ": " + ", " += ": " -= ", " -= ": " += "}
BOUNDS = {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > "}
GUARDS = {" == ": " != ", " != ": " == ", " && ": " || ", " || ": " && "}
FUNCTIONS = {
    "floor(": "ceil(", "ceil(": "floor(", "sin(": "cos(", "cos(": "sin(", "std::min(": "std::max(",
    "std::max(": "std::min(", "std::abs(": "(", "front()": "back()", "back()": "front()", "lround(": "floor(",
    "std::round(": "std::floor(",
}


def any_of(words):
    return re.compile("|".join(re.escape(word) for word in words))


OPERATORS = [
    ("sign", any_of(SWAPS), lambda found: SWAPS[found[0]]),
    ("sign", re.compile(r"(?:(?<=[(\[{=?:,] )|(?<=[(\[{])|(?<=return ))-(?=[A-Za-z_(0-9])"), lambda found: ""),
    ("scale", re.compile(r" [*/] (?=[A-Za-z0-9_(])"), lambda found: " / " if "*" in found[0] else " * "),
    ("bound", any_of(BOUNDS), lambda found: BOUNDS[found[0]]),
    ("guard", any_of(GUARDS), lambda found: GUARDS[found[0]]),
    ("guard", re.compile(r"(?<![\w)\]])!(?=[A-Za-z_(])"), lambda found: ""),
    ("guard", re.compile(r"(?<=\bif )\((?=.*\) (?:return|break|continue)\b|.*\) \{?$)"), lambda found: "(false && ("),
    ("constant", re.compile(r"(?<![\w.'])(?:\d[\d']*\.\d*(?:e-?\d+)?|\d[\d']*(?:e-?\d+)?[uUlLzZ]*)(?![\w.'])"), next_number),
    ("constant", re.compile(r"\b(?:true|false)\b"), lambda found: "false" if found[0] == "true" else "true"),
    ("function", any_of(FUNCTIONS), lambda found: FUNCTIONS[found[0]]),
    ("statement", re.compile(r"^\s+[A-Za-z_][\w.\[\]>-]*(?:\(.*\)| [-+*/|&]?= .+);$"), lambda found: "  ;"),
]
# Nothing is missing without a declaration but what does not compile.
NO_STATEMENT = re.compile(
    r"^\s*(?:const|auto|using|return|delete|throw|static|constexpr|case|friend|typedef|explicit|virtual)\b|^\s*~?[A-Z]\w*\(")
NO_LINE = re.compile(r"^\s*(?:static_assert|template|using|namespace|friend|typedef|extern)\b|operator[-+*/<>=!&|]")


def closing(line, start):
    """Where the bracket that opens at `start` closes in `line`, or -1."""
    depth = 0
    for at in range(start, len(line)):
        depth += {"(": 1, ")": -1}.get(line[at], 0)
        if depth == 0:
            return at
    return -1


def mutants_of(path, text):
    """All mutants of one file."""
    found = []
    for number, (line, bare) in enumerate(zip(text.split("\n"), blank(text).split("\n")), 1):
        if NO_LINE.search(bare):
            continue
        for kind, pattern, change in OPERATORS:
            if kind == "statement" and (NO_STATEMENT.match(bare) or bare.count("(") != bare.count(")")):
                continue
            for site in pattern.finditer(bare):
                replacement = change(site)
                after = line[:site.start()] + replacement + line[site.end():]
                if replacement == "(false && (":
                    end = closing(bare, site.start())
                    if end < 0:
                        continue
                    after = line[:site.start()] + "(false && " + line[site.start():end + 1] + ")" + line[end + 1:]
                found.append(Mutant(path, number, kind, line, after))
    return found


def draw(top, paths, seed):
    """Mutants of the files `paths` below the folder `top`, in an order that the seed alone decides: the rooms take
    turns, and within a room the kinds, so that neither a long file nor a common operator crowds out the rest."""
    chance = random.Random(seed)
    rooms = {}
    for path in sorted(paths):
        for mutant in mutants_of(path, (Path(top) / path).read_text(encoding="utf-8")):
            rooms.setdefault(mutant.room, {}).setdefault(mutant.kind, []).append(mutant)
    queues = []
    for room in sorted(rooms):
        kinds = [chance.sample(mutants, len(mutants)) for _, mutants in sorted(rooms[room].items())]
        chance.shuffle(kinds)
        longest = max(len(kind) for kind in kinds)
        queues.append([kind[turn] for turn in range(longest) for kind in kinds if turn < len(kind)])
    chance.shuffle(queues)
    turn = 0
    while any(turn < len(queue) for queue in queues):
        yield from (queue[turn] for queue in queues if turn < len(queue))
        turn += 1
