#!/usr/bin/env python3
"""Looks at reports in headless Chromium: console, figures, keyboard, accessibility, screenshots, nothing from the net."""
import json
import re
import sys
import unittest
from pathlib import Path

from chromium import Page

OUT = Path(sys.argv[1])  # further arguments are those of unittest, such as -k keyboard
HERE = Path(__file__).parent
PAGES = {"one": ["default"], "all": ["all-files"], "bare": ["bare"], "two": ["default", "all-files"],
         "view": ["view"], "engine": ["engine"], "cameras": ["cameras"], "partial": ["partial"], "zero": ["zero"]}
LOOKS = [("light", 1280, False, ""), ("dark", 1280, True, ""), ("narrow", 390, False, ""), ("print", 800, False, "print")]
PREFIX = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1, "m": 1e-3, "u": 1e-6, "n": 1e-9}


def visible_value(text):
    """The number that a reader takes from a text such as "28.66 ms", "4.147 MB" or "17.2 %"; its relative precision."""
    found = re.fullmatch(r"(-?[0-9,.]+(?:e[+-]?\d+)?) ?(.*)", text.strip())
    digits, unit = found[1].replace(",", ""), found[2]
    scale = 1.0
    if unit == "%":
        scale = 0.01
    elif re.fullmatch(r"[GMkmun](s|B|W)", unit):
        scale = PREFIX[unit[0]]
    mantissa = digits.split("e")[0]
    last = 10.0 ** -(len(mantissa.split(".")[1]) if "." in mantissa else 0)
    power = 10.0 ** int(digits.split("e")[1]) if "e" in digits else 1.0
    return float(digits) * scale, 0.5001 * last * power * scale


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = Page()

    @classmethod
    def tearDownClass(cls):
        cls.page.close()

    def setUp(self):
        self.page.errors.clear()
        self.page.requests.clear()
        self.page.look(1280)

    def open(self, name):
        self.page.open(OUT / f"{name}.html")

    def test_no_errors_and_nothing_from_the_net(self):
        for name in PAGES:
            with self.subTest(name):
                self.open(name)
                self.assertEqual(self.page.errors, [])
                self.assertEqual([r for r in self.page.requests if not r.startswith(("file:", "data:"))], [])
                self.assertLess((OUT / f"{name}.html").stat().st_size, 3_000_000)

    def test_a_fault_of_the_script_is_noticed(self):
        self.open("one")
        self.page.run("setTimeout(() => { throw new Error('planted'); }, 0)")
        self.page.run("new Promise((done) => setTimeout(done, 50))")
        self.assertEqual(len(self.page.errors), 1)

    def test_figures_are_those_of_stats_json(self):
        for name, folders in PAGES.items():
            self.open(name)
            stats = [json.loads((OUT / folder / "stats.json").read_text()) for folder in folders]
            hosts = [json.loads((OUT / f / "host.json").read_text()) if (OUT / f / "host.json").exists() else {} for f in folders]
            data = self.page.run("JSON.parse(document.getElementById('data').textContent)")
            for run, expected in zip(data["runs"], stats):
                values = {k: v["value"] for k, v in expected.items() if isinstance(v, dict) and v.get("value") is not None}
                self.assertEqual({k: v[0] for k, v in run["stats"].items()}, values)
            cells = self.page.run("[...document.querySelectorAll('data[data-figure]')].map((d) => [d.dataset.figure, d.value, d.textContent])")
            self.assertGreater(len(cells), 100)
            for figure, exact, shown in cells:
                known = [s[figure]["value"] for s in (*stats, *hosts) if figure in s]
                self.assertIn(float(exact), known, figure)
                value, error = visible_value(shown)
                self.assertLessEqual(abs(value - float(exact)), max(error, abs(float(exact)) * 1e-9), f"{figure}: {shown}")

    def test_every_chart_is_drawn_and_named(self):
        for name in PAGES:
            self.open(name)
            bad = self.page.run("""[...document.querySelectorAll('[data-chart]')].filter((place) => {
                const svg = place.querySelector('svg');
                return !(svg && svg.getBoundingClientRect().height > 40 && svg.getAttribute('aria-label')?.length > 10) && !place.querySelector('.absent');
              }).map((place) => place.dataset.chart)""")
            self.assertEqual(bad, [], name)
            self.assertNotIn("NaN", self.page.run("[...document.querySelectorAll('svg')].map((s) => s.outerHTML).join()"))
        self.open("all")
        kinds = set(self.page.run("[...document.querySelectorAll('[data-chart]')].map((p) => p.dataset.chart)"))
        self.assertEqual(kinds, {"frames", "frame-times", "bandwidth-detail", "bandwidth-whole", "percentiles", "latency", "waterfall", "banks", "flame"})
        self.open("bare")
        self.assertGreaterEqual(self.page.run("document.querySelectorAll('.absent').length"), 4)

    def test_a_composed_view_has_all_its_cameras(self):
        self.open("view")
        captions = self.page.run("[...document.querySelectorAll('.cameras figcaption')].map((c) => c.textContent)")
        self.assertEqual([c.split(",")[0] for c in captions], [f"Camera {n}" for n in range(4)])
        widths = self.page.run("[...document.querySelectorAll('.cameras img')].map((i) => i.naturalWidth)")
        self.assertTrue(all(w > 100 for w in widths), widths)

    def test_the_engine_is_named(self):
        self.open("engine")
        text = self.page.run("document.body.innerText")
        self.assertIn("the core sleeps until the remap engine is done", text)
        self.assertRegex(text, r"It has nothing to do in [0-9.]+ %")
        self.assertRegex(text, r"The interrupt that ended the sleep came from: .*the remap engine [0-9.]+ %")

    def test_a_run_without_frames_and_a_partial_one_say_so(self):
        self.open("zero")
        self.assertGreaterEqual(self.page.run("document.querySelectorAll('.absent').length"), 1)
        self.open("partial")
        self.assertRegex(self.page.run("document.querySelector('main').innerText"), r"(?i)partial|not complete|did not complete|stopped")

    def test_waterfall_adds_up(self):
        self.open("all")
        titles = self.page.run("[...document.querySelectorAll('[data-chart=waterfall] svg title')].map((t) => t.textContent)")
        stats = json.loads((OUT / "all-files/stats.json").read_text())
        awake = stats["cpu.cycles"]["value"] - stats["cpu.idle"]["value"]
        shown = sum(int(re.search(r": ([0-9,]+) clocks", t)[1].replace(",", "")) for t in titles)
        self.assertLessEqual(abs(shown - awake), len(titles))

    def test_keyboard(self):
        self.open("all")
        page = self.page
        page.key("Tab")
        self.assertEqual(page.run("document.activeElement.className"), "skip")
        seen = []
        for _ in range(400):
            page.key("Tab")
            seen.append(page.run("(() => { const e = document.activeElement; return e === document.body ? 'end' : `${e.tagName} ${e.type ?? ''} ${getComputedStyle(e).outlineStyle !== 'none' || !!e.closest('svg')}`; })()"))
            if seen[-1] == "end":
                break
        for kind in ("BUTTON button true", "A  true", "INPUT radio true", "INPUT range true", "SUMMARY  true", "g  true", "DIV  true"):
            self.assertIn(kind, seen)
        # The slider.
        page.run("document.querySelector('.compare input[type=range]').focus()")
        page.key("ArrowRight")
        self.assertEqual(page.run("document.querySelector('.compare .stack').style.getPropertyValue('--cut')"), "51%")
        # The difference.
        page.run("document.querySelector('.compare input[value=slider]').focus()")
        for _ in range(3):
            page.key("ArrowRight")
        self.assertEqual(page.run("document.querySelector('.compare .stack').className"), "stack difference")
        self.assertEqual(page.run("getComputedStyle(document.querySelector('.compare .two')).mixBlendMode"), "difference")
        # Reading a chart.
        page.run("document.querySelector('[data-chart=bandwidth-whole] [tabindex]').focus()")
        page.key("End")
        first = page.run("document.querySelector('[data-chart=bandwidth-whole] .readout').textContent")
        page.key("ArrowLeft")
        self.assertRegex(first, r"ms: .*arm_d .* MB/s")
        self.assertNotEqual(first, page.run("document.querySelector('[data-chart=bandwidth-whole] .readout').textContent"))
        # Widening a box of the call stacks, and back.
        boxes = "document.querySelectorAll('[data-chart=flame] g').length"
        before = page.run(boxes)
        page.run("[...document.querySelectorAll('[data-chart=flame] g')].find((g) => g.getAttribute('aria-label')?.startsWith('remap,')).focus()")
        page.key("Enter", text="\r")
        self.assertLess(page.run(boxes), before)
        page.key("Escape")
        self.assertEqual(page.run(boxes), before)

    def test_tables_sort_and_search(self):
        self.open("all")
        order = "[...document.querySelectorAll('#functions tbody tr')].map((r) => Number(r.cells[1].querySelector('data').value))"
        given = self.page.run(order)
        self.assertEqual(given, sorted(given, reverse=True))
        self.page.run("document.querySelectorAll('#functions th button')[1].focus()")
        self.page.key("Enter", text="\r")
        self.assertEqual(self.page.run(order), sorted(given, reverse=True))
        self.page.key("Enter", text="\r")
        self.assertEqual(self.page.run(order), sorted(given))
        self.assertEqual(self.page.run("document.querySelector('#functions th[aria-sort]').getAttribute('aria-sort')"), "ascending")
        self.page.run("document.querySelector('#figures details').open = true")
        self.page.run("(() => { const f = document.querySelector('#figures input'); f.value = 'ddr.bank3'; f.dispatchEvent(new Event('input')); })()")
        self.assertEqual(self.page.run("[...document.querySelectorAll('#figures tbody tr')].filter((r) => !r.hidden).length"), 3)

    def test_colours_follow_the_system_and_the_button(self):
        self.page.look(1280, dark=True)
        self.open("one")
        self.assertEqual(self.page.run("document.documentElement.dataset.theme"), "dark")
        self.page.run("document.querySelector('#controls button').focus()")
        self.page.key("Enter", text="\r")
        self.assertEqual(self.page.run("document.documentElement.dataset.theme"), "light")

    def test_no_sideways_scrolling(self):
        for name in PAGES:
            for width in (390, 800, 1280):
                self.page.look(width)
                self.open(name)
                self.assertLessEqual(self.page.run("document.documentElement.scrollWidth"), width, f"{name} {width}")

    def axe(self):
        # Through the protocol, because the page's policy lets no other script in.
        self.page.run((HERE / "axe-core/axe.min.js").read_text() + "; true")
        found = self.page.run("axe.run(document, {resultTypes: ['violations']}).then((r) => r.violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target.join(' ')).slice(0, 4).join(' | ')}`))")
        return found

    def test_accessible(self):
        for name in PAGES:
            for dark in (False, True):
                with self.subTest(f"{name} {'dark' if dark else 'light'}"):
                    self.page.look(1280, dark)
                    self.open(name)
                    self.page.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
                    self.assertEqual(self.axe(), [])

    def test_axe_complains_of_a_picture_without_text(self):
        self.open("one")
        self.page.run("document.querySelector('main img').removeAttribute('alt')")
        self.assertTrue(any(v.startswith("image-alt") for v in self.axe()))

    def test_paper_has_no_heading_without_content_and_no_table_beyond_its_edge(self):
        self.page.look(720, medium="print")  # of a page in pixels of CSS
        for name in PAGES:
            self.open(name)
            bare = self.page.run("""[...document.querySelectorAll('main section')].filter((s) => s.getBoundingClientRect().height > 0 &&
                ![...s.children].some((c) => c.tagName !== 'H2' && c.getBoundingClientRect().height > 0)).map((s) => s.id)""")
            self.assertEqual(bare, [], name)
            self.assertGreater(self.page.run("document.querySelector('#verdict').getBoundingClientRect().height"), 100)
            self.assertLessEqual(self.page.run("Math.max(...[...document.querySelectorAll('table, svg, img')].map((e) => e.getBoundingClientRect().right))"), 720, name)
        # What the reader has opened is printed.
        self.page.run("document.querySelector('#figures details').open = true")
        self.assertGreater(self.page.run("document.querySelector('#figures table').getBoundingClientRect().height"), 100)

    def test_screenshots(self):
        for name in PAGES:
            for look, width, dark, medium in LOOKS:
                self.page.look(width, dark, medium)
                self.open(name)
                file = OUT / f"{name}-{look}.png"
                self.page.screenshot(file)
                self.assertGreater(file.stat().st_size, 50_000)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[2:]])
