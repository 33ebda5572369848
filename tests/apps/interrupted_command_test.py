"""The command in trouble: interrupts, kills, closed streams, folders taken away, full disks. Usage:
interrupted_command_test.py RUBATO EXAMPLES."""
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

from command_case import CommandCase, LONG, NCDUMP, RUBATO

EXAMPLES = pathlib.Path(sys.argv[2])


class InterruptedCommand(CommandCase):
    def test_a_full_stdout_is_an_error(self):
        for arguments in (["schema"], ["methods"], ["--help"], ["example"]):
            with open("/dev/full", "w") as full:
                result = subprocess.run([RUBATO, *arguments], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
            self.assertEqual(result.returncode, 3, arguments)
            self.assertRegex(result.stderr, r"^error: .*No space left on device\n$")

    def start(self, study, **options):
        process = subprocess.Popen([RUBATO, "run", study, "-o", "out"], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, **options)
        self.addCleanup(process.kill)
        return process

    def wait_for_rows(self, name="out/long.csv"):
        """Until the run has written some: it may start late on a busy machine."""
        path, end = self.folder / name, time.monotonic() + 60
        while not (path.exists() and path.stat().st_size > 100_000):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def test_ctrl_c_keeps_what_was_computed(self):
        study = self.write(LONG.replace("DURATION", "2e7"))
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            process = self.start(study)
            self.wait_for_rows()
            process.send_signal(sent)
            out, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, err)
            self.assertRegex(err, r'study.toml: analysis "long" stopped: interrupted at t = \S+ s of (2e\+07|20000000) s')
            self.assertEqual(out, "out/report.html\n")
            rows = self.rows("out/long.csv")
            self.assertGreater(len(rows), 1000)
            self.assertTrue(all(len(row) == len(rows[0]) for row in rows))
            self.assertIn("interrupted", (self.folder / "out/report.html").read_text())
            if NCDUMP:
                header = self.dump("out/results.nc", "-h")
                self.assertIn(':status = "interrupted" ;', header)
                # The header row is none; the file holds every row that the table holds.
                self.assertIn(f"time = UNLIMITED ; // ({len(rows) - 1} currently)", header)

    def test_analyses_that_an_interrupt_did_not_let_begin_are_named(self):
        text = LONG.replace("DURATION", "2e7")
        study = self.write(text + text[text.index("[[analysis]]"):].replace('"long"', '"later"'))
        process = self.start(study)
        self.wait_for_rows()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertTrue((self.folder / "out/report.html").exists())
        if NCDUMP:
            self.assertIn(':message = "not begun" ;', self.dump("out/results.nc", "-h"))

    def test_a_killed_run_leaves_a_readable_file(self):
        study = self.write(LONG.replace("DURATION", "2e7"))
        process = self.start(study)
        self.wait_for_rows()
        time.sleep(1.5)  # past the first second's flush
        process.kill()
        process.communicate(timeout=60)
        if NCDUMP:
            header = self.dump("out/results.nc", "-h")
            self.assertIn(':status = "unfinished" ;', header)
            self.assertNotIn("(0 currently)", header)

    def test_a_run_outlives_the_reader_of_its_messages(self):
        study = self.write(LONG.replace("DURATION", "1e4"))
        process = self.start(study)
        process.stderr.close()
        process.stdout.close()
        self.assertEqual(process.wait(timeout=60), 0)
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_messages_do_not_go_into_the_results_where_streams_are_closed(self):
        study = EXAMPLES / "single-mass" / "study.toml"
        self.assertEqual(self.run_command("run", study, "-o", "open").returncode, 0)
        for closed in (">&-", "2>&-", "<&- >&- 2>&-"):
            shell = subprocess.run(f"{RUBATO} run {study} -o closed {closed}", shell=True, capture_output=True, text=True,
                                   cwd=self.folder, timeout=60)
            self.assertEqual(shell.returncode, 0 if closed == "2>&-" else 3)  # the answer, the path of the report, is lost
            for name in ("response.csv", "exact.csv", "response.energy.csv"):
                self.assertEqual((self.folder / "closed" / name).read_bytes(), (self.folder / "open" / name).read_bytes(), closed)
            self.assertTrue((self.folder / "closed/report.html").exists(), closed)
            self.assertNotIn(b"steps (100 %)", (self.folder / "closed/results.nc").read_bytes())
            shutil.rmtree(self.folder / "closed")

    def test_two_runs_do_not_write_into_one_folder(self):
        study = self.write(LONG.replace("DURATION", "2e7"))
        first = self.start(study)
        self.wait_for_rows()
        second = self.run_command("run", study, "-o", "out")
        self.assertEqual((second.returncode, second.stdout), (3, ""))
        self.assertEqual(second.stderr, f"error: out: another run is writing here (process {first.pid}); wait for its end, or "
                                        "choose another folder (-o DIR)\n")
        first.send_signal(signal.SIGINT)
        first.communicate(timeout=60)
        self.assertEqual(first.returncode, 130)
        rows = self.rows("out/long.csv")
        self.assertTrue(all(len(row) == len(rows[0]) for row in rows))
        self.assertTrue((self.folder / "out/report.html").exists())
        self.assertFalse((self.folder / "out/.rubato-lock").exists())
        if NCDUMP:
            self.assertIn(f"time = UNLIMITED ; // ({len(rows) - 1} currently)", self.dump("out/results.nc", "-h"))
        short = self.write(LONG.replace("DURATION", "1.0"), "short.toml")
        self.assertEqual(self.run_command("run", short, "-o", "out").returncode, 0)

    def test_a_run_ends_soon_after_its_folder_is_deleted_moved_or_emptied(self):
        study = self.write(LONG.replace("DURATION", "2e7"))
        out = self.folder / "out"

        def delete():
            shutil.rmtree(out)

        def move():
            out.rename(self.folder / "elsewhere")

        def empty():
            for path in out.glob("[!.]*"):
                path.unlink()

        for harm, told in ((delete, "was deleted or moved"), (move, "was deleted or moved"), (empty, "has lost its results.nc")):
            process = self.start(study)
            self.wait_for_rows()
            time.sleep(1.2)  # past the first second's flush
            harm()
            out_text, err = process.communicate(timeout=30)
            self.assertEqual((process.returncode, out_text), (3, ""), err)
            self.assertIn(f"error: out: the folder {told} while the run wrote into it; the run ends here, without results\n", err)
            shutil.rmtree(out, ignore_errors=True)

    def test_former_results_stay_until_the_new_run_can_write(self):
        study = EXAMPLES / "single-mass" / "study.toml"
        self.run_command("run", study, "-o", "out", "-q", "--only", "response")

        def contents():
            return {path.name: path.read_bytes() for path in (self.folder / "out").iterdir() if path.is_file()}

        before = contents()
        self.assertIn("results.nc", before)
        for size in (200, 200_000):  # not even a head; a head, and no rows
            def limit():
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

            result = self.run_command("run", study, "-o", "out", preexec_fn=limit)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertIn("File too large", result.stderr)
            self.assertEqual(before, contents(), size)
        self.assertIn("out: nothing was written; the former results stay\n", result.stderr)

    def test_a_folder_that_cannot_be_made_is_a_wrong_option(self):
        (self.folder / "out").write_text("a file")
        for folder, reason in (("out", "exists and is no folder"), ("/proc/nope", r"the folder cannot be made: .+")):
            result = self.run_command("run", EXAMPLES / "single-mass" / "study.toml", "-o", folder)
            self.assertEqual(result.returncode, 2)
            self.assertRegex(result.stderr, rf"^error: {folder}: {reason}; choose another \(-o DIR\)\n$")
        self.assertEqual((self.folder / "out").read_text(), "a file")

    def test_output_that_cannot_grow_is_reported_plainly(self):
        study = self.write(LONG.replace("DURATION", "1e6"))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4 << 20, 4 << 20))

        result = self.run_command("run", study, "-o", "out", preexec_fn=limit)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertRegex(result.stderr, r'study.toml: analysis "long" failed: out/\S+: File too large; write elsewhere')
        rows = self.rows("out/long.csv")
        self.assertGreater(len(rows), 10000)
        self.assertTrue(all(len(row) == len(rows[0]) for row in rows))
        self.assertTrue((self.folder / "out/report.html").exists())
        if NCDUMP:
            self.assertIn(':status = "failed" ;', self.dump("out/results.nc", "-h"))

    def test_a_disk_that_fills_up_keeps_results_and_report(self):
        # A disk of 200 MB of its own, which another program fills while the run, halted for that, has it open.
        self.write(LONG.replace("DURATION", "1e5").replace("every = 100", "every = 20"))
        script = f"""set -e
            mount -t tmpfs -o size=200m tmpfs disk
            {RUBATO} run study.toml -o disk/out 2> messages & run=$!
            while ! [ -s disk/out/long.csv ]; do kill -0 $run; sleep 0.02; done
            kill -STOP $run
            free=$(df --output=avail -k disk | tail -n 1)
            head -c $((free - 20000))K /dev/zero > disk/filler
            kill -CONT $run
            status=0; wait $run || status=$?
            cp -r disk/out out
            exit $status"""
        (self.folder / "disk").mkdir()
        if subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", self.folder / "disk"],
                          capture_output=True).returncode != 0:
            self.skipTest("no disk of its own can be mounted here")
        result = subprocess.run(["unshare", "-rm", "sh", "-c", script], cwd=self.folder, timeout=120,
                                stdout=subprocess.DEVNULL)
        messages = (self.folder / "messages").read_text()
        self.assertEqual(result.returncode, 3, messages)
        self.assertRegex(messages, r'study.toml: analysis "long" failed: disk/out/\S+: the disk is full; free some space')
        rows = self.rows("out/long.csv")
        self.assertGreater(len(rows), 1000)
        self.assertTrue(all(len(row) == len(rows[0]) for row in rows))
        self.assertIn("the disk is full", (self.folder / "out/report.html").read_text())
        if NCDUMP:
            self.assertIn(':status = "failed" ;', self.dump("out/results.nc", "-h"))

    def test_a_huge_output_is_refused_before_it_begins(self):
        study = self.write(LONG.replace("DURATION", "1e9").replace("every = 100", "every = 1"))
        result = self.run_command("run", study, "-o", "out")
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stderr, r"the results may take \S+ TB and \S+ [GT]B are free")

    def test_a_closed_pipe_is_no_crash(self):
        shell = subprocess.run(f"{RUBATO} methods average_acceleration --csv | head -n 1", shell=True, capture_output=True,
                               text=True, timeout=60)
        self.assertEqual((shell.returncode, shell.stderr), (0, ""))


if __name__ == "__main__":
    os.environ.pop("RUBATO", None)
    unittest.main(argv=sys.argv[:1], verbosity=1)
