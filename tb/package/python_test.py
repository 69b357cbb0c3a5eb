#!/usr/bin/env python3
"""The Python package of sw/python: each value that it reads of a run, an exec, a replay and a partial run is that of the
C++ reader, compared as text; it starts the program, and says what is wrong.
Usage: python_test.py FOVEA READER PROGRAM SOURCE OUT [--experiments]
  READER         tb/package/reader.cpp, built
  PROGRAM        a program that prints its arguments
  --experiments  the results of every shipped experiment instead, of two frames each"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

FOVEA, READER, PROGRAM, SOURCE, OUT = (pathlib.Path(a).resolve() for a in sys.argv[1:6])
sys.path.insert(0, str(SOURCE / "sw/python"))
os.environ["FOVEA"] = str(FOVEA)
import fovea  # noqa: E402

SMALL = {"run.frames": 2, "run.start_limit": "2s", "camera.kind": "chart", "camera.stamp": False, "video.width": 64,
         "video.height": 16}


def as_text(value):
    return "none" if value is None else repr(value) if isinstance(value, float) else str(value)


def plain(text):
    return text.replace("\n", " ").replace("\t", " ")


class Folder(unittest.TestCase):
    def compare(self, folder, partial=False):
        """Every line of the C++ reader against the package's value. @return how many there were of each kind"""
        mine = fovea.read(folder, partial)
        said = subprocess.run([READER, folder], capture_output=True, text=True, check=True).stdout
        counts, tables = {}, {}
        figures = {"stats": mine.stats, "host": mine.host}
        for line in said.splitlines():
            kind, *words = line.split("\t")
            counts[kind] = counts.get(kind, 0) + 1
            if kind == "figure":
                file, name, value, unit, description = words
                self.assertEqual(as_text(figures[file][name]), value, line)
                self.assertEqual([figures[file].unit(name), plain(figures[file].description(name))],
                                 [unit, description])
            elif kind == "param":
                self.assertEqual(plain(mine.params[words[0]]), words[1])
            elif kind == "word":
                value = getattr(mine, words[0]) if hasattr(mine, words[0]) else mine.config[words[0]]
                self.assertEqual(str(value).lower() if isinstance(value, bool) else value, words[1])
            elif kind == "warning":
                self.assertIn(words, [[w["kind"], str(w["count"]), plain(w["what"])] for w in mine.warnings])
            else:
                table, row, column, text, number = words
                if table not in tables:
                    tables[table] = mine.table(table)
                value = tables[table][int(row)][column]
                if isinstance(value, str):
                    self.assertEqual(plain(value), text, line)
                elif value is None:
                    self.assertEqual(text, "", line)
                else:
                    self.assertEqual(as_text(value), text if isinstance(value, int) else number, line)
        self.assertEqual(counts["figure"], len(mine.stats) + len(mine.host))
        self.assertEqual(counts["param"], len(mine.params))
        self.assertEqual(counts.get("warning", 0), len(mine.warnings))
        self.assertEqual(counts.get("cell", 0), sum(len(r) for t in folder.glob("*.csv") for r in mine.table(t.stem)))
        return counts


class Experiments(Folder):
    def test_every_experiment(self):
        names = sorted(f.stem for f in (SOURCE / "scripts/experiments").glob("*.yaml"))
        names.remove("evm")  # runs a program of one's own, without an end
        self.assertGreater(len(names), 12)
        for name in names:
            with self.subTest(name):
                fovea.run(name, {"run.frames": 2}, "--profile", "--no-frames", out=OUT / name)
                self.assertGreater(self.compare(OUT / name)["cell"], 1000)


class Package(Folder):
    @classmethod
    def setUpClass(cls):
        cls.small = fovea.run("default", SMALL, "--profile", "--no-frames", "--bus-trace", str(OUT / "a.trace"),
                              out=OUT / "a")

    def test_a_run(self):
        counts = self.compare(OUT / "a")
        self.assertGreater(counts["figure"], 500)
        self.assertGreater(counts["cell"], 1000)
        stats = self.small.stats
        self.assertIsInstance(stats["frame.displayed"], int)
        self.assertEqual(stats["frame.displayed"], 2)
        self.assertIsInstance(stats["frame.remap_time.mean"], float)
        self.assertEqual(stats.unit("frame.remap_time.mean"), "s")
        self.assertEqual([row["frame"] for row in self.small.frames], [0, 1])
        self.assertEqual(sum(row["cycles"] for row in self.small.stalls),
                         stats["cpu.cycles"] - stats["cpu.issue"] - stats["cpu.idle"])
        self.assertEqual(self.small.params["video.width"], "64")
        self.assertIn("default", repr(self.small))

    def test_names_that_do_not_exist(self):
        with self.assertRaisesRegex(KeyError, "did you mean 'frame.displayed'"):
            self.small.stats["frame.displaid"]
        with self.assertRaises(KeyError):
            self.small.stats.unit("none")
        with self.assertRaisesRegex(AttributeError, "has no requests.csv; allowed: .*stalls"):
            self.small.requests
        with self.assertRaisesRegex(fovea.ResultsError, "has no requests.csv"):
            self.small.table("requests")

    def test_an_exec(self):
        done = fovea.exec(PROGRAM, ["a b", "--profile"], None, "--profile", out=OUT / "exec")
        self.assertIn("a b", done.printed)
        self.assertIn("--profile", done.printed)
        self.assertGreater(self.compare(OUT / "exec")["figure"], 50)
        self.assertEqual(done.config["command"], "exec")

    def test_a_replay(self):
        done = fovea.replay(OUT / "a.trace", {"ddr.request_latency": "8 cycles"}, out=OUT / "replay")
        self.assertGreater(self.compare(OUT / "replay")["cell"], 100)
        self.assertEqual(done.params["ddr.request_latency"], "8 cycles")

    def test_partial_results(self):
        with self.assertRaisesRegex(fovea.RunFailed, "showed no frame|partial") as failed:
            fovea.run("default", {**SMALL, "run.start_limit": "10ms"}, "--no-frames", out=OUT / "stopped")
        self.assertEqual(failed.exception.status, 3)
        self.assertFalse(failed.exception.results.complete)
        self.assertIn(b'"complete": false', (OUT / "stopped/stats.json").read_bytes())
        self.assertGreater(self.compare(OUT / "stopped", True)["figure"], 500)
        with self.assertRaisesRegex(fovea.ResultsError, "holds partial results"):
            fovea.read(OUT / "stopped")
        # Complete results stay, and the partial ones lie beside them.
        with self.assertRaises(fovea.RunFailed) as failed:
            fovea.run("default", {**SMALL, "run.start_limit": "10ms"}, "--no-frames", out=OUT / "a")
        self.assertEqual(failed.exception.results.folder, OUT / "a.partial")
        self.assertTrue(fovea.read(OUT / "a").complete)

    def test_what_the_program_refuses(self):
        with self.assertRaisesRegex(fovea.RunFailed, "run.frame.*did you mean") as failed:
            fovea.run("default", {"run.frame": 2})
        self.assertEqual([failed.exception.status, failed.exception.results], [2, None])
        with self.assertRaisesRegex(fovea.RunFailed, "neither a file nor a shipped experiment; allowed: .*paper-pal"):
            fovea.run("paper-pall")

    def test_results_without_a_folder_of_ones_own(self):
        results = fovea.run("default", SMALL)
        folder = results.folder
        self.assertEqual(results.stats["cpu.cycles"], self.small.stats["cpu.cycles"])
        self.assertTrue(folder.is_dir())
        del results
        self.assertFalse(folder.exists())

    def test_an_interrupt_leaves_partial_results(self):
        def interrupt():
            while not (OUT / "long.tmp/config.json").exists():
                time.sleep(0.01)
            time.sleep(0.5)
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt, daemon=True).start()
        with self.assertRaises(KeyboardInterrupt):
            fovea.run("default", {**SMALL, "run.frames": 100000}, "--no-frames", out=OUT / "long")
        self.assertFalse(fovea.read(OUT / "long", partial=True).complete)

    def test_numbers_as_the_program_reads_them(self):
        folder = OUT / "numbers"
        shutil.copytree(OUT / "a", folder)
        values = {"a": "18446744073709551615", "b": "-3", "c": "1e-7", "d": "1.0", "e": "null", "f": "2.5e300"}
        stats = "".join(f'"{n}": {{"value": {v}, "unit": "1", "description": ""}}, ' for n, v in values.items())
        (folder / "stats.json").write_text("{" + stats + '"complete": true, "later": [1]}')
        (folder / "stalls.csv").write_bytes(b'\r\ncause,cycles,more\r\n"a ""b"", c",1,\r\n\r\nd,18446744073709551615,0.250\r\n')
        self.assertEqual(self.compare(folder)["cell"] > 6, True)
        read = fovea.read(folder)
        self.assertEqual(read.stalls, [{"cause": 'a "b", c', "cycles": 1, "more": None},
                                       {"cause": "d", "cycles": 18446744073709551615, "more": 0.25}])
        self.assertEqual(list(read.stats.values()), [18446744073709551615, -3.0, 1e-7, 1.0, None, 2.5e300])

    def test_damaged_tables_and_files(self):
        folder = OUT / "damaged"
        shutil.copytree(OUT / "a", folder)
        for text in (b"a,b\n1\n", b'a\n"b\n', b"", b"a\n\xff\n"):
            (folder / "stalls.csv").write_bytes(text)
            with self.assertRaisesRegex(fovea.ResultsError, r"stalls.csv'.*"):
                fovea.read(folder).stalls
        for text in ("[" * 100000, "{", '{"complete": true, "x": NaN}', "[]",
                     '{"complete": true, "x": 1e999}', '{"complete": true, "x": ' + "9" * 400 + "}", '{"complete": true, "a": {"value": true, "unit": "1"}}'):
            (folder / "stats.json").write_text(text)
            with self.assertRaisesRegex(fovea.ResultsError, r"stats.json'.*damaged"):
                fovea.read(folder)


if __name__ == "__main__":
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    wanted = Experiments if sys.argv[6:] == ["--experiments"] else Package
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(wanted)
    sys.exit(not unittest.TextTestRunner().run(suite).wasSuccessful())
