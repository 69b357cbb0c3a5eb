"""A folder of results of `fovea run`, `exec` or `replay`, read as the program reads it."""
import csv
import difflib
import json
import math
import pathlib
import re

FORMAT = "fovea run 1"  # of config.json
_MOST_BYTES = {".json": 16 << 20, ".csv": 128 << 20}
_ALLOWED = "allowed: a folder of results, as 'fovea run', 'exec' and 'replay' write it"
_WHOLE = re.compile(r"[0-9]+")
_FRACTION = re.compile(r"-?[0-9]+\.[0-9]+")


class ResultsError(ValueError):
    """One line: which folder or file, what is wrong with it, and what is allowed."""


class Figures(dict):
    """Figures by name: int, float, or None for one that has no value, such as a mean of nothing."""

    def __init__(self, members, file):
        super().__init__()
        self._about = {}
        for name, member in members.items():
            if not isinstance(member, dict):
                continue
            value, unit = member.get("value"), member.get("unit")
            number = value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))
            if "value" not in member or not number or not isinstance(unit, str):
                raise ResultsError(f"'{file}': '{name}' is no figure with a number and a unit; it is damaged")
            self[name] = value
            self._about[name] = unit, member.get("description", "")

    def __missing__(self, name):
        near = difflib.get_close_matches(str(name), self, 1)
        raise KeyError(f"no figure '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))

    def unit(self, name):
        """The unit of a figure: "s", "count", ..."""
        self[name]
        return self._about[name][0]

    def description(self, name):
        """What the figure counts, in words."""
        self[name]
        return self._about[name][1]


class Results:
    """What a run left. Besides the attributes below each table is one: `frames` is frames.csv, `stalls` is stalls.csv,
    `profile` is profile.csv, as a list of rows; `pandas.DataFrame(results.frames)` makes a frame of it.

    folder        where the results are
    complete      False: the run was stopped, or its guest failed
    stats, host   Figures of the run, and of the simulator itself (without host.json there are none)
    params        values of the parameters by key, as text
    config        the whole of config.json: version, commit, origin of each parameter, hashes of the inputs
    warnings      list of {"kind": ..., "what": ..., "count": ...}
    ended_by, kernel   the condition that ended the run, and the kernels that the firmware says it ran, or ""
    """

    def __init__(self, folder, partial=False):
        self.folder = folder = pathlib.Path(folder)
        if not folder.is_dir():
            raise ResultsError(f"'{folder}' is not a folder; {_ALLOWED}")
        self.config = config = _config(folder)
        if not (folder / "stats.json").is_file():
            raise ResultsError(f"'{folder}' has no stats.json: its run did not end; allowed: complete results")
        file = folder / "stats.json"
        stats = _object(file)
        self.complete = stats.get("complete")
        if not isinstance(self.complete, bool):
            raise ResultsError(f"'{file}': it does not say whether its results are complete; it is damaged")
        if not self.complete and not partial:
            raise ResultsError(f"'{folder}' holds partial results: its run was stopped or its guest failed; "
                               "allowed: complete results, or partial=True")
        self.stats = Figures(stats, file)
        self.warnings = stats.get("warnings", [])
        self.ended_by, self.kernel = stats.get("ended_by", ""), stats.get("kernel", "")
        params = config.get("params")
        if not isinstance(params, dict) or not all(isinstance(p, dict) for p in params.values()):
            raise ResultsError(f"'{folder / 'config.json'}': it has no parameters; it is damaged")
        self.params = {key: p.get("value") for key, p in params.items()}
        file = folder / "host.json"
        self.host = Figures(_object(file) if file.is_file() else {}, file)

    def table(self, name):
        """The rows of NAME.csv, each a dict by column. A column of numbers has int or float, and None where a cell is
        empty; a column with anything else has text."""
        file = self.folder / f"{name}.csv"
        if not file.is_file():
            there = ", ".join(sorted(f.stem for f in self.folder.glob("*.csv")))
            raise ResultsError(f"'{self.folder}' has no {name}.csv; allowed: {there}")
        return _table(file)

    def __getattr__(self, name):
        if name.startswith("_") or name == "folder":
            raise AttributeError(name)
        try:
            return self.table(name)
        except ResultsError as error:
            if (self.folder / f"{name}.csv").is_file():
                raise
            raise AttributeError(f"{error}") from None

    def __repr__(self):
        return f"<results of {self.config.get('experiment') or self.config.get('input')} in '{self.folder}'>"


def read(folder, partial=False):
    """Results of a folder. `partial`: take those of a run that was stopped or whose guest failed, too.
    Raises ResultsError for a folder that the program itself would refuse."""
    return Results(folder, partial)


def _text(file):
    size, most = file.stat().st_size, _MOST_BYTES[file.suffix]
    if size > most:
        raise ResultsError(f"'{file}' has {size} bytes; allowed: up to {most}")
    try:
        return file.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ResultsError(f"'{file}': not a text; it is damaged") from None


def _integer(text):
    # As the program reads them: counts have 64 bits and no sign.
    value = int(text) if len(text) <= 20 else _finite(text)
    return value if 0 <= value < 1 << 64 else _finite(text)


def _finite(text):
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def _no_constant(text):
    raise ValueError(text)


def _object(file):
    try:
        value = json.loads(_text(file), parse_int=_integer, parse_float=_finite, parse_constant=_no_constant)
    except (ValueError, RecursionError):
        value = None
    if not isinstance(value, dict):
        raise ResultsError(f"'{file}': not a file of JSON; it is damaged")
    return value


def _config(folder):
    file, config = folder / "config.json", {}
    if file.is_file():
        try:
            config = _object(file)
        except ResultsError:
            pass  # a file of something else
    if "format" not in config:
        raise ResultsError(f"'{folder}' is not a folder of results: it has no config.json of Fovea's; {_ALLOWED}")
    if config["format"] != FORMAT:
        raise ResultsError(f"'{folder}': its format is '{config['format']}'; this version reads '{FORMAT}' only")
    return config


def _table(file):
    # Line ends of Windows and blank lines count for nothing.
    reader = csv.reader(_text(file).splitlines(keepends=True), strict=True)
    names, rows = None, []
    try:
        for row in reader:
            if not row:
                continue
            if names is None:
                names = row
            elif len(row) != len(names):
                raise ResultsError(f"'{file}', line {reader.line_num}: {len(row)} fields; allowed: {len(names)}")
            else:
                rows.append(row)
    except csv.Error as error:
        raise ResultsError(f"'{file}', line {reader.line_num}: {error}; it is damaged") from None
    if names is None:
        raise ResultsError(f"'{file}' is empty; it is damaged")
    columns = [_column([row[n] for row in rows]) for n in range(len(names))]
    return [dict(zip(names, row)) for row in zip(*columns)]


def _column(cells):
    numbers = []
    for cell in cells:
        if _WHOLE.fullmatch(cell):
            numbers.append(int(cell))
        elif _FRACTION.fullmatch(cell):
            numbers.append(float(cell))
        elif cell:
            return cells
        else:
            numbers.append(None)
    return numbers if any(n is not None for n in numbers) else cells
