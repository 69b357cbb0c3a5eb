#!/usr/bin/env python3
"""Plants changes whose effect is known into the firmware, and counts how often 'fovea check' blames the right function,
caller, cause and phase; and harmless ones, which nothing may be blamed for. Status: 0 as good as asked for, 1 not.

For each variant, OUT/NAME/truth.json says what is true of it; it is written from the plant before anything is run.
"""
import argparse
import collections
import dataclasses
import csv
import json
import pathlib
import random
import re
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import harmless  # noqa: E402
import plants  # noqa: E402
from firmware import Firmware, before_function, insert_into  # noqa: E402

SETTINGS = {'plain': ['-s', 'firmware.kernel=plain', '-s', 'video.width=128', '-s', 'video.height=32'],
            'staged': ['-s', 'firmware.kernel=staged', '-s', 'video.width=188', '-s', 'video.height=48']}
# Harmless changes are tried with more pixels: a remap of 0.1 ms is made 2 % longer by the few lines of code that it
# fetches anew, which another order of the same code changes.
LARGE = {kernel + '-large': [w.replace('=128', '=384').replace('=32', '=96').replace('=188', '=564')
                             .replace('=48', '=144') for w in words] for kernel, words in SETTINGS.items()}
EXPERIMENT = """run: {frames: 2, start_limit: 3s}
camera: {kind: chart, stamp: false}
firmware: {lut: fixed_point}
"""
# What a firmware team would watch, with the tolerance of a first baseline.
FIGURES = [('startup.lut_time', 's', 'higher'), ('startup.first_frame', 's', 'higher'),
           ('frame.remap_time.mean', 's', 'higher'), ('frame.latency.mean', 's', 'higher'),
           ('cpu.spare', 'cycles', 'lower'), ('ddr.utilisation', 'ratio', 'higher')]
PHASES = {'boot': 'before the first frame', 'lut': 'in phase lut', 'remap': 'in phase remap', 'frames': ''}
STATICS = {'fill_lut', 'choose_scales', 'set_row', 'append', 'first_row_sum', 'run_tiles', 'request',
           'open_bank', 'flip', 'captured_frame_done', 'capture_field_end', 'display_field_start', 'print_config'}


def arguments():
    p = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    p.add_argument('fovea')
    p.add_argument('build')
    p.add_argument('source')
    p.add_argument('out', type=pathlib.Path)
    p.add_argument('--seed', type=int, default=1, help='of the random choice; 0: of the clock (default 1)')
    p.add_argument('--plants', type=int, default=12)
    p.add_argument('--harmless', type=int, default=0)
    p.add_argument('--whole', action='store_true', help='also changes that touch many functions')
    p.add_argument('--least', type=float, default=90, help='per cent of the plants to be blamed right (default 90)')
    p.add_argument('--alarms', type=int, default=0, help='false alarms that are allowed (default 0)')
    return p.parse_args()


class Bench:
    def __init__(self, a):
        self.a, self.out = a, a.out.resolve()
        self.out.mkdir(parents=True, exist_ok=True)
        self.experiment = self.out / 'bench.yaml'
        self.experiment.write_text(EXPERIMENT)
        self.firmware = Firmware(a.build, a.source, self.out)
        self.known = {}

    def run(self, name, kernel, elf):
        """The run's folder, or None with the reason said."""
        folder = self.out / name / 'run'
        command = [self.a.fovea, 'run', str(self.experiment), '--profile', '--no-frames', *(SETTINGS | LARGE)[kernel], '-o',
                   str(folder), '-s', f'firmware.elf={elf or self.firmware.elf}']
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            print(f'{name}: the run ends with status {done.returncode}: {done.stderr.strip()[-300:]}')
            return None
        return folder

    def baseline(self, name, kernel, elf=None):
        """Of a run without a plant."""
        if name not in self.known:
            folder = self.run(name, kernel, elf)
            if not folder:
                raise SystemExit(4)
            stats = json.loads((folder / 'stats.json').read_text())
            config = json.loads((folder / 'config.json').read_text())
            commit = config['commit'] + ('-modified' if config.get('modified') else '')
            lines = ['format: fovea baseline 1', 'experiment: bench', 'simulator:', f'  version: {config["version"]}',
                     f'  commit: {commit}', f'reference: {name}-reference', 'metrics:']
            for figure, unit, worse in FIGURES:
                lines += [f'  {figure}:', f'    value: {stats[figure]["value"] * 0.5!r}', f'    unit: {stats[figure]["unit"]}',
                          '    tolerance: 1%', f'    worse: {worse}']
            file = self.out / f'{name}.yaml'
            file.write_text('\n'.join(lines + ['']))
            done = subprocess.run([self.a.fovea, 'bless', str(folder), '--against', str(file), '--why', 'before'],
                                  capture_output=True, text=True)
            if done.returncode:
                print(f'{name}: no baseline: {done.stderr or done.stdout}')
                raise SystemExit(4)
            self.known[name] = file
        return self.known[name]

    def check(self, folder, against):
        done = subprocess.run([self.a.fovea, 'check', str(folder), '--against', str(against)], capture_output=True,
                              text=True)
        return done.returncode, done.stdout + done.stderr

    # Plants

    def draw(self, rng):
        kernel = rng.choice(['plain', 'staged'])
        phase = rng.choice(['boot', 'lut', 'frames', 'remap'])
        sites = [s for s in plants.SITES if s.phase == phase and s.kernel in ('', kernel)]
        site = rng.choice(sites)
        kinds = [k.name for k in plants.KINDS] + ['method', 'same_name', 'renamed', 'twice']
        kind = rng.choice(kinds)
        if kind == 'method':
            return plants.methods(self.firmware, site, kernel, rng.choice(list(plants.METHODS)), insert_into)
        if kind == 'same_name':
            other = rng.choice([s for s in plants.SITES if s.file != site.file and s.kernel in ('', kernel)])
            return plants.same_name(self.firmware, site, other, kernel, insert_into, before_function)
        if kind == 'renamed' and site.function in STATICS:
            return plants.renamed(self.firmware, site, kernel, insert_into)
        if kind == 'twice':
            return plants.twice(self.firmware, kernel, rng.choice(['lut', 'remap', 'prepare']))
        if kind == 'renamed':
            kind = 'loop'
        return plants.simple(self.firmware, site, next(k for k in plants.KINDS if k.name == kind), kernel, insert_into,
                             before_function)

    def drawn(self, number, seed):
        rng, seen = random.Random(seed), set()
        while len(seen) < number:
            plant = self.draw(rng)
            if plant.name not in seen:
                seen.add(plant.name)
                yield plant

    def judge(self, plant):
        """Empty if it is blamed right, otherwise what is wrong."""
        folder = self.out / plant.name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / 'truth.json').write_text(json.dumps(dataclasses.asdict(plant.truth), indent=2) + '\n')
        elf = self.firmware.variant(plant.name, plant.changed, plant.extra, **plant.options)
        base = f'base-{plant.kernel}'
        before = None
        if plant.base_name:
            base = plant.base_name
            if base not in self.known:
                before = self.firmware.variant(base, plant.base_changed, plant.base_extra)
        against = self.baseline(base, plant.kernel, before)
        run = self.run(plant.name, plant.kernel, elf)
        if not run:
            return 'the run fails'
        status, text = self.check(run, against)
        (folder / 'check.txt').write_text(text)
        lines = [line for line in text.split('\n') if line.startswith('blamed: ')]
        truth = json.loads((folder / 'truth.json').read_text())
        if status != 1:
            return f'check ends with status {status}'
        if truth['most']:
            truth['functions'] = self.most(self.out / base / 'run', run, truth['phase'])
        wrong = [self.wrong(line, truth) for line in lines]
        if not lines or all(wrong):
            return '; '.join(w for w in wrong if w) or 'nothing is blamed'
        return ''

    @staticmethod
    def most(before, after, phase):
        """The functions with 80 % of the clocks that were added in a phase: by the two profiles alone."""
        sums = collections.Counter()
        for folder, sign in ((before, -1), (after, 1)):
            with (folder / 'profile.csv').open() as f:
                for r in csv.DictReader(f):
                    if r['phase'] == phase and not r['cause'].startswith('idle'):
                        sums[r['function']] += sign * int(r['clocks'])
        whole, named, out = sum(n for n in sums.values() if n > 0), 0, []
        for function, n in sums.most_common():
            if named >= 0.8 * whole or n <= 0:
                break
            out.append(function)
            named += n
        return out

    @staticmethod
    def wrong(line, truth):
        """What is wrong with a sentence."""
        phase = PHASES[truth['phase']]
        others = [p for p in PHASES.values() if p and p != phase]
        if not line.endswith(', ' + phase) if phase else any(line.endswith(', ' + p) for p in others):
            return f'not its phase: {line}'
        found = re.match(r'blamed: (.+?) \(([^()]*?)(?::\d+)?\) '
                         r'(executes|is new|waits|polls|takes|was moved|is gone)[^:]*: ([-+])', line)
        if not found:
            return f'no function: {line}'
        function, file, _, sign = found.groups()
        names = {function, f'{function}|{file}'}
        if truth['most']:
            # Beside the one that executes more: what it calls for it, and what follows.
            called = re.search(r' executes more in ([\w:> ]+): ', line)
            rest = {function, *re.findall(r'; ([\w:]+) [-+]', line), *(called.group(1).split(' > ') if called else [])}
            right = len(rest & set(truth['functions'])) >= min(2, len(truth['functions']))
        else:
            right = bool(names & set(truth['functions']))
        if not right:
            return f'not {"/".join(truth["functions"])}: {line}'
        if sign != truth['sign']:
            return f'the sign: {line}'
        if truth['leaf'] and truth['leaf'] not in line:
            return f'no word of {truth["leaf"]}: {line}'
        cause = re.search(r'of which [^ ]+ (?:clocks|[mun]?s)(?: a remap)? by ([\w.]+)', line)
        if truth['causes'] and (not cause or cause.group(1) not in truth['causes']):
            return f'not by {"/".join(truth["causes"])}: {line}'
        if truth['what'] and not re.search(truth['what'], line):
            return f'no "{truth["what"]}": {line}'
        return ''

    def plant_all(self):
        right = wrong = 0
        todo = list(self.drawn(self.a.plants, self.a.seed))
        if self.a.whole:
            todo += [plants.whole(kernel, which, self.firmware) for kernel in SETTINGS for which in ('o1', 'icache')]
        for plant in todo:
            begun = time.process_time()
            reason = self.judge(plant)
            right, wrong = right + (not reason), wrong + bool(reason)
            print(f'{"right" if not reason else "WRONG"}  {plant.name}{": " + reason if reason else ""}', flush=True)
        return right, wrong

    def harmless_all(self):
        alarms = 0
        made = {kernel: harmless.all_of(self.firmware, kernel, self.a.seed + k) for k, kernel in enumerate(LARGE)}
        for n in range(self.a.harmless):
            kernel = list(LARGE)[n % 2]
            name, make = next(made[kernel])
            run = self.run(name, kernel, make(name))
            status, text = self.check(run, self.baseline(f'base-{kernel}', kernel)) if run else (4, 'no run')
            alarms += status != 0
            print(f'{"quiet" if status == 0 else "ALARM"}  {name}{"" if status == 0 else ": " + text}', flush=True)
        return alarms


def main():
    a = arguments()
    if a.seed == 0:
        a.seed = time.time_ns() // 1_000_000_000
    bench = Bench(a)
    right, wrong = bench.plant_all()
    alarms = bench.harmless_all()
    score = 100 * right / max(1, right + wrong)
    print(f'seed {a.seed}: {right} of {right + wrong} plants are blamed right ({score:.0f} %; at least {a.least:.0f} %), '
          f'{alarms} of {a.harmless} harmless changes raise an alarm (at most {a.alarms})')
    return 0 if score >= a.least and alarms <= a.alarms else 1


if __name__ == '__main__':
    sys.exit(main())
