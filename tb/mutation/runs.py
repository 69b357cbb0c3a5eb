"""Which tests there are, what they reach, and what they say of a mutant."""
import hashlib
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor

from tree import say

# A test with a mutant on may take so many times the processor time of the same test without, and the
# configuration's `extra_seconds`; and so many times its time by the clock and a minute: one that waits for what never
# comes uses none.
TIMES = 4
WALL_TIMES = 5
MEMORY = 8 << 30   # bytes of address space
FILE_SIZE = 1 << 30


def limits(cpu):
    def set_them():
        resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu + 5))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_SIZE, FILE_SIZE))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    return set_them


class Test:
    def __init__(self, entry):
        self.alone = threading.Lock()  # a test's processes may write to the same files
        self.name = entry['name']
        self.command = entry.get('command', [])
        properties = {p['name']: p['value'] for p in entry.get('properties', [])}
        self.labels = properties.get('LABELS', [])
        self.folder = properties.get('WORKING_DIRECTORY')
        self.environment = dict(e.split('=', 1) for e in properties.get('ENVIRONMENT', []))
        self.skip = properties.get('SKIP_RETURN_CODE')
        self.inverted = bool(properties.get('WILL_FAIL')) or 'PASS_REGULAR_EXPRESSION' in properties

    def fingerprint(self):
        """Changes when the test's program, its script or a file among its arguments does."""
        digest = hashlib.sha256(json.dumps(self.command).encode())
        for word in self.command:
            path = pathlib.Path(word)
            if path.is_file():
                digest.update(path.read_bytes())
        return digest.hexdigest()[:16]

    def run(self, environment, cpu, wall):
        """Returns passed, and the seconds used of the processor and by the clock. One process of a test runs at a
        time."""
        with self.alone:
            return self.run_alone(environment, cpu, wall)

    def run_alone(self, environment, cpu, wall):
        before = time.monotonic()
        full = dict(os.environ, GTEST_FAIL_FAST='1', **self.environment, **environment)
        try:
            process = subprocess.Popen(
                self.command, cwd=self.folder, env=full, stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
                preexec_fn=limits(cpu))
        except OSError as error:
            say(f'{self.name}: {error}')
            return False, 0.0, 0.0
        deadline = time.monotonic() + wall
        usage = None
        while usage is None:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                usage, code = used, os.waitstatus_to_exitcode(status)
            elif time.monotonic() > deadline:
                break
            else:
                time.sleep(0.005 if time.monotonic() - before < 1 else 0.05)
        try:  # what a script left running, or all of a test that takes too long
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        if usage is None:
            _, _, usage = os.wait4(process.pid, 0)
            code = -signal.SIGKILL
        process.returncode = code
        return code == 0, usage.ru_utime + usage.ru_stime, time.monotonic() - before


class Runs:
    """Results are kept after each step, so that a later call can go on."""

    def __init__(self, tree, mutants, budget, jobs, only=None):
        self.tree, self.budget, self.jobs = tree, budget, jobs
        self.extra = tree.config['tests']['extra_seconds']
        self.mutants = {m['id']: m for m in mutants}
        self.file = tree.out / 'results.json'
        self.state = {'tests': {}, 'mutants': {}}
        if self.file.exists():
            self.state = json.loads(self.file.read_text())
        self.changing = threading.Lock()  # of the state
        self.save()
        self.tests = {t.name: t for t in self.listed() if not only or re.search(only, t.name)}
        self.reached = {}

    def save(self):
        temporary = self.file.with_suffix('.new')
        temporary.write_text(json.dumps(self.state))
        temporary.replace(self.file)

    def each(self, function, items, end):
        """Calls function(number, item) for the items, as many at a time as there are jobs. False if the time was over
        before the last one began."""
        def one(numbered):
            if time.monotonic() > end:
                return False
            function(*numbered)
            return True
        with ThreadPoolExecutor(self.jobs) as pool:
            return all(list(pool.map(one, enumerate(items))))

    def listed(self):
        listing = subprocess.run(['ctest', '--test-dir', self.tree.build, '--show-only=json-v1'],
                                 capture_output=True, text=True, check=True).stdout
        rules = self.tree.config['tests']
        for entry in json.loads(listing)['tests']:
            test = Test(entry)
            if not test.command or test.inverted or any(
                    re.search(r, test.name) for r in rules['leave_out']):
                continue
            if set(test.labels) & set(rules['leave_out_labels']):
                continue
            if not os.path.exists(test.command[0]):
                say(f'not built, so not run: {test.name}')
                continue
            yield test

    def reach(self, end):
        """Runs every test once with no mutant on. False if the time was over before."""
        todo = []
        for name, test in self.tests.items():
            test.print = test.fingerprint()
            known = self.state['tests'].get(name, {})
            if known.get('print') != test.print or not known['passed']:
                todo.append(test)

        def one(number, test):
            map_file = self.tree.out / f'reached.{threading.get_ident()}'
            map_file.write_bytes(bytes(65536))
            passed, seconds, wall = test.run({'FOVEA_MUTANT_REACHED': str(map_file)}, 1200, 1800)
            reached = [i for i, b in enumerate(map_file.read_bytes()) if b]
            map_file.unlink()
            note = '' if passed else ' FAILS WITH NO MUTANT ON: left out'
            say(f'reach {number + 1}/{len(todo)}: {test.name} {seconds:.1f} s, '
                f'{len(reached)} mutants{note}')
            with self.changing:
                self.state['tests'][test.name] = {
                    'print': test.print, 'seconds': seconds, 'wall': wall, 'passed': passed, 'reached': reached}
                self.save()
        return self.each(one, todo, end)

    def order(self, mutant):
        """Tests that reach the mutant, the quick ones first; those of its own layer as if they took a hundredth: they
        are the likely ones, and what is left when the budget is spent should be others."""
        own = self.tree.areas.own_tests(mutant['area'])
        found = []
        for name in self.tests:
            known = self.state['tests'].get(name)
            if known and known['passed'] and mutant['id'] in self.reached[name]:
                found.append((known['seconds'] * (1 if own.search(name) else 100), name))
        return [name for _, name in sorted(found)]

    def most(self, known):
        """Seconds of the processor and by the clock that a test may take with a mutant on."""
        return (int(self.extra + TIMES * known['seconds']),
                60 + WALL_TIMES * max(known.get('wall', 0), known['seconds']))

    def judge(self, mutant, record):
        """Runs tests until one fails; notes which passed."""
        spent, record['left'] = 0.0, 0
        for name in self.order(mutant):
            test, known = self.tests[name], self.state['tests'][name]
            if record['passed'].get(name) == test.print:
                spent += known['seconds']
                continue
            if spent and spent + known['seconds'] > self.budget:
                record['left'] += 1
                continue
            passed, seconds, _ = test.run({'FOVEA_MUTANT': str(mutant['id'])}, *self.most(known))
            spent += seconds
            if not passed:
                record['killed'] = name
                record['passed'] = {}
                return
            record['passed'][name] = test.print

    def judge_all(self, ids, end):
        self.reached = {n: set(k['reached']) for n, k in self.state['tests'].items()}

        def one(number, i):
            mutant, before = self.mutants[i], time.monotonic()
            with self.changing:
                kept = self.state['mutants'].get(str(i), {'passed': {}})
            if 'killed' in kept:
                return
            record = dict(kept, passed=dict(kept['passed']))
            self.judge(mutant, record)
            how = f'killed by {record["killed"]}' if 'killed' in record else \
                f'SURVIVED {len(record["passed"])} tests'
            say(f'{number + 1}/{len(ids)}: {i} {mutant["file"]}:{mutant["line"]} {how} '
                f'({time.monotonic() - before:.0f} s)')
            with self.changing:
                self.state['mutants'][str(i)] = record
                self.save()
        return self.each(one, ids, end)
