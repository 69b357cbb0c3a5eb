"""Variants of the firmware: one or more source files changed, compiled out of the tree and linked again."""
import pathlib
import re
import shlex
import subprocess


class Firmware:
    """The commands that built the firmware, and variants of it. Sources are named relative to the project."""

    def __init__(self, build, source, out):
        self.build, self.source, self.out = (pathlib.Path(p).resolve() for p in (build, source, out))
        text = subprocess.run(['ninja', '-C', str(self.build), '-t', 'commands', 'sw/firmware/fovea_firmware.elf'],
                              check=True, capture_output=True, text=True).stdout
        self.elf = self.build / 'sw/firmware/fovea_firmware.elf'
        self.compile, self.link = {}, None
        for line in text.split('\n'):
            for part in line.split(' && '):
                words = shlex.split(part) if 'arm-none-eabi' in part else []
                if '-c' in words:
                    name = str(pathlib.Path(words[words.index('-c') + 1]).relative_to(self.source))
                    self.compile[name] = words
                elif '-T' in words and words[words.index('-o') + 1].endswith('fovea_firmware.elf'):
                    self.link = words

    def read(self, name):
        return (self.source / name).read_text()

    def variant(self, name, changed, extra=(), flags=(), everything=False, order=None, root=None):
        """An ELF file. `changed`: text by source name; `extra`: (file name, text) to be added; `flags`: appended for
        all files that are compiled; `everything`: compile all of them; `order`: of the objects; `root`: folder that
        holds the sources instead."""
        folder = self.out / name
        folder.mkdir(parents=True, exist_ok=True)
        link = [w for w in self.link if not w.startswith('-Wl,-Map')]
        for source, words in self.compile.items():
            if source not in changed and not everything:
                continue
            words = self.without_dependencies(words)
            place = self.source / source
            if source in changed:
                place = folder / pathlib.Path(source).name
                place.write_text(changed[source])
                words.insert(1, f'-I{self.source / pathlib.Path(source).parent}')
            elif root:
                place = root / source
            if root:
                words = [w.replace(f'-I{self.source}', f'-I{root}') for w in words]
            target = self.object_of(source)
            made = folder / pathlib.Path(target).name
            words[words.index('-c') + 1] = str(place)
            words[words.index('-o') + 1] = str(made)
            subprocess.run(words + list(flags), check=True, capture_output=True, text=True)
            link = [str(made) if w == target else w for w in link]
        for file, text in extra:
            place, made = folder / file, folder / (file + '.obj')
            place.write_text(text)
            words = self.without_dependencies(next(iter(self.compile.values())))
            if file.endswith('.cpp'):
                words[0] = words[0].replace('gcc', 'g++')
                words = [w for w in words if not w.startswith(('-std=', '-Wstrict'))] + ['-fno-exceptions', '-fno-rtti']
            words[words.index('-c') + 1] = str(place)
            words[words.index('-o') + 1] = str(made)
            subprocess.run(words, check=True, capture_output=True, text=True)
            link.insert(link.index('-lm'), str(made))
        if order:
            objects = [w for w in link if w.endswith('.obj')]
            shuffled = iter(order(objects))
            link = [next(shuffled) if w.endswith('.obj') else w for w in link]
        elf = folder / 'firmware.elf'
        link[link.index('-o') + 1] = str(elf)
        subprocess.run(link, check=True, capture_output=True, text=True)
        return elf

    def object_of(self, source):
        words = self.compile[source]
        return words[words.index('-o') + 1]

    @staticmethod
    def without_dependencies(words):
        out, skip = [], 0
        for word in words:
            if skip:
                skip -= 1
            elif word == '-MF':
                skip = 1
            elif word != '-MD':
                out.append(word)
        return out


def insert_into(text, function, statement, after=None):
    """`statement` at the beginning of a function, or behind the first line of it that has the text `after`."""
    head = re.search(rf'^[a-z][\w \*()]*\b{function}\([^;{{]*\) \{{', text, re.M)
    if not head:
        raise ValueError(f'no function {function}')
    at = head.end()
    if after:
        at = text.index('\n', text.index(after, at))
    return text[:at] + ' ' + statement + text[at:]


def before_function(text, function, addition):
    head = re.search(rf'^[a-z][\w \*()]*\b{function}\([^;{{]*\) \{{', text, re.M)
    return text[:head.start()] + addition + '\n' + text[head.start():]
