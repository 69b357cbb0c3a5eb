"""The mutated copy of a project: copying, drawing mutants, writing them, building."""
import hashlib
import json
import math
import multiprocessing
import os
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SPARE = 1.3  # drawn beyond the number asked for: some changes do not compile


def say(text):
    print(text, flush=True)


def fail(text, status=2):
    print(f'scripts/mutate: {text}', file=sys.stderr)
    sys.exit(status)


def project_files(source):
    listed = subprocess.run(['git', '-C', source, 'ls-files', '-z', '-co', '--exclude-standard'],
                            capture_output=True, check=False)
    if listed.returncode == 0 and listed.stdout:
        return [f for f in listed.stdout.decode().split('\0') if f]
    return [str(p.relative_to(source)) for p in pathlib.Path(source).rglob('*')
            if p.is_file() and 'build' not in p.relative_to(source).parts[:1]]


def write_if_changed(path, data):
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_bytes() != data:
        path.write_bytes(data)
        return True
    return False


class Areas:
    def __init__(self, config):
        self.areas = [(a['name'], re.compile(a['files']), re.compile(a['tests']))
                      for a in config['area']]
        self.names = [a[0] for a in self.areas]
        self.outside = [(re.compile(o['files']), o['reason']) for o in config.get('outside', [])]
        self.sources = re.compile(config.get('sources', '$^'))

    def of(self, file):
        return next((name for name, files, _ in self.areas if files.match(file)), None)

    def gaps(self, files):
        """What is wrong with the areas of a project with these files: sources that no area has and that are not said to
        be outside, and rules that fit no file."""
        sources = [f for f in files if self.sources.match(f)]
        rules = [(f'area "{name}"', rule) for name, rule, _ in self.areas] + \
            [(f'outside "{rule.pattern}"', rule) for rule, _ in self.outside]
        return [f'{f}: no area' for f in sources if not any(rule.match(f) for _, rule in rules)] + \
            [f'{name}: no file' for name, rule in rules if not any(rule.match(f) for f in files)]

    def own_tests(self, area):
        return next(tests for name, _, tests in self.areas if name == area)


def draw(places, areas, number, least, seed):
    """Mutants of each area in the order in which they are used. Every operator is equally likely, then
    every place of it; none overlaps another. Each area has a generator of its own, so that a change in one leaves the
    draw of the others as it is."""
    def below(n):  # the standard's generator, our own reduction: the same draw with every Python
        return generator.getrandbits(32) * n >> 32

    by_area = {a: [] for a in areas}
    for p in places:
        by_area[p['area']].append(p)
    total = sum(len(v) for v in by_area.values())
    quota = {a: min(len(v), least) for a, v in by_area.items()}
    rest = max(0, number - sum(quota.values()))
    for a, v in by_area.items():
        quota[a] = min(len(v), quota[a] + rest * len(v) // max(1, total))
    mutants, taken = [], {}
    for a in areas:
        generator, kinds = random.Random(f'{seed} {a}'), {}
        for p in sorted(by_area[a], key=lambda p: (p['file'], p['start'], p['end'], p['change'])):
            kinds.setdefault(p['kind'], []).append(p)
        chosen, wanted = 0, math.ceil(quota[a] * SPARE)
        while kinds and chosen < wanted:
            names = sorted(kinds)
            kind = names[below(len(names))]
            p = kinds[kind].pop(below(len(kinds[kind])))
            if not kinds[kind]:
                del kinds[kind]
            spans = taken.setdefault(p['file'], [])
            if any(p['start'] < e and s < p['end'] for s, e in spans):
                continue
            spans.append((p['start'], p['end']))
            mutants.append(dict(p, id=len(mutants)))
            chosen += 1
    return mutants, quota


READER = {}  # of a process that reads sources: its project, areas and the headers that it has read


def start_reading(root, config):
    import places  # needs a package that the rest can do without
    READER.update(root=root, areas=Areas(config), done=set(), places=places)


def read_unit(entry):
    """Places of one source and of the headers that this process has not read before."""
    arguments = shlex.split(entry['command'])[1:]
    for option in ('-o', '-c'):
        if option in arguments:
            at = arguments.index(option)
            del arguments[at:at + 2]
    arguments.append(f'-working-directory={entry["directory"]}')
    return READER['places'].unit_places(entry['file'], arguments, READER['root'],
                                        lambda n: READER['areas'].of(n) is not None, READER['done'])


class Tree:
    def __init__(self, source, out, config):
        self.source, self.out, self.config = pathlib.Path(source), pathlib.Path(out), config
        self.tree, self.build = self.out / 'tree', self.out / 'build'
        self.areas = Areas(config)

    # --- copying ----------------------------------------------------------
    def copy(self, keep):
        """Brings the copy up to date; files in `keep` (mutated) stay. Returns files of areas that differ
        from the originals."""
        originals = self.out / 'originals'
        changed, present = [], set()
        if keep is None:
            shutil.rmtree(originals, ignore_errors=True)
        for name in project_files(self.source):
            path = self.source / name
            if not path.is_file():
                continue
            present.add(name)
            data = path.read_bytes()
            if self.areas.of(name):
                original = originals / name
                if keep is not None:
                    if not original.exists() or original.read_bytes() != data:
                        changed.append(name)
                    continue
                write_if_changed(original, data)
            if write_if_changed(self.tree / name, data):
                shutil.copymode(path, self.tree / name)
        if keep is None:
            for p in [p for p in self.tree.rglob('*') if p.is_file()]:
                if str(p.relative_to(self.tree)) not in present:
                    p.unlink()
        return changed

    def configure(self):
        self.out.mkdir(parents=True, exist_ok=True)
        for name in ('switch.h', 'switch.c'):
            write_if_changed(self.out / name, (HERE / name).read_bytes())
        switch = self.out / 'switch.o'
        subprocess.run(['gcc', '-O2', '-c', self.out / 'switch.c', '-o', switch], check=True)
        # A build type of its own: optimised, without optimisation across files, whose linking would take long.
        flags = '-O1 -w -Wno-narrowing -Werror=vla -fno-sanitize=all'
        self.cmake(self.build, '-DCMAKE_UNITY_BUILD=ON', '-DCMAKE_C_FLAGS_MUTANTS=-O1 -w',
                   f'-DCMAKE_CXX_FLAGS_MUTANTS={flags}', f'-DCMAKE_EXE_LINKER_FLAGS={switch}')

    def cmake(self, folder, *options):
        done = subprocess.run(['cmake', '-S', self.tree, '-B', folder, '-G', 'Ninja', '-DCMAKE_BUILD_TYPE=Mutants',
                               *options], capture_output=True, text=True, check=False)
        if done.returncode:
            fail('the copy cannot be configured:\n' + done.stdout + done.stderr, 4)

    # --- places -----------------------------------------------------------
    def find_places(self, jobs):
        """Every place of the areas' files; kept in a file, as finding them takes minutes."""
        key = hashlib.sha256((HERE / 'places.py').read_bytes() + json.dumps(
            self.config['area']).encode())
        for path in sorted((self.out / 'originals').rglob('*')):
            if path.is_file():
                key.update(str(path).encode() + path.read_bytes())
        kept = self.out / 'places.json'
        if kept.exists():
            old = json.loads(kept.read_text())
            if old['key'] == key.hexdigest():
                return old['places']
        found = self.parse(jobs)
        kept.write_text(json.dumps({'key': key.hexdigest(), 'places': found}))
        return found

    def sources_of(self, entry):
        """The project's sources that a command compiles: one, or those that CMake has joined."""
        path = pathlib.Path(entry['file'])
        if path.parent.name not in ('joined', 'Unity'):
            return [os.path.relpath(path, self.tree)]
        joined = re.findall(r'^#include "(.+)"$', path.read_text(), re.M)
        return [os.path.relpath(self.tree / name, self.tree) for name in joined]

    def parse(self, jobs):
        """Reads the sources as they are built, several joined in one: their headers are most of the work."""
        import places  # noqa: F401: a missing package shows here, not in every process
        self.cmake(self.out / 'commands', '-DCMAKE_UNITY_BUILD=ON', '-DCMAKE_EXPORT_COMPILE_COMMANDS=ON')
        commands = json.loads((self.out / 'commands' / 'compile_commands.json').read_text())
        entries, seen = {}, set()
        for entry in commands:
            sources = {name for name in self.sources_of(entry) if self.areas.of(name)}
            if sources - seen:
                entries.setdefault(entry['file'], entry)
                seen |= sources
        found = []
        with multiprocessing.Pool(jobs, start_reading, (str(self.tree), self.config)) as pool:
            for number, (new, complaints) in enumerate(pool.imap_unordered(read_unit, entries.values(), 4)):
                for text in complaints[:3]:
                    say(f'parsing: {text}')
                found += new
                if number % 10 == 9 or number + 1 == len(entries):
                    say(f'places: {number + 1} of {len(entries)} files, {len(found)} found')
        unique = {}
        for p in found:
            d = dict(vars(p), area=self.areas.of(p.file))
            unique[(p.file, p.start, p.end, p.kind, p.change)] = d
        result = list(unique.values())
        lines = {}
        for p in result:
            if p['file'] not in lines:
                lines[p['file']] = (self.tree / p['file']).read_text().split('\n')
            p['text'] = lines[p['file']][p['line'] - 1].strip()
        return result

    # --- writing and building -------------------------------------------
    def write(self, mutants):
        by_file = {}
        for m in mutants:
            by_file.setdefault(m['file'], []).append(m)
        originals = self.out / 'originals'
        for path in originals.rglob('*'):
            if not path.is_file():
                continue
            name = str(path.relative_to(originals))
            data = path.read_bytes()
            here = sorted(by_file.get(name, []), key=lambda m: -m['start'])
            for m in here:
                form = m['form'].replace('{m}', f'fovea_mutant({m["id"]})')
                data = data[:m['start']] + form.encode() + data[m['end']:]
            if here:
                head = f'#include "{self.out}/switch.h"\n#line 1 "{self.tree / name}"\n'
                data = head.encode() + data
            write_if_changed(self.tree / name, data)

    def targets(self):
        listed = subprocess.run(['ninja', '-C', self.build, '-t', 'targets', 'all'],
                                capture_output=True, text=True, check=True).stdout
        names = {line.split(':')[0] for line in listed.splitlines()}
        names = {n for n in names if '/' not in n}
        tests = self.config['tests']
        return sorted(n for n in names if re.match(tests['build'], n)
                      and not re.match(tests['build_not'], n))

    def compile(self, jobs, mutants):
        """Builds; takes out mutants that do not compile until the rest does. Returns the rest."""
        for attempt in range(8):
            say(f'build {attempt + 1}: {len(mutants)} mutants, see {self.out}/build.log')
            with open(self.out / 'build.log', 'w') as log:
                code = subprocess.run(['ninja', '-C', self.build, f'-j{jobs}', '-k0']
                                      + self.targets(), stdout=log, stderr=subprocess.STDOUT,
                                      check=False).returncode
            if code == 0:
                return mutants
            bad = self.blamed((self.out / 'build.log').read_text(errors='replace'), mutants)
            if not bad:
                fail(f'the copy does not compile: see {self.out}/build.log', 4)
            say(f'build {attempt + 1}: {len(bad)} mutants do not compile')
            mutants = [m for m in mutants if m['id'] not in bad]
            self.write(mutants)
        fail('mutants that do not compile remain after eight builds', 4)

    def blamed(self, log, mutants):
        spans = {}
        for m in mutants:
            lines = m['form'].count('\n')
            spans.setdefault(str(self.tree / m['file']), []).append(
                (m['line'], m['line'] + lines, m['id']))

        def at(pattern):
            bad = set()
            for file, line in re.findall(r'^(?:In file included from )?(\S+?):(\d+)[:,]' + pattern,
                                         log, re.M):
                bad |= {i for a, b, i in spans.get(file, []) if a <= int(line) <= b}
            return bad
        return at(r'.*error:') or at('')
