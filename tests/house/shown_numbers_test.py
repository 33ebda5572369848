"""Numbers of pages against results: tools/shown_numbers.py. Usage: shown_numbers_test.py TOOLS."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, sys.argv[1])
import shown_numbers  # noqa: E402

PAGE = """It takes {steps} steps of {mean} s, up to 0.03 m.
<!-- shown:
{steps} = rows("m.steps.csv", reason="accepted")
{mean} = mean("m.steps.csv", "step [s]", reason="accepted")
0.03 +- 20 % = largest("m.csv", "x [m]", 0, 1)
-->
"""


class ShownNumbers(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        steps = "time [s],step [s],reason\n" + "0,0.01,accepted\n" * 1234 + "0,0.5,error_too_large\n"
        (self.folder / "m.steps.csv").write_text(steps)
        (self.folder / "m.csv").write_text("time [s],x [m]\n0,0.01\n1,-0.034\n2,7\n")

    def check(self, text, update=False):
        faults = []
        results = shown_numbers.Results(self.folder, None)
        new = shown_numbers.check(text, results, lambda line, told: faults.append(f"{line}: {told}"), update)
        return faults, new

    def test_what_the_results_give_passes(self):
        self.assertEqual(self.check(PAGE.format(steps="1,234", mean="0.01"))[0], [])
        self.assertEqual(self.check(PAGE.format(steps="1234", mean="1e-2"))[0], [])

    def test_another_number_is_told_with_its_line(self):
        faults, _ = self.check("\n" + PAGE.format(steps="1,233", mean="0.010"))
        self.assertEqual(len(faults), 1)
        self.assertTrue(faults[0].startswith("2: the page shows 1,233, the results give 1234"), faults)

    def test_update_writes_the_number_in_its_own_form(self):
        _, new = self.check(PAGE.format(steps="1,199", mean="0.020"), update=True)
        self.assertEqual(new, PAGE.format(steps="1,234", mean="0.010"))

    def test_numbers_of_steps_must_be_compared_or_said(self):
        self.assertEqual(len(self.check("It takes 722 steps.\n")[0]), 1)
        self.assertEqual(self.check("It takes 722 steps.\n<!-- said: 722 steps -->\n")[0], [])
        self.assertEqual(self.check("```\n722 steps\n```\nand `5 steps`\n")[0], [])

    def test_a_number_that_is_not_shown_is_told(self):
        self.assertEqual(len(self.check('Nothing.\n<!-- shown: 1234 = rows("m.steps.csv") -->\n')[0]), 1)

    def test_events_that_are_quoted_must_be_printed(self):
        faults = []
        printed = ['motion: "B" locks at t = 1.3715 s']
        for quoted, count in (("1.3715", 0), ("1.37151821", 1)):
            faults.clear()
            shown_numbers.check_events(f'`"B" locks at t = {quoted} s`', printed, lambda line, told: faults.append(told))
            self.assertEqual(len(faults), count)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
