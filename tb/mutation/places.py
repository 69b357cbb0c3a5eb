"""Finds the places in C and C++ sources where one of the mutation operators applies (libclang)."""
import dataclasses
import os
import re

import clang.cindex
from clang.cindex import CursorKind as K

# The operators, as the report names them.
KINDS = ('boundary', 'negate', 'drop', 'constant', 'arithmetic')

BOUNDARY = {'<': '<=', '<=': '<', '>': '>=', '>=': '>'}
NEGATE = {'==': '!=', '!=': '==', '&&': '||', '||': '&&'}
ARITHMETIC = {'+': '-', '-': '+', '*': '/', '/': '*', '%': '*', '<<': '>>', '>>': '<<',
              '&': '|', '|': '&', '^': '&', '+=': '-=', '-=': '+=', '*=': '/=', '/=': '*=',
              '|=': '&=', '&=': '|=', '<<=': '>>=', '>>=': '<<=', '^=': '&=', '%=': '*='}
SWAPPED = {'-', '/', '%', '<<', '>>'}  # operands that may not change places without an effect

INTEGER = re.compile(r"(0[xX][0-9a-fA-F']+|0[bB][01']+|[0-9][0-9']*)([uUlLzZ]*)\Z")
FLOAT = re.compile(r"([0-9][0-9']*\.[0-9']*(?:[eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+)([fFlL]?)\Z")

FUNCTIONS = {K.FUNCTION_DECL, K.CXX_METHOD, K.CONSTRUCTOR, K.DESTRUCTOR, K.CONVERSION_FUNCTION,
             K.FUNCTION_TEMPLATE}
SCOPES = {K.NAMESPACE, K.STRUCT_DECL, K.CLASS_DECL, K.CLASS_TEMPLATE, K.UNION_DECL,
          K.CLASS_TEMPLATE_PARTIAL_SPECIALIZATION, K.LINKAGE_SPEC, K.UNEXPOSED_DECL}
# Nothing below these is a run-time expression.
CONSTANT = {K.STATIC_ASSERT, K.ENUM_DECL, K.TYPEDEF_DECL, K.TYPE_ALIAS_DECL, K.PARM_DECL,
            K.TYPE_REF, K.TEMPLATE_REF, K.NAMESPACE_REF, K.DECL_REF_EXPR, K.CXX_TYPEID_EXPR,
            K.CXX_UNARY_EXPR, K.TEMPLATE_TYPE_PARAMETER, K.TEMPLATE_NON_TYPE_PARAMETER,
            K.USING_DECLARATION, K.USING_DIRECTIVE}
LITERALS = {K.INTEGER_LITERAL, K.FLOATING_LITERAL, K.CXX_BOOL_LITERAL_EXPR}


@dataclasses.dataclass(frozen=True)
class Place:
    """A change that could be made: the text of [start, end) becomes `form`, in which {m} stands for
    the switch (true if the mutant is on)."""
    file: str       # relative to the project
    start: int      # byte offsets
    end: int
    line: int
    function: str
    kind: str
    change: str     # for people: old => new
    form: str


def one_line(text):
    return ' '.join(text.split())


class Finder:
    """Collects the places of one file of a translation unit."""

    def __init__(self, name, text):
        self.name = name
        self.text = text
        self.places = []
        self.function = ''
        self.body_end = 0
        self.returns_value = False

    # --- text -------------------------------------------------------------
    def span(self, node):
        return node.extent.start.offset, node.extent.end.offset

    def source(self, node):
        start, end = self.span(node)
        return self.text[start:end].decode('utf-8', 'replace')

    def line_of(self, offset):
        return self.text.count(b'\n', 0, offset) + 1

    def add(self, start, end, kind, new, form):
        old = self.text[start:end].decode('utf-8', 'replace')
        if '//' in old or '#' in old or '\\\n' in old or '/*' in old or 'fovea_mutant' in old:
            return
        form = form.replace('{old}', old)
        self.places.append(Place(self.name, start, end, self.line_of(start), self.function, kind,
                                 f'{one_line(old)} => {one_line(new)}', form))

    # --- declarations -----------------------------------------------------
    def declarations(self, node):
        for child in node.get_children():
            if child.kind in SCOPES:
                self.declarations(child)
            elif child.kind in FUNCTIONS:
                self.define(child)

    def define(self, node):
        children = list(node.get_children())
        if not children or children[-1].kind != K.COMPOUND_STMT:
            if not any(c.kind == K.CXX_TRY_STMT for c in children[-1:]):
                return
        body = children[-1]
        head = self.text[node.extent.start.offset:body.extent.start.offset]
        if re.search(rb'\b(constexpr|consteval)\b', head):
            return
        outer = self.function, self.body_end, self.returns_value
        parent = node.semantic_parent
        scope = parent.spelling + '::' if parent is not None and parent.kind in SCOPES - {
            K.NAMESPACE, K.LINKAGE_SPEC, K.UNEXPOSED_DECL} else ''
        self.function = scope + node.spelling
        self.body_end = body.extent.end.offset
        self.returns_value = node.kind not in (K.CONSTRUCTOR, K.DESTRUCTOR) and \
            node.result_type.spelling != 'void'
        # Of constructors also the initialisers of members; types and default arguments stay.
        for child in children:
            if child is body or (child.kind not in CONSTANT and child.kind != K.MEMBER_REF and
                                 child.extent.start.offset > node.location.offset):
                self.visit(child)
        self.function, self.body_end, self.returns_value = outer

    # --- statements -------------------------------------------------------
    def statements(self, nodes):
        for node in nodes:
            if node.kind.is_expression():
                self.droppable(node)
            self.visit(node)

    def droppable(self, node):
        start, end = self.span(node)
        after = re.compile(rb'\s*;').match(self.text, end)
        if not after or end <= start:
            return
        # The end of a function with a result must not be reached: what follows would be undefined.
        rest = self.text[after.end():self.body_end]
        if self.returns_value and not re.sub(rb'//[^\n]*|break\s*;|default\s*:|[\s;}]', b'', rest):
            return
        text = self.text[start:end].decode('utf-8', 'replace')
        if self.returns_value and re.match(r'throw\b', text) and b'return' not in rest:
            return
        self.add(start, after.end(), 'drop', '', '{ if (!{m}) { {old} } }')

    def parenthesis(self, offset):
        """The span inside the first ( ) from offset on."""
        start = self.text.find(b'(', offset)
        depth, at, quote = 0, start, 0
        while at < len(self.text):
            c = self.text[at]
            if quote:
                if c == 0x5c:
                    at += 1
                elif c == quote:
                    quote = 0
            elif c in b'"\'':
                quote = c
            elif c in b'([{':
                depth += 1
            elif c in b')]}':
                depth -= 1
                if depth == 0:
                    return start + 1, at
            at += 1
        return start, start

    def negatable(self, node):
        if node.kind.is_expression():
            start, end = self.span(node)
            if end > start:
                text = self.text[start:end].decode('utf-8', 'replace')
                self.add(start, end, 'negate', f'!({text})', '(!!({old}) != {m})')

    def of_macro(self, node, word):
        return not self.text.startswith(word, node.extent.start.offset)

    def branches(self, node):
        """if, while: a head in parentheses, then statements."""
        start = node.extent.start.offset
        if self.of_macro(node, b'if' if node.kind == K.IF_STMT else b'while'):
            return
        head_start, head_end = self.parenthesis(start)
        constant = b'constexpr' in self.text[start:head_start]
        children = list(node.get_children())
        head = [c for c in children if c.extent.end.offset <= head_end]
        if not constant:
            for child in head:
                if not self.text[child.extent.end.offset:head_end].strip() and \
                        child.kind != K.DECL_STMT:
                    self.negatable(child)
                self.visit(child)
        self.statements(c for c in children if c.extent.start.offset > head_end)

    def for_loop(self, node):
        if self.of_macro(node, b'for'):
            return
        head_start, head_end = self.parenthesis(node.extent.start.offset)
        semicolons = [m.start() + head_start
                      for m in re.finditer(rb';', self.text[head_start:head_end])]
        children = list(node.get_children())
        for child in children:
            start, end = self.span(child)
            if start > head_end:
                continue
            if len(semicolons) == 2 and semicolons[0] < start and end <= semicolons[1]:
                self.negatable(child)
            self.visit(child)
        self.statements(c for c in children if c.extent.start.offset > head_end)

    # --- expressions ------------------------------------------------------
    def visit(self, node):
        kind = node.kind
        if kind in CONSTANT:
            return
        if kind in SCOPES:
            self.declarations(node)
        elif kind == K.COMPOUND_STMT:
            self.statements(node.get_children())
        elif kind in (K.IF_STMT, K.WHILE_STMT):
            self.branches(node)
        elif kind == K.FOR_STMT:
            self.for_loop(node)
        elif kind == K.CXX_FOR_RANGE_STMT:
            children = list(node.get_children())
            for child in children[:-1]:
                self.visit(child)
            self.statements(children[-1:])
        elif kind == K.DO_STMT:
            if self.of_macro(node, b'do'):
                return
            children = list(node.get_children())
            self.statements(children[:1])
            self.negatable(children[-1])
            self.visit(children[-1])
        elif kind == K.CASE_STMT:
            self.statements(list(node.get_children())[1:])
        elif kind == K.DEFAULT_STMT:
            self.statements(node.get_children())
        elif kind == K.VAR_DECL:
            self.variable(node)
        elif kind == K.LAMBDA_EXPR:
            self.closure(node)
        elif kind == K.MEMBER_REF_EXPR:
            for child in node.get_children():
                if child.kind not in LITERALS:
                    self.visit(child)
        else:
            self.expression(node)

    def closure(self, node):
        outer = self.body_end, self.returns_value
        self.body_end, self.returns_value = node.extent.end.offset, True
        for child in node.get_children():
            if child.kind == K.COMPOUND_STMT:
                self.visit(child)
        self.body_end, self.returns_value = outer

    def variable(self, node):
        head = self.text[node.extent.start.offset:node.location.offset]
        # Tables and constants: changed data, not changed behaviour.
        if re.search(rb'\b(constexpr|constinit|static)\b', head):
            return
        for child in node.get_children():
            between = self.text[node.location.offset:child.extent.start.offset]
            if child.extent.start.offset > node.location.offset and not between.rstrip().endswith(
                    b'['):
                self.visit(child)

    def expression(self, node):
        kind = node.kind
        start, end = self.span(node)
        children = list(node.get_children())
        if kind in (K.BINARY_OPERATOR, K.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.binary(node, children)
        elif kind == K.UNARY_OPERATOR and len(children) == 1:
            self.unary(node, children[0])
        elif kind == K.CONDITIONAL_OPERATOR and children:
            self.negatable(children[0])
        elif kind == K.INTEGER_LITERAL:
            found = INTEGER.match(self.source(node))
            if found:
                digits, suffix = found.groups()
                plain = digits.replace("'", '')
                value = int(plain, 8 if re.match(r'0[0-7]+\Z', plain) else 0)
                write = hex if digits[:2] in ('0x', '0X') else str
                for other in (value + 1, value - 1):
                    if other >= 0:
                        new = write(other) + suffix
                        self.add(start, end, 'constant', new, f'({{m}} ? {new} : {{old}})')
        elif kind == K.FLOATING_LITERAL:
            found = FLOAT.match(self.source(node))
            if found:
                new = f'{found.group(0)} + 1'
                self.add(start, end, 'constant', new, f'({{m}} ? ({new}) : {{old}})')
        elif kind == K.CXX_BOOL_LITERAL_EXPR and self.source(node) in ('true', 'false'):
            new = 'false' if self.source(node) == 'true' else 'true'
            self.add(start, end, 'constant', new, f'({{m}} ? {new} : {{old}})')
        for child in children:
            self.visit(child)

    def binary(self, node, children):
        left, right = children
        start, end = self.span(node)
        if not start <= left.extent.end.offset <= right.extent.start.offset < end:
            return
        between = self.text[left.extent.end.offset:right.extent.start.offset]
        operator = between.decode('utf-8', 'replace').strip()
        a, b = self.source(left), self.source(right)
        for table, kind in ((BOUNDARY, 'boundary'), (NEGATE, 'negate'), (ARITHMETIC, 'arithmetic')):
            if operator in table:
                new = f'{a} {table[operator]} {b}'
                self.add(start, end, kind, new, f'({{m}} ? ({one_line(new)}) : ({{old}}))')
        if operator in SWAPPED:
            new = f'({b}) {operator} ({a})'
            self.add(start, end, 'arithmetic', new, f'({{m}} ? ({one_line(new)}) : ({{old}}))')

    def unary(self, node, operand):
        start, end = self.span(node)
        text, inner = self.source(node), self.source(operand)
        if text.startswith('!') and text.endswith(inner):
            self.add(start, end, 'negate', inner, '((int)({old}) != {m})')
        for old, new in (('++', '--'), ('--', '++')):
            if text == old + inner or text == inner + old:
                changed = text.replace(old, new, 1) if text.startswith(old) else inner + new
                self.add(start, end, 'arithmetic', changed,
                         f'({{m}} ? ({one_line(changed)}) : ({{old}}))')


def unit_places(source, arguments, root, wanted, done):
    """Places of one translation unit: in the files for which `wanted(relative name)` is true and that
    are not in `done` (which it extends). Returns places and what the compiler complained about."""
    index = clang.cindex.Index.create()
    unit = index.parse(source, args=arguments)
    complaints = [str(d) for d in unit.diagnostics if d.severity >= clang.cindex.Diagnostic.Error]
    finders = {}
    for node in unit.cursor.get_children():
        if node.location.file is None:
            continue
        # A header that is included by a path with '..' is the same file as without.
        name = os.path.normpath(node.location.file.name)
        finder = finders.get(name, False)
        if finder is False:
            finder = None
            relative = name[len(root) + 1:] if name.startswith(root + '/') else ''
            if relative and relative not in done and wanted(relative):
                with open(name, 'rb') as f:
                    finder = Finder(relative, f.read())
                done.add(relative)
            finders[name] = finder
        if finder is None:
            continue
        if node.kind in SCOPES:
            finder.declarations(node)
        elif node.kind in FUNCTIONS:
            finder.define(node)
    places = [p for f in finders.values() if f for p in f.places]
    return places, complaints
