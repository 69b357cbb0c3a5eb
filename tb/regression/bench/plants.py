"""Changes of the firmware whose effect is known: what is planted where, and what is true of it."""
import dataclasses
import typing

LENS, VIEW, PIPELINE = 'sw/lens/fast_lut.c', 'sw/firmware/app/view.c', 'sw/firmware/app/pipeline.c'
STAGED, LUT_METHOD = 'sw/firmware/kernels/method_staged.c', 'sw/firmware/kernels/method_lut.c'


@dataclasses.dataclass(frozen=True)
class Site:
    """A function of the firmware: how often it begins in its phase of the bench's runs, about."""
    file: str
    function: str
    phase: str  # boot, lut, frames, remap
    calls: int
    kernel: str = ''  # empty: each
    after: str = ''   # the plant stands behind the line with this text


SITES = [
    Site('sw/firmware/app/main.c', 'main', 'boot', 1, after='print_config();'),
    Site('sw/firmware/app/main.c', 'print_config', 'boot', 1),
    Site('sw/firmware/app/main.c', 'init_frames', 'boot', 1, after='const uint32_t rows'),
    Site(PIPELINE, 'pipeline_prepare', 'boot', 1),
    Site(PIPELINE, 'pipeline_start', 'boot', 1),
    Site('sw/firmware/app/program_single.c', 'program_build', 'boot', 1),
    Site('sw/firmware/app/overlay.c', 'overlay_start', 'boot', 1),
    Site(VIEW, 'fill_lut', 'lut', 1, after='static fast_lut_t fast;'),
    Site(LENS, 'fast_lut_prepare', 'lut', 1),
    Site(LENS, 'fast_lut_build', 'lut', 1),
    Site(LENS, 'choose_scales', 'lut', 1),
    Site(LENS, 'set_row', 'lut', 17),
    Site(LENS, 'build_row', 'lut', 17),
    Site(LENS, 'append', 'lut', 40),
    Site(PIPELINE, 'captured_frame_done', 'frames', 2),
    Site(PIPELINE, 'capture_field_end', 'frames', 4),
    Site(PIPELINE, 'display_field_start', 'frames', 4),
    Site(PIPELINE, 'irq_dispatch', 'frames', 8),
    Site(PIPELINE, 'flip', 'frames', 2),
    Site(PIPELINE, 'pipeline_done', 'frames', 2),
    Site('sw/firmware/app/capture.c', 'capture_frame_done', 'frames', 2),
    Site('sw/firmware/app/output.c', 'output_take', 'frames', 2),
    Site('sw/firmware/app/output.c', 'output_next', 'frames', 4),
    Site(VIEW, 'view_correct', 'remap', 2, after='dcache_invalidate_range(in, bytes);\n#endif'),
    Site(VIEW, 'first_row_sum', 'remap', 4),
    Site('sw/firmware/app/overlay.c', 'overlay_frame', 'remap', 2),
    Site('sw/firmware/kernels/remap_plain.c', 'remap_plain', 'remap', 2, 'plain'),
    Site(LUT_METHOD, 'run', 'remap', 2, 'plain'),
    Site(LUT_METHOD, 'run_plain', 'remap', 2, 'plain'),
    Site(STAGED, 'run', 'remap', 2, 'staged'),
    Site(STAGED, 'run_tiles', 'remap', 2, 'staged'),
    Site(STAGED, 'open_bank', 'remap', 4, 'staged'),
    Site(STAGED, 'request', 'remap', 60, 'staged'),
]

# Clocks that a plant is to cost in all, which is well beyond the tolerance of the phase's figure, but a small part of
# the run. Before the first frame the firmware waits for the decoder, some 56 million clocks, in which less of a plant
# would not be felt; and the start is prolonged by whole frames of the camera only.
CLOCKS = {'boot': 80e6, 'lut': 300e3, 'frames': 1.2e6, 'remap': 60e3}
INCLUDES = ('#include "sw/firmware/drivers/cp15.h"\n#include "sw/firmware/drivers/timer.h"\n'
            '#include "sw/firmware/drivers/uart.h"\n#include "sw/firmware/mmio.h"\n#include "sw/firmware/regs.h"\n')


@dataclasses.dataclass(frozen=True)
class Kind:
    """What is planted. {n}: how often, from the clocks that one takes."""
    name: str
    clocks: float
    statement: str
    causes: tuple  # words of profile.csv, one of which most of the clocks have; empty: not stated
    before: str = ''
    leaf: str = ''
    functions: tuple = ()  # that are right to name beside the site
    what: str = ''         # the words of the sentence, a pattern


KINDS = [
    Kind('loop', 9, 'for (volatile uint32_t plant_n = 0; plant_n < {n}u; ++plant_n) {{}}',
         ('issue', 'interlock', 'dcache', 'write_buffer', 'uncached')),
    Kind('loads', 45, 'for (uint32_t plant_n = 0; plant_n < {n}u; ++plant_n) (void)plant_table[plant_n * 8u % 8192u];',
         ('dcache', 'uncached'), before='static volatile uint32_t plant_table[8192];'),
    Kind('stores', 25, 'for (uint32_t plant_n = 0; plant_n < {n}u; ++plant_n) '
         'plant_table[plant_n * 8u % 8192u] = plant_n;', ('write_buffer', 'uncached', 'issue'),
         before='static volatile uint32_t plant_table[8192];'),
    Kind('clean', 13, 'for (uint32_t plant_n = 0; plant_n < {n}u; ++plant_n) dcache_clean_all();', (),
         functions=('dcache_clean_all',)),
    Kind('poll', 12, '{{ const uint32_t plant_t = *(volatile uint32_t *)TIMER0_TIM12; '
         'while (*(volatile uint32_t *)TIMER0_TIM12 - plant_t < {n}u) {{}} }}', ('uncached', 'data_bus'), what='polls'),
    Kind('leaf', 60, 'for (uint32_t plant_n = 0; plant_n < {n}u; ++plant_n) (void)timer_ticks();',
         ('uncached', 'data_bus'), leaf='timer_ticks'),
    Kind('helper', 9, 'plant_helper({n}u);', (), before='static __attribute__((noinline)) void plant_helper(uint32_t n) '
         '{{ for (volatile uint32_t plant_n = 0; plant_n < n; ++plant_n) {{}} }}', functions=('plant_helper',)),
    Kind('inlined', 9, 'plant_inlined({n}u);', (), before='static inline __attribute__((always_inline)) void '
         'plant_inlined(uint32_t n) {{ for (volatile uint32_t plant_n = 0; plant_n < n; ++plant_n) {{}} }}',
         functions=('plant_inlined',)),
]


@dataclasses.dataclass
class Truth:
    """What is true of a variant, from what was planted alone."""
    phase: str
    functions: list         # each of which is right to name
    callers: list           # that lead to a leaf which is called more often; empty: not stated
    leaf: str
    causes: list            # one of which most of the clocks have; empty: not stated
    what: str = ''
    sign: str = '+'
    most: bool = False      # the functions with 80 % of the clocks that were added are found from the two profiles


@dataclasses.dataclass
class Plant:
    name: str
    kernel: str
    changed: dict
    truth: Truth
    extra: tuple = ()
    base_changed: dict = dataclasses.field(default_factory=dict)
    base_extra: tuple = ()
    options: dict = dataclasses.field(default_factory=dict)
    base_name: str = ''


def times(kind_clocks, site):
    return max(1, round(CLOCKS[site.phase] / kind_clocks / site.calls))


def simple(firmware, site, kind, kernel, insert_into, before_function):
    n = times(kind.clocks, site)
    text = insert_into(firmware.read(site.file), site.function, kind.statement.format(n=n), site.after)
    if kind.before:
        text = before_function(text, site.function, kind.before.format(n=n))
    text = INCLUDES + '#line 1\n' + text
    truth = Truth(site.phase, [site.function, *kind.functions], [site.function] if kind.leaf else [], kind.leaf,
                  list(kind.causes), kind.what)
    return Plant(f'{site.phase}-{site.function}-{kind.name}-{kernel}', kernel, {site.file: text}, truth)


CXX = '''#include <stdint.h>
namespace {{
struct A {{ __attribute__((noinline)) void step(uint32_t n) {{ for (volatile uint32_t k = 0; k < n; k = k + 1) {{}} }} }};
struct B {{ __attribute__((noinline)) void step(uint32_t n) {{ for (volatile uint32_t k = 0; k < n; k = k + 2) {{}} }} }};
__attribute__((noinline)) void work(int n) {{ for (volatile int k = 0; k < n; k = k + 1) {{}} }}
__attribute__((noinline)) void work(unsigned n) {{ for (volatile unsigned k = 0; k < n; k = k + 3) {{}} }}
}}
extern "C" void plant_hook(void) {{
  A a;
  B b;
  a.step(10u * {a_rounds});
  b.step(10u * {b_rounds});
  work(10 * {int_rounds});
  work(10u * {unsigned_rounds});
}}
'''
# What each of them does in the extra rounds is in its own code.
METHODS = {'a': ('(anonymous namespace)::A::step(unsigned long)', 'struct A'),
           'b': ('(anonymous namespace)::B::step(unsigned long)', 'struct B'),
           'int': ('(anonymous namespace)::work(int)', 'work(int'),
           'unsigned': ('(anonymous namespace)::work(unsigned int)', 'work(unsigned')}


def methods(firmware, site, kernel, which, insert_into):
    """A method, or one of two overloads, gets a loop more; the program before has all of them."""
    text = '#line 1\n' + insert_into(firmware.read(site.file), site.function,
                                     'extern void plant_hook(void); plant_hook();', site.after)
    base = CXX.format(a_rounds=1, b_rounds=1, int_rounds=1, unsigned_rounds=1)
    name, mark = METHODS[which]
    lines = base.split('\n')
    at = next(i for i, line in enumerate(lines) if mark in line and 'for' in line)
    n = times(9, site)
    lines[at] = lines[at].replace('{ for', f'{{ for (volatile uint32_t m = 0; m < {n}u; m = m + 1) {{}} for')
    truth = Truth(site.phase, [name], [], '', [])
    return Plant(f'{site.phase}-{site.function}-method_{which}-{kernel}', kernel, {site.file: text}, truth,
                 extra=(('plant.cpp', '\n'.join(lines)),), base_changed={site.file: text},
                 base_extra=(('plant.cpp', base),), base_name=f'base-methods-{site.function}-{kernel}')


def same_name(firmware, one, other, kernel, insert_into, before_function):
    """Static functions of one name in two files; that of `one` gets slower."""
    def with_step(site, n):
        text = insert_into(firmware.read(site.file), site.function, 'plant_step();', site.after)
        return '#include <stdint.h>\n#line 1\n' + before_function(
            text, site.function, 'static __attribute__((noinline)) void plant_step(void) '
            f'{{ for (volatile uint32_t n = 0; n < {n}u; ++n) {{}} }}')
    before = {one.file: with_step(one, 5), other.file: with_step(other, 6)}
    after = {one.file: with_step(one, times(9, one) + 5), other.file: with_step(other, 6)}
    truth = Truth(one.phase, [f'plant_step|{one.file.split("/")[-1]}'], [], '', [])
    return Plant(f'{one.phase}-{one.function}-same_name-{kernel}', kernel, after, truth, base_changed=before,
                 base_name=f'base-same-{one.function}-{other.function}-{kernel}')


def renamed(firmware, site, kernel, insert_into):
    """The function has another name, and is slower."""
    import re
    kind = KINDS[0]
    text = insert_into(firmware.read(site.file), site.function, kind.statement.format(n=times(kind.clocks, site)),
                       site.after)
    text = '#line 1\n' + re.sub(rf'\b{site.function}\b(?=\()', site.function + '_now', text)
    truth = Truth(site.phase, [site.function + '_now'], [], '', [])
    return Plant(f'{site.phase}-{site.function}-renamed-{kernel}', kernel, {site.file: text}, truth)


def twice(firmware, kernel, which):
    """Work that is done a second time."""
    table = {
        'lut': (VIEW, 'fill_lut(&lens, entries);\n  const', 'lut', ['view_build_lut'], 'fill_lut'),
        'remap': (VIEW, 'view->method->run(&view->table, in, out);', 'remap', ['view_correct'], ''),
        'prepare': (VIEW, 'fast_lut_prepare(&fast, lens);', 'lut', ['fill_lut'], 'fast_lut_prepare'),
    }
    file, line, phase, functions, leaf = table[which]
    call = line.split('\n')[0]
    again = call + ' ' + call
    if which == 'prepare':
        again = '(fast_lut_prepare(&fast, lens), fast_lut_prepare(&fast, lens));'
    text = firmware.read(file)
    if call not in text:
        raise ValueError(f'{file} has no {call}')
    text = '#line 1\n' + text.replace(line, line.replace(call, again), 1)
    return Plant(f'{phase}-twice_{which}-{kernel}', kernel, {file: text},
                 Truth(phase, functions, functions, '', []))


def whole(kernel, which, firmware):
    """Changes that touch many functions: the truth is the cause and the functions with most of the added clocks."""
    if which == 'o1':
        return Plant(f'whole-o1-{kernel}', kernel, {}, Truth('lut', [], [], '', [], most=True),
                     options={'flags': ['-O1'], 'everything': True})
    file = 'sw/firmware/drivers/cp15.c'
    text = firmware.read(file).replace('CONTROL_M | CONTROL_C | CONTROL_I', 'CONTROL_M | CONTROL_C')
    return Plant(f'whole-icache-{kernel}', kernel, {file: text},
                 Truth('remap', [], [], '', [], what='the I-cache is off', most=True))
