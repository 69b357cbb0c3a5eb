#!/usr/bin/env python3
"""Every writer of files, while the host fails: at each system call that changes a file, the process is killed, or the
call fails as on a full or a broken disk (strace). After that, what was there is there, or what was to be written; an
error is one line and status 2; and the same command, once the host works again, has what it would have had.

Usage: writers.py FOVEA WORK [--every N] [--planted N] [--only NAME]   (status 77: strace may not be used here)
FOVEA is tb/unit/limits_fake.cpp: all commands of fovea, over a toy board that needs no time.
"""
import argparse
import dataclasses
import hashlib
import os
import pathlib
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
import typing

CALLS = ('openat', 'write', 'pwrite64', 'copy_file_range', 'sendfile', 'ftruncate', 'fsync', 'fdatasync',
         'rename', 'renameat', 'renameat2', 'link', 'mkdir', 'mkdirat', 'unlink', 'unlinkat', 'rmdir', 'fchmod')
ERRORS = ('ENOSPC', 'EIO')
LINE = re.compile(r'(?:(?P<pid>\d+) +)?(?P<call>\w+)\((?P<rest>.*)')
OPENED_TO_WRITE = re.compile('O_CREAT|O_WRONLY|O_RDWR|O_TRUNC')
LIMIT = 60  # s, of a command
STRACE = ('strace', '-f', '-qq')  # with --seccomp-bpf, strace 6.1 injects no signals


def run(command, folder):
    with subprocess.Popen([str(w) for w in command], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, errors='replace', start_new_session=True) as child:
        try:
            out, err = child.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            raise
    return subprocess.CompletedProcess(command, child.returncode, out, err)


def contents(path):
    """What a file or a folder is, without what differs between equal runs."""
    if path.is_symlink():
        return 'link'
    if path.suffix == '.db':  # of trend; one without lines is as good as none
        try:
            with sqlite3.connect(path.as_uri() + '?mode=rw', uri=True) as database:
                return database.execute('SELECT commit_name, experiment, figures FROM runs ORDER BY 1, 2').fetchall()
        except sqlite3.OperationalError:
            return []
    if path.is_dir():
        return {p.name: contents(p) for p in sorted(path.iterdir())}
    if not path.exists():
        return None
    if path.name == 'host.json':
        return 'host' if 'wall_time' in path.read_text() else 'cut off'
    if path.name in ('point.json', 'output.txt'):  # of limits: it has the host's time
        return 'a point' if path.stat().st_size else 'empty'
    return hashlib.sha256(path.read_bytes()).hexdigest()


def contents_of(*names):
    return lambda folder, program: [contents(folder / name) for name in names]


def checks(folder, program):
    """What `check` says of the run that the old baseline is of, and of the new one's."""
    done = [run([program, 'check', f'../given/{name}', '--against', 'base.yaml'], folder) for name in ('a', 'b')]
    return [(d.returncode, d.stdout, d.stderr) for d in done]


def baseline_and_checks(folder, program):
    return [contents(folder / 'base.yaml'), *checks(folder, program)]


@dataclasses.dataclass
class Writer:
    """A command, and what must be old or new after it."""
    name: str
    command: typing.Callable  # of the program: a list of words
    look: typing.Callable     # of the folder and the program: a list
    before: tuple = ()        # commands, and functions of the folder, that make the old state
    each: bool = False        # each item by itself is old or new; otherwise all of them together
    children: bool = False    # it runs other programs: an error of one is its answer, until it is asked again
    whole: tuple = ()         # what is as after a command without faults, once the same command has run again


def writers():
    bless_a = ['bless', '../given/a', '--against', 'base.yaml', '--why', 'first']
    bless_b = ['bless', '../given/b', '--against', 'base.yaml', '--why', 'second']

    def bare(folder):  # as written by hand: without the hash of its reference
        base = folder / 'base.yaml'
        base.write_text(re.sub(r'reference_sha256: .*\n', '', base.read_text()))

    def plain(*words):
        return lambda program: [program, *words]

    both = ('base.yaml', 'base')
    yield Writer('bless', plain(*bless_b), baseline_and_checks, (bless_a,), whole=both)
    yield Writer('bless-bare', plain(*bless_b), checks, (bless_a, bare), whole=both)
    yield Writer('bless-first', plain(*bless_a), baseline_and_checks, whole=both)
    small = ['run', '../given/toy.yaml', '-o', 'out']
    yield Writer('run', plain(*small, '-s', 'toy.contention=2'), contents_of('out'), (small,))
    yield Writer('run-first', plain(*small), contents_of('out'))
    answers = contents_of('lim/answer.txt', 'lim/limits.csv', 'lim/points.csv')
    yield Writer('limits', plain('limits', '../given/toy.yaml', '--find', 'toy.value=0..3', '--probes', '0', '-j', '1',
                                 '-o', 'lim'), answers, each=True, children=True, whole=('lim',))
    again = ['limits', '../given/toy.yaml', '--over', 'toy.mode=guest_failure', '-j', '1', '-o', 'lim']
    more = [w.replace('guest_failure', 'guest_failure,good') for w in again]
    yield Writer('limits-again', plain(*more, '--retry-failed'), answers, (again,), each=True, children=True,
                 whole=('lim',))
    report = ['report', '../given/a', '-o', 'page.html']
    yield Writer('report', plain('report', '../given/b', '-o', 'page.html'), contents_of('page.html'), (report,))
    files = ['--against', '../given/base.yaml', '--junit', 'j.xml', '--markdown', 'm.md']
    yield Writer('check', plain('check', '../given/b', *files), contents_of('j.xml', 'm.md'),
                 (['check', '../given/a', *files],), each=True)
    trend = ['trend', '../given/a', '--database', 't.db', '--commit', 'one', '--replace']  # the program is not known
    yield Writer('trend', plain('trend', '../given/b', '--database', 't.db', '--commit', 'two', '--plot', 't.svg',
                                '--replace'),
                 contents_of('t.db', 't.svg'), (trend,), each=True)
    yield Writer('trend-first', plain(*trend), contents_of('t.db'))
    yield Writer('convert', plain('trace', 'convert', '../given/text.trc', '--to', 'binary',
                                  '-o', 'new.trace'), contents_of('new.trace'))


def planted():
    """Writers that are wrong, each in one way; all of them must be complained of."""
    def shell(text):
        return lambda program: ['/bin/sh', '-c', text]

    def old(folder):
        (folder / 'f').write_text('old\n')
        (folder / 'g').write_text('old\n')

    yield Writer('in place', shell('echo new > f'), contents_of('f'), (old,))
    yield Writer('one after the other', shell('echo new > f.tmp && mv f.tmp f && echo new > g.tmp && mv g.tmp g'),
                 contents_of('f', 'g'), (old,))
    yield Writer('blocked by what a crash left', shell('mkdir d.tmp || exit 2; echo x > d.tmp/x; mv d.tmp d'),
                 contents_of('d'))
    yield Writer('an error that is not said', shell('{ echo new > f.tmp; mv f.tmp f; } 2>/dev/null; exit 0'),
                 contents_of('f'), (old,))


class Bench:
    def __init__(self, program, work):
        self.program, self.work, self.injected, self.complaints, self.quiet = program, work, 0, [], True

    def make_given(self):
        """What the commands read."""
        given = self.work / 'given'
        given.mkdir(parents=True)
        (given / 'toy.yaml').write_text('toy: {value: 1}\n')
        (given / 'text.trc').write_text(TEXT_TRACE)
        for name, words in (('a', []), ('b', ['-s', 'toy.contention=3'])):
            self.expect([self.program, 'run', 'toy.yaml', *words, '-o', name], given)
        self.expect([self.program, 'bless', 'a', '--against', 'base.yaml', '--why', 'first'], given)

    def expect(self, command, folder, statuses=(0, 1)):
        done = run(command, folder)
        if done.returncode not in statuses:
            sys.exit(f'{command}: status {done.returncode}: {done.stderr}')

    def fresh(self, writer):
        folder = self.work / 'case'
        shutil.rmtree(folder, ignore_errors=True)
        old = self.work / f'old-{writer.name}'
        if not old.exists():
            old.mkdir()
            for step in writer.before:
                if callable(step):
                    step(old)
                else:
                    self.expect([self.program, *step], old)
        shutil.copytree(old, folder, symlinks=True)
        return folder

    def places(self, writer):
        """(call, its number in its process) of the calls of the command that change a file of the case."""
        folder, log = self.fresh(writer), self.work / 'log'
        log.unlink(missing_ok=True)
        self.expect([*STRACE, '-y', '-s', '0', '-o', log, '-e', 'trace=' + ','.join(CALLS),
                     *writer.command(self.program)], folder)
        counts, changes = {}, {}
        for line in log.read_text().splitlines():
            found = LINE.match(line)
            if not found:
                continue
            call = found['call']
            key = found['pid'], call
            counts[key] = counts.get(key, 0) + 1
            here = str(folder) in found['rest'] and (call != 'openat' or OPENED_TO_WRITE.search(found['rest']))
            changes.setdefault((call, counts[key]), []).append(bool(here))
        # A fault comes in all processes of the command: it must not be one of reading in any of them.
        return [place for place, here in changes.items() if all(here)]

    def complain(self, writer, fault, what):
        self.complaints.append(f'{writer.name}, {fault}: {what}')
        if not self.quiet:
            print('WRONG:', self.complaints[-1], flush=True)

    def inject(self, writer, old, new, place, fault):
        """@return the folder after the command with this fault; complains of what is wrong with it"""
        (call, number), case = place, f'{fault} at {place[0]} {place[1]}'
        folder = self.fresh(writer)
        self.injected += 1
        what = 'signal=SIGKILL' if fault == 'KILL' else f'error={fault}'
        done = run([*STRACE, '-o', '/dev/null', '-e', f'trace={call}', '-e', f'inject={call}:{what}:when={number}',
                    *writer.command(self.program)], folder)
        state = writer.look(folder, self.program)
        if fault == 'KILL' and done.returncode >= 0 and not writer.children:
            self.complain(writer, case, 'it was not killed: this test is wrong')
        elif done.returncode in (0, 1):
            if state != new:
                self.complain(writer, case, f'status {done.returncode}, and the new state is not there')
        elif fault == 'KILL' and done.returncode == -9:
            pass
        elif done.returncode != 2:
            self.complain(writer, case, f'status {done.returncode}: {done.stderr.strip()}')
        elif not done.stderr.strip() and not writer.children:
            self.complain(writer, case, 'status 2 without a word')
        together = all(s in (o, n) for s, o, n in zip(state, old, new)) if writer.each else state in (old, new)
        if not together and not (writer.children and fault != 'KILL'):
            self.complain(writer, case, 'neither the old state nor the new one')
        return folder

    def repeat(self, writer, folder, new, whole, names, case):
        """The host works again."""
        done = run(writer.command(self.program), folder)
        if done.returncode not in (0, 1):
            self.complain(writer, case, f'then status {done.returncode}: {done.stderr.strip()}')
        elif writer.look(folder, self.program) != new or contents_of(*writer.whole)(folder, '') != whole:
            self.complain(writer, case, 'then not the new state')
        elif left := sorted({p.name for p in folder.iterdir()} - names):
            self.complain(writer, case, f'then left behind: {left}')

    def check(self, writer, every, first):
        """@return how many faults were tried"""
        folder = self.fresh(writer)
        old = writer.look(folder, self.program)
        self.expect(writer.command(self.program), folder)
        new, names = writer.look(folder, self.program), {p.name for p in folder.iterdir()}
        whole = contents_of(*writer.whole)(folder, '')
        if old == new:
            sys.exit(f'{writer.name}: old and new state are the same')
        faults = [(p, f) for p in self.places(writer) for f in ('KILL', *ERRORS)]
        if not faults:
            sys.exit(f'{writer.name}: changes no file')
        chosen = faults[first % every::every]
        for place, fault in chosen:
            case = f'{fault} at {place[0]} {place[1]}'
            try:
                self.repeat(writer, self.inject(writer, old, new, place, fault), new, whole, names, case)
            except subprocess.TimeoutExpired:
                self.complain(writer, case, f'not ended after {LIMIT} s')
        return len(chosen)


# A read, in the text format of the memory.
TEXT_TRACE = '# dramtrace 1\n# master 3 window 2 cpu\n0 3 R 0x0 32\n'


def main():
    p = argparse.ArgumentParser()
    p.add_argument('fovea', type=pathlib.Path)
    p.add_argument('work', type=pathlib.Path)
    p.add_argument('--every', type=int, default=1, help='only each n-th fault')
    p.add_argument('--planted', type=int, default=1, help='the same of the writers with planted errors')
    p.add_argument('--only', help='only this writer')
    o = p.parse_args()
    work = o.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    if not shutil.which('strace') or run([*STRACE, '-o', '/dev/null', '-e', 'trace=openat', 'true'], work).returncode:
        print('strace is not there (scripts/setup), or may not trace here; not tested')
        return 77
    bench = Bench(o.fovea.resolve(), work)
    bench.make_given()
    status = 0
    for writer in planted():
        bench.complaints = []
        bench.check(writer, o.planted, 0)
        print(f'planted: {writer.name}: {len(bench.complaints)} complaints')
        if not bench.complaints:
            print('  and there must be some')
            status = 1
    bench.complaints, bench.quiet = [], False
    for n, writer in enumerate(writers()):
        if o.only and writer.name != o.only:
            continue
        began = time.monotonic()
        count = bench.check(writer, o.every, n)
        print(f'{writer.name}: {count} faults, {time.monotonic() - began:.1f} s', flush=True)
    print(f'{bench.injected} faults, {len(bench.complaints)} complaints')
    return 1 if bench.complaints else status


sys.exit(main())
