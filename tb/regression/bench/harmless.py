"""Changes of the firmware that cost nothing worth a word: dead code, the order of linking, the length of a text, code
that lies elsewhere, another place of the sources, other names, code that moved between functions."""
import random
import re
import shutil

STATICS = [('sw/lens/fast_lut.c', 'append'), ('sw/lens/fast_lut.c', 'choose_scales'), ('sw/lens/fast_lut.c', 'set_row'),
           ('sw/firmware/app/view.c', 'first_row_sum'), ('sw/firmware/app/pipeline.c', 'flip'),
           ('sw/firmware/app/pipeline.c', 'captured_frame_done'), ('sw/firmware/kernels/method_staged.c', 'run_tiles'),
           ('sw/firmware/kernels/method_staged.c', 'request'), ('sw/lens/lens.c', 'table_radius')]
# Objects of the program, with the files that name them.
OBJECTS = [('frame_out', 'sw/firmware/app/'), ('view_other_ticks', 'sw/firmware/app/')]
SOURCES = ['sw/firmware/app/view.c', 'sw/firmware/app/pipeline.c', 'sw/firmware/kernels/remap_plain.c',
           'sw/lens/fast_lut.c', 'sw/firmware/app/capture.c', 'sw/firmware/drivers/timer.c', 'sw/firmware/app/output.c']
TEXTS = ['"Fovea firmware\\n"', '"picture "', '"LUT: "', '"kernel: "', '" entries in "']


def all_of(firmware, kernel, seed):
    """(name, a function that makes the ELF file), endless, drawn from a seed."""
    draw = random.Random(seed)
    place = 0

    def marked(text):
        return '#line 1\n' + text

    def dead(name):
        file = draw.choice(SOURCES)
        size = draw.choice([1, 3, 9])
        body = ''.join(f'  sum = sum * {k + 3}u + x;\n' for k in range(8 * size))
        code = (f'\n__attribute__((used, section(".text.main"))) unsigned dead_code(unsigned x) {{\n  unsigned sum = 0;\n'
                f'{body}  return sum;\n}}\n')
        return firmware.variant(name, {file: firmware.read(file) + code})

    def order(name):
        return firmware.variant(name, {}, order=lambda objects: draw.sample(objects, len(objects)))

    def length(name):
        text = draw.choice(TEXTS)
        for file in firmware.compile:
            source = firmware.read(file)
            if text in source:
                return firmware.variant(name, {file: marked(source.replace(text, '"xy' + text[1:], 1))})
        raise ValueError(text)

    def shifted(bytes_):
        def make(name):
            file = draw.choice(SOURCES)
            line = f'__asm__(".section .text.main, \\"ax\\"\\n .space {bytes_}\\n .text");\n'
            return firmware.variant(name, {file: line + marked(firmware.read(file))})
        return make

    def elsewhere(name):
        nonlocal place
        place += 1
        root = firmware.out / f'elsewhere{place}'
        for folder in ('sw', 'model/contract'):
            shutil.copytree(firmware.source / folder, root / folder, dirs_exist_ok=True,
                            ignore=shutil.ignore_patterns('fovea', '*.cpp'))
        return firmware.variant(name, {}, everything=True, root=root)

    def function_name(name):
        file, function = draw.choice([s for s in STATICS])
        text = re.sub(rf'\b{function}\b', function + '_by_another_name', firmware.read(file))
        return firmware.variant(name, {file: marked(text)})

    def object_name(name):
        word, folder = draw.choice(OBJECTS)
        changed = {f: marked(re.sub(rf'\b{word}\b', word + '_now', firmware.read(f))) for f in firmware.compile
                   if f.startswith(folder) and re.search(rf'\b{word}\b', firmware.read(f))}
        flags = [f'-D{word}={word}_now']
        return firmware.variant(name, changed, flags=flags)

    def outlined(name):
        file = 'sw/firmware/app/view.c'
        text = firmware.read(file).replace(
            'static uint32_t first_row_sum(const remap_table_t *table, const uint8_t *in) {',
            'static __attribute__((noinline)) uint32_t row_sum(const remap_table_t *table, const uint8_t *in) {')
        text = text.replace('void view_correct(', 'static __attribute__((noinline)) uint32_t first_row_sum(const '
                            'remap_table_t *table, const uint8_t *in) {\n  return row_sum(table, in);\n}\n\n'
                            'void view_correct(', 1)
        return firmware.variant(name, {file: marked(text)})

    def inlined(name):
        file, function = draw.choice([('sw/lens/fast_lut.c', 'append'), ('sw/lens/fast_lut.c', 'set_row'),
                                      ('sw/firmware/app/view.c', 'first_row_sum')])
        mark = draw.choice(['noinline', 'always_inline'])
        text = re.sub(rf'^static (\w+) {function}\(', rf'static {"inline " if mark[0] == "a" else ""}'
                      rf'__attribute__(({mark})) \1 {function}(', firmware.read(file), count=1, flags=re.M)
        return firmware.variant(name, {file: marked(text)})

    kinds = [('dead', dead), ('order', order), ('length', length), ('shift32', shifted(32)), ('shift4096', shifted(4096)),
             ('function', function_name), ('object', object_name), ('outlined', outlined), ('inlined', inlined),
             ('elsewhere', elsewhere)]
    number = 0
    while True:
        kind, make = kinds[number % len(kinds)]
        number += 1
        if kind == 'elsewhere' and place >= 1:
            kind, make = draw.choice(kinds[:-1])
        yield f'harmless-{number:02}-{kind}-{kernel}', make
