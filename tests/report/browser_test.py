"""Opens a report in headless Chromium and uses it as a reader would.

Usage: browser_test.py REPORT.html. Python's standard library speaks WebDriver to chromedriver. Exit status 77 (skipped)
where Chromium or chromedriver is not installed, or where there is no loopback network.
"""

import base64
import json
import pathlib
import re
import shutil
import socket
import sys
import tempfile
import time
import unittest

from browser import Browser


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-report-"))
        cls.browser = Browser(cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        shutil.rmtree(cls.folder, ignore_errors=True)

    def setUp(self):
        for kind in ("browser", "performance"):  # what the browser's own first page said
            self.browser.log(kind)
        self.browser.call("POST", "/url", {"url": page.as_uri()})
        self.browser.wait("return document.querySelectorAll('figure').length > 0")
        self.browser.script("document.getElementById('figure-1').scrollIntoView({behavior: 'instant'})")

    def tearDown(self):
        complaints = [entry for entry in self.browser.log("browser") if entry["level"] != "INFO"]
        self.assertEqual(complaints, [], "the console is silent")
        for entry in self.browser.log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                self.assertRegex(message["params"]["request"]["url"], "^(file|data|blob):", "nothing is fetched")

    def test_no_function_of_the_page_has_the_name_of_another(self):
        names = re.findall(r"^(?:async )?function (\w+)\(", page.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertGreater(len(names), 100)
        self.assertEqual(sorted({name for name in names if names.count(name) > 1}), [], "the scripts share one scope")

    def test_figures_are_drawn_when_they_come_into_view(self):
        count = self.browser.script("return document.querySelectorAll('figure').length")
        self.assertGreater(count, 15)
        last_is_drawn = f"return document.querySelector('#figure-{count} .plot .main-svg') !== null"
        self.assertFalse(self.browser.script(last_is_drawn), "figures far away wait")
        for number in range(1, count + 1):
            self.browser.script("document.getElementById(arguments[0]).scrollIntoView({behavior: 'instant'})",
                                f"figure-{number}")
            if self.browser.script(f"return document.querySelector('#figure-{number} canvas') !== null"):
                continue
            self.browser.wait(f"const figure = document.querySelector('#figure-{number} .plot');"
                              "const lines = figure.querySelectorAll('path.js-line, .contourlevel path, path.point, .barlayer path');"
                              "return [...lines].some((line) => (line.getAttribute('d') || '').length > 20)")
            titles = self.browser.script(
                f"return [...document.querySelectorAll('#figure-{number} .xtitle, #figure-{number} [class*=ytitle]')]"
                ".map((title) => title.textContent)")
            self.assertGreaterEqual(len(titles), 2)
            for title in titles:
                self.assertRegex(title, r" \[.+\]$", "every axis names its unit")

    def test_a_line_passes_through_every_row(self):
        drawn = ("const trace = document.querySelector('#figure-1 .plot')._fullData?.[0];"
                 "const line = document.querySelector('#figure-1 path.js-line');"
                 "return trace && line ? [trace.x.length, line.getAttribute('d').split(/[ML]/).length - 1] : null")
        rows, points = self.browser.wait(drawn)
        self.assertGreater(rows, 100)
        self.assertEqual(points, rows, "smooth curves have no corners")

    def test_a_click_in_the_legend_hides_a_line(self):
        lines = "return document.querySelectorAll('#figure-1 .scatterlayer .trace').length"
        before = self.browser.wait(lines)
        self.browser.click("#figure-1 .legend .traces:first-child .legendtoggle")
        self.browser.wait(f"{lines} === {before - 1}")
        self.browser.click("#figure-1 .legend .traces:first-child .legendtoggle")
        self.browser.wait(f"{lines} === {before}")

    def test_a_button_chooses_the_quantity(self):
        title = "return document.querySelector('#figure-1 .ytitle')?.textContent"
        self.assertEqual(self.browser.wait(title), "Position [m]")
        self.browser.click("#figure-1 .chooser button:nth-child(2)")
        self.assertEqual(self.browser.wait(title), "Velocity [m/s]")
        self.assertEqual(self.browser.script(
            "return document.querySelectorAll('#figure-1 .chooser [aria-pressed=true]')[0].textContent"), "Velocity")

    def test_a_figure_is_downloaded_as_svg(self):
        self.browser.wait("return document.querySelector('#figure-1 .main-svg') !== null")
        self.browser.click("#figure-1 .save")
        file = self.folder / "figure-1.svg"
        end = time.monotonic() + 20
        while not file.exists() and time.monotonic() < end:
            time.sleep(0.05)
        text = file.read_text()
        self.assertTrue(text.startswith("<svg"), text[:80])
        self.assertIn("Position [m]", text)

    def test_hostile_names_are_shown_as_they_are(self):
        self.assertEqual(self.browser.script("return document.title"), "Two blade sectors and an under-platform damper")
        text = self.browser.script("return document.querySelector('main').textContent")
        self.assertIn("bl\"ade</script><b>\u03a9", text)
        self.assertIn("</script><script>document.title = 'taken'</script>", text)
        self.browser.script("[...document.querySelectorAll('figure')].at(-1).scrollIntoView({behavior: 'instant'})")
        self.assertEqual(self.browser.wait("return [...document.querySelectorAll('figure')].at(-1)"
                                           ".querySelector('.legendtext')?.textContent"), "bl\"ade</script><b>\u03a9")

    def test_each_slider_has_its_loop_over_the_relative_displacement(self):
        for name in ("contact1", "contact2", "pad"):
            figure = self.browser.script(
                "const figure = [...document.querySelectorAll('figure')].find((candidate) =>"
                "  candidate.textContent.includes(`Hysteresis loop of ${arguments[0]}.`));"
                "figure.scrollIntoView({behavior: 'instant'}); return figure.id", name)
            self.assertEqual(self.browser.wait(f"return document.querySelector('#{figure} .xtitle')?.textContent"),
                             "Relative displacement [m]")

    def figure(self, chapter, words):
        """The number of the figure of a chapter whose caption has these words, drawn."""
        number = self.browser.script("""
            const chapter = [...document.querySelectorAll('.chapter')].find((candidate) =>
              candidate.querySelector('h2').lastChild.textContent === arguments[0]);
            const figure = [...chapter.querySelectorAll('figure')].find((candidate) =>
              candidate.querySelector('figcaption').textContent.includes(arguments[1]));
            figure.scrollIntoView({behavior: 'instant'});
            return figure.id.replace('figure-', '')""", chapter, words)
        self.browser.wait(f"return document.querySelector('#figure-{number} .main-svg') !== null")
        return number

    def legend(self, number):
        return self.browser.script(f"return [...document.querySelectorAll('#figure-{number} .legendtext')]"
                                   ".map((entry) => entry.textContent)")

    def titles(self, number):
        """Titles of the axes and of the colour bar, in the order of the alphabet."""
        return sorted(self.browser.script(f"return [...document.querySelectorAll('#figure-{number} text')].filter((text) =>"
                                          "/title$/.test(text.getAttribute('class'))).map((text) => text.textContent)"))

    def choose(self, number, text):
        self.browser.script("""
            const tools = document.querySelector(`#figure-${arguments[0]} .tools`);
            [...tools.querySelectorAll('button')].find((button) => button.textContent === arguments[1]).click()""",
                            number, text)

    def test_a_law_beside_sliders_and_stops_has_its_loop_over_what_it_sees(self):
        number = self.figure("response", "Hysteresis loop of rubber.")  # its force is law_force in results.nc
        self.assertEqual(self.titles(number), ["Displacement [m]", "Law force [N]"])

    def test_forces_of_bushings_have_a_figure(self):
        number = self.figure("pendulum", "What each bushing does")
        self.assertEqual(self.titles(number), ["Force x [N]", "Time [s]"])
        self.choose(number, "Moment")
        self.browser.wait(f"return document.querySelector('#figure-{number} .ytitle')?.textContent === 'Moment [N m]'")

    def test_steps_stand_on_logarithmic_axes_with_their_events_and_their_distribution(self):
        axis = "return document.querySelector('#figure-{} .plot')._fullLayout.{}.type"
        number = self.figure("response", "Length of the steps")
        self.assertEqual(self.legend(number), ["Event", "Accepted", "Error too large", "Tried for an event"])
        self.assertEqual(self.browser.script(axis.format(number, "yaxis")), "log")
        events = self.browser.script(f"return document.querySelector('#figure-{number} .plot').data[0].x.length")
        self.assertEqual(events, 3 * 10, "a line for each of the ten events")
        number = self.figure("response", "Error of the steps")
        self.assertEqual(self.legend(number), ["Event", "Accepted", "Error too large", "Tolerance"])
        self.assertEqual(self.browser.script(axis.format(number, "yaxis")), "log")
        number = self.figure("response", "How often a step of which length")
        self.assertEqual(self.browser.script(axis.format(number, "xaxis")), "log")
        steps = self.browser.script(f"return document.querySelector('#figure-{number} .plot').data[0].y.reduce((a, b) => a + b)")
        self.assertEqual(steps, 200)

    def test_the_summary_fits_its_column(self):
        self.assertTrue(self.browser.script("const table = document.querySelector('#table-1 .scroll');"
                                            "return table.scrollWidth <= table.clientWidth"))

    def test_a_sweep_shows_a_curve_a_preload_both_limits_and_what_did_not_converge(self):
        number = self.figure("preloads", "Responses in the steady state")
        self.assertEqual(self.legend(number), [
            "Linear, free", "Linear, stuck", "N0 = 0", "N0 = 0.3", "N0 = 0.8", "N0 = 1.2", "N0 = 4",
            "Not converged (3)", "Quasi periodic (1)"])
        self.assertEqual(self.titles(number), ["Angular frequency, Omega [rad/s]", "mass: Amplitude [m]"])
        crosses = f"return document.querySelectorAll('#figure-{number} .scatterlayer path.point').length"
        self.assertEqual(self.browser.wait(crosses), 4)
        alarm = self.browser.script("return [...document.querySelectorAll('.alarm')].map((node) => node.textContent)")
        self.assertTrue(any("3 not converged, 1 quasi periodic" in text for text in alarm), alarm)

    def test_quantity_observation_and_scale_of_a_response_can_be_chosen(self):
        number = self.figure("preloads", "Responses in the steady state")
        self.choose(number, "Velocity amplitude")
        self.choose(number, "mass - ground")
        self.assertEqual(self.titles(number)[1], "mass - ground: Velocity amplitude [m/s]")
        ticks = f"return [...document.querySelectorAll('#figure-{number} .ytick')].map((tick) => tick.textContent)"
        self.assertIn("0", self.browser.script(ticks))
        self.choose(number, "Logarithmic")
        self.browser.wait(ticks.replace(".textContent)", ".textContent).every((text) => text !== '0')"))

    def test_many_curves_are_told_apart_by_a_scale_of_colours(self):
        number = self.figure("grid", "Responses in the steady state")
        self.assertEqual(self.titles(number), ["Angular frequency, Omega [rad/s]", "N0 [SI]", "mass: Amplitude [m]"])
        self.assertEqual(self.legend(number), ["Linear, free", "Linear, stuck"])
        colors = self.browser.script(f"return new Set([...document.querySelectorAll('#figure-{number} .js-line')]"
                                     ".map((line) => line.style.stroke)).size")
        self.assertGreaterEqual(colors, 20)
        map_number = self.figure("grid", "Amplitude over frequency and parameter")
        self.browser.wait(f"return document.querySelector('#figure-{map_number} .heatmaplayer image') !== null")
        self.assertEqual(self.titles(map_number), ["Angular frequency, Omega [rad/s]", "N0 [SI]", "mass amplitude [m]"])

    def test_samples_have_percentile_bands_and_a_distribution(self):
        number = self.figure("tolerance", "Percentile bands")
        self.assertEqual(self.legend(number), ["5 to 95 %", "25 to 75 %", "Median"])
        filled = f"return document.querySelectorAll('#figure-{number} .scatterlayer path.js-fill').length"
        self.assertEqual(self.browser.wait(filled), 2)
        number = self.figure("tolerance", "Responses in the steady state")
        self.assertIn("200 of 400 curves", self.browser.script(f"return document.querySelector('#figure-{number}').textContent"))
        number = self.figure("tolerance", "Distribution of the largest amplitude")
        self.assertGreater(self.browser.wait(f"return document.querySelectorAll('#figure-{number} .barlayer path').length"), 10)

    def test_loops_at_chosen_points_are_closed(self):
        number = self.figure("preloads", "Hysteresis loops at chosen points")
        self.assertEqual(self.legend(number)[0], "N0 = 0.3, \u03a9 = 0.8 rad/s")
        ends = self.browser.wait(f"""
            const plot = document.querySelector('#figure-{number} .plot');
            return plot.data.map((line) => [line.x[0], line.x.at(-1), line.y[0], line.y.at(-1)])""")
        self.assertEqual(len(ends), 6)
        for x_first, x_last, y_first, y_last in ends:
            self.assertEqual((x_first, y_first), (x_last, y_last))

    def test_the_optimum_is_marked_with_its_value_and_certificate(self):
        number = self.figure("damper", "Damper curve")
        note = self.browser.wait(f"return document.querySelector('#figure-{number} .annotation-text')?.textContent")
        self.assertEqual(note, "N0 = 343.45 m at 7.57 rad/scertificate: kink")
        self.assertEqual(self.legend(number), ["blade1", "blade2", "Not converged (1)", "Optimum"])
        text = self.browser.script("return document.querySelector('main').textContent")
        self.assertIn("Kink: two peaks or coordinates are equal there", text)

    def test_the_peaks_of_a_sweep_are_joined_within_a_combination_only(self):
        number = self.figure("dampers", "All peaks that were tracked")
        self.choose(number, "mu = 0.3")
        lines = self.browser.wait(f"""
            const plot = document.querySelector('#figure-{number} .plot');
            return plot.data.map((line) => [line.name, Array.from(line.x), Array.from(line.y)])""")
        self.assertEqual([line[0] for line in lines], ["Peak 1", "Peak 1", "Peak 2", "Peak 2"])
        preloads = [5.0 * k for k in range(1, 21)]
        for _, x, _ in lines:
            self.assertEqual(x, preloads, "a line runs once along the parameter")
        self.assertEqual(lines[0][2], [4.0 - 0.01 * 0.3 * preload for preload in preloads])

    def test_a_mode_is_chosen_and_shown_in_bars_over_the_coordinates(self):
        number = self.figure("modes", "Shape of a mode")
        bars = f"return document.querySelectorAll('#figure-{number} .barlayer path').length"
        self.assertEqual(self.browser.wait(bars), 5)
        self.choose(number, "Stuck")
        self.choose(number, "Mode 4")
        self.browser.wait(f"return document.querySelector('#figure-{number} .ytitle').textContent === "
                          "'Shape at 8.06226 rad/s [\u2013]'")

    def test_a_structure_plays_stops_and_shows_any_moment(self):
        number = self.browser.script("""
            const figure = [...document.querySelectorAll('figure')].find((candidate) =>
              candidate.textContent.includes('The structure in motion (3 nodes, 2 lines)'));
            figure.scrollIntoView({behavior: 'instant'});
            return figure.id.replace('figure-', '')""")
        moment = f"return document.querySelector('#figure-{number} .moment').textContent"
        # Columns of the picture in which something blue stands: b.x rises from 0, drawn magnified, and comes back.
        blue = f"""
            const canvas = document.querySelector('#figure-{number} canvas');
            const copy = document.createElement('canvas');
            [copy.width, copy.height] = [canvas.width, canvas.height];
            const pen = copy.getContext('2d', {{willReadFrequently: true}});
            pen.drawImage(canvas, 0, 0);
            const {{data}} = pen.getImageData(0, 0, canvas.width, canvas.height);
            let right = 0;
            for (let i = 0; i < data.length; i += 4) {{
              if (data[i] === 11 && data[i + 1] === 79 && data[i + 2] === 124) right = Math.max(right, i / 4 % canvas.width);
            }}
            return right"""
        self.assertEqual(self.browser.wait(moment), "t = 0 s")
        at_rest = self.browser.wait(blue)
        self.browser.script(f"""
            const scrub = document.querySelector('#figure-{number} input[type=range]');
            scrub.value = '5';
            scrub.dispatchEvent(new Event('input'))""")
        self.assertEqual(self.browser.script(moment), "t = 0.5 s")
        self.assertGreater(self.browser.script(blue), at_rest + 10)
        self.browser.click(f"#figure-{number} .play")
        self.browser.wait(f"{moment} !== 't = 0.5 s'")
        self.browser.click(f"#figure-{number} .play")
        stopped = self.browser.script(moment)
        time.sleep(0.3)
        self.assertEqual(self.browser.script(moment), stopped)

    def test_a_mode_of_a_mechanism_swings_about_its_configuration(self):
        number = self.browser.script("""
            const figure = [...document.querySelectorAll('figure')].find((candidate) =>
              candidate.textContent.includes('A mode of the mechanism (2 nodes, 1 line)'));
            figure.scrollIntoView({behavior: 'instant'});
            return figure.id.replace('figure-', '')""")
        figure = f"document.querySelector('#figure-{number}')"
        self.browser.wait(f"return {figure}.querySelector('canvas').width > 300")

        def extremes():
            """Leftmost, rightmost, highest and lowest pixel of the line that moves, in pixels of the page."""
            return self.browser.script(f"""
                const canvas = {figure}.querySelector('canvas'), copy = document.createElement('canvas');
                [copy.width, copy.height] = [canvas.width, canvas.height];
                const pen = copy.getContext('2d', {{willReadFrequently: true}});
                pen.drawImage(canvas, 0, 0);
                const {{data}} = pen.getImageData(0, 0, canvas.width, canvas.height);
                const seen = [Infinity, -Infinity, Infinity, -Infinity];
                for (let i = 0; i < data.length; i += 4) {{
                  if (data[i] !== 11 || data[i + 1] !== 79 || data[i + 2] !== 124) continue;
                  const [x, y] = [i / 4 % canvas.width, Math.floor(i / 4 / canvas.width)];
                  seen[0] = Math.min(seen[0], x); seen[1] = Math.max(seen[1], x);
                  seen[2] = Math.min(seen[2], y); seen[3] = Math.max(seen[3], y);
                }}
                return seen""")

        def put(selector, value):
            self.browser.script(f"""
                const input = {figure}.querySelector(arguments[0]);
                input.value = arguments[1];
                input.dispatchEvent(new Event('input'))""", selector, str(value))

        moment = "input[aria-label=Moment]"
        left, right, top, low = extremes()
        put(moment, 15)  # a quarter of a period later it passes the configuration: a level line from the pin
        level_left, level_right, level_top, level_low = extremes()
        self.assertLess(level_low - level_top, 8)
        self.assertAlmostEqual(left, level_left, delta=4, msg="the pin holds it")
        self.assertGreater(level_top - top, 0.08 * (right - left), "a tenth of its size")
        self.assertLess(abs(low - level_low), 5)
        put(moment, 0)
        put(".amplitude", 0.05)
        self.assertAlmostEqual(level_top - extremes()[2], 0.5 * (level_top - top), delta=4, msg="half as far")

        options = self.browser.script(f"return [...{figure}.querySelectorAll('select[aria-label=Mode] option')].map((one) => one.text)")
        self.assertEqual(options, ["Mode 1: 0.9549 Hz (6 rad/s), damping ratio 0.02",
                                   "Mode 2: 1.592 Hz (10 rad/s), grows as exp(0.5 t)"])
        self.browser.script(f"""
            const list = {figure}.querySelector('select[aria-label=Mode]');
            list.selectedIndex = 1;
            list.dispatchEvent(new Event('change'))""")
        # Around a circle: at the start up, a quarter later to the left, since Re(i exp(i pi/2)) = -1.
        first = extremes()
        put(moment, 15)
        second = extremes()
        self.assertGreater(second[3] - first[3], 20)
        self.assertGreater(first[0] - second[0], 20)

    def test_names_of_joints_stand_in_the_key_numbers_with_what_they_bear(self):
        def rows(words):
            return self.browser.script("""
                const table = [...document.querySelectorAll('.table')].find((candidate) => candidate.textContent.includes(arguments[0]));
                return [...table.querySelectorAll('tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent))""", words)

        # 1 kg at 0.5 m that turns with pi^2/2 rad/s at the start: 0.5 (pi^2/2)^2 N.
        self.assertEqual(rows("Largest reactions of the joints"), [["hinge pin", "12.18", "0"]])
        # It rises by 3 N m in a second: root mean square sqrt(3).
        self.assertEqual(rows("Drives, laws and friction"), [["hinge pin", "Law moment [N m]", "3", "1", "1.732", "3"]])
        # A quarter of a turn from the right, in the row next to half of the time.
        self.assertEqual(rows("Angles of the joints")[0][2:4], ["1.571", "0.5041"])

    def test_nodes_inside_beams_are_listed_where_asked_for(self):
        number = self.figure("pendulum", "Motion of the coordinates")
        self.assertEqual(self.legend(number), ["arm.x", "arm.y"])
        self.choose(number, "All nodes")
        self.browser.wait(f"return document.querySelectorAll('#figure-{number} .legendtext').length === 3")
        self.assertEqual(self.legend(number), ["arm.x", "arm.y", "arm:1.x"])

    def test_events_of_joints_have_a_mark_a_kind(self):
        number = self.figure("pendulum", "Events of the joints")
        self.assertEqual(self.legend(number), ["Stop holds", "Stop lets go", "Sticks", "Slips"])
        ticks = self.browser.script(f"return [...document.querySelectorAll('#figure-{number} .ytick')].map((tick) => tick.textContent).filter((text) => text)")
        self.assertEqual(ticks, ["hinge pin"])

    def test_a_warning_is_told_once_with_the_analyses_that_it_is_of(self):
        warnings = self.browser.script("return [...document.querySelectorAll('.warning')].map((node) => node.textContent)")
        self.assertEqual(warnings, ["Warning, swinging, pendulum: \"hinge pin x\" repeats what other joints say"])
        findings = self.browser.script("return document.querySelector('#table-1').textContent")
        self.assertIn("\"hinge pin\" locks at t = 0.4 s", findings)
        self.assertNotIn("steps:", findings)
        self.assertIn("Steps100", self.browser.script("return document.querySelector('main').textContent"))

    def test_a_mechanism_is_drawn_with_its_body_its_pin_and_its_stop(self):
        number = self.browser.script("""
            const figure = [...document.querySelectorAll('figure')].find((candidate) =>
              candidate.textContent.includes('The structure in motion (2 bodies and nodes, 1 joint)'));
            figure.scrollIntoView({behavior: 'instant'});
            return figure.id.replace('figure-', '')""")
        figure = f"document.querySelector('#figure-{number}')"
        self.browser.wait(f"return {figure}.querySelector('canvas').width > 300")

        def count(color):
            """Pixels of a colour."""
            return self.browser.script(f"""
                const canvas = {figure}.querySelector('canvas'), copy = document.createElement('canvas');
                [copy.width, copy.height] = [canvas.width, canvas.height];
                const pen = copy.getContext('2d', {{willReadFrequently: true}});
                pen.drawImage(canvas, 0, 0);
                const {{data}} = pen.getImageData(0, 0, canvas.width, canvas.height);
                let count = 0;
                for (let i = 0; i < data.length; i += 4) count += arguments[0].every((value, place) => data[i + place] === value);
                return count""", color)

        def put(frame):
            self.browser.script(f"""
                const scrub = {figure}.querySelector('input[aria-label=Moment]');
                scrub.value = arguments[0];
                scrub.dispatchEvent(new Event('input'))""", str(frame))

        orange, tint = [213, 94, 0], [233, 239, 243]
        self.assertGreater(count(tint), 1000, "the box has an area")
        put(55)
        open_stop = count(orange)
        put(70)  # after 0.49 s
        self.assertGreater(count(orange), 2 * open_stop, "the stop is filled while it holds")
        put(85)
        self.assertLess(count(orange), 1.5 * open_stop)
        options = self.browser.script(f"return [...{figure}.querySelectorAll('select[aria-label=Speed] option')].map((one) => one.text)")
        self.assertEqual(options[0], "0.1 \u00d7 real time", "a second in about eight")
        self.assertIn("real time", options)
        # Frames crowd at the start: playback goes by their times.
        put(0)
        self.browser.script(f"window.began = performance.now(); {figure}.querySelector('.play').click()")
        time.sleep(1.0)
        passed, told = self.browser.script(f"""
            {figure}.querySelector('.play').click();
            return [performance.now() - window.began, {figure}.querySelector('.moment').textContent]""")
        self.assertAlmostEqual(float(told.removeprefix("t = ").removesuffix(" s")), 1e-4 * passed, delta=0.03)
        ink = count([28, 36, 44])
        self.browser.script(f"""
            const list = {figure}.querySelector('select[aria-label=Names]');
            list.selectedIndex = 2;
            list.dispatchEvent(new Event('change'))""")
        self.assertGreater(count([28, 36, 44]), ink, "the name of the joint")

    def test_a_failure_is_told_first_with_its_message(self):
        self.assertIn("did not converge", self.browser.script("return document.querySelector('.alarm').textContent"))

    def test_paper_shows_every_figure(self):
        pdf = base64.b64decode(self.browser.command("Page.printToPDF", {"preferCSSPageSize": True})["data"])
        self.assertTrue(pdf.startswith(b"%PDF"))
        if len(sys.argv) > 1:
            pathlib.Path(sys.argv[1]).write_bytes(pdf)
        missing = self.browser.script(
            "return [...document.querySelectorAll('figure')].filter((figure) => !figure.querySelector('.main-svg, canvas')).length")
        self.assertEqual(missing, 0)


if __name__ == "__main__":
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        print("skipped: chromium or chromedriver is not installed")
        sys.exit(77)
    try:
        socket.create_server(("127.0.0.1", 0)).close()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect(("127.0.0.1", 9))
    except OSError as fault:
        print(f"skipped: chromedriver is spoken to over 127.0.0.1, which this machine lacks: {fault}")
        sys.exit(77)
    page = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(argv=["browser_test"], verbosity=2)
