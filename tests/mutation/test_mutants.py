# SPDX-License-Identifier: Apache-2.0
"""What counts as a small fault, and which are drawn."""
import itertools
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import mutants  # noqa: E402
import mutate  # noqa: E402


def changed(line):
    return {mutant.after for mutant in mutants.mutants_of("a.cpp", line)}


class Mutants(unittest.TestCase):
    def test_each_kind_of_fault_is_known(self):
        self.assertIn("  x = a - b;", changed("  x = a + b;"))
        self.assertIn("  x = b;", changed("  x = -b;"))
        self.assertIn("  return f(b);", changed("  return f(-b);"))
        self.assertIn("  x -= b;", changed("  x += b;"))
        self.assertIn("  x = a / b;", changed("  x = a * b;"))
        self.assertIn("  while (i <= n) {", changed("  while (i < n) {"))
        self.assertIn("  ok = a || !b;", changed("  ok = a && !b;"))
        self.assertIn("  ok = a && b;", changed("  ok = a && !b;"))
        self.assertIn("  if (false && (f(x) > 2)) return;", changed("  if (f(x) > 2) return;"))
        self.assertIn("  x = 4;", changed("  x = 3;"))
        self.assertIn("  x = 0.55;", changed("  x = 0.5;"))
        self.assertIn("  x = 1e-5;", changed("  x = 1e-6;"))
        self.assertIn("  x = std::ceil(b);", changed("  x = std::floor(b);"))
        self.assertIn("  f(false);", changed("  f(true);"))
        self.assertIn("  ;", changed("  reset(3);"))

    def test_comments_strings_and_directives_are_left_alone(self):
        text = '#include <a-b>\n// a - b\n/* a - b\n a - b */\nauto s = "a - b, 3";\nchar c = \'3\';\n#define N 3\n'
        self.assertEqual([], mutants.mutants_of("a.cpp", text))

    def test_a_number_inside_a_name_or_between_quotes_of_digits_is_one(self):
        self.assertEqual({"  f(Vec3(x), 1001);", "  ;"}, changed("  f(Vec3(x), 1'000);"))

    def test_a_condition_over_several_lines_is_not_taken_for_a_whole_one(self):
        self.assertFalse(any("false &&" in line for line in changed("  if (a(b) &&")))

    def test_the_seed_alone_decides_and_no_room_waits_for_another(self):
        with tempfile.TemporaryDirectory() as top:
            for name, lines in (("a/b/long.cpp", 500), ("a/c/short.cpp", 2)):
                (Path(top) / name).parent.mkdir(parents=True)
                (Path(top) / name).write_text("  x = a + b;\n" * lines)
            names = ["a/c/short.cpp", "a/b/long.cpp"]
            first = list(itertools.islice(mutants.draw(top, names, 5), 6))
            self.assertEqual(first, list(itertools.islice(mutants.draw(top, names[::-1], 5), 6)))
            self.assertNotEqual(first, list(itertools.islice(mutants.draw(top, names, 6), 6)))
            self.assertEqual(3, sum(mutant.room == "a/c" for mutant in first))

    def test_what_is_listed_as_unnoticeable_is_a_line_of_today(self):
        self.assertTrue(mutate.unnoticeable())

    def test_entries_of_the_list_are_told_apart_by_an_empty_line(self):
        entry = "a.cpp\n- x = 3;\n+ x = 4;\nNobody looks.\n"
        with tempfile.TemporaryDirectory() as top:
            (Path(top) / "a.cpp").write_text("x = 3;\n")
            (Path(top) / "list.txt").write_text(entry + "\n" + entry.replace("4", "5"))
            self.assertEqual(2, len(mutate.unnoticeable(Path(top), Path(top) / "list.txt")))
            (Path(top) / "list.txt").write_text(entry + entry.replace("4", "5"))
            with self.assertRaisesRegex(SystemExit, "two entries in one"):
                mutate.unnoticeable(Path(top), Path(top) / "list.txt")


if __name__ == "__main__":
    unittest.main()
