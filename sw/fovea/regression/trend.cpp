#include "sw/fovea/regression/trend.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <nlohmann/json.hpp>
#include <set>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/safe_json.h"

namespace fovea::regression {
namespace {

using nlohmann::json;

/// "FOVT": tells the file from SQLite files of other programs.
constexpr int kApplicationId = 0x464f5654;
constexpr int kBusyMilliseconds = 10'000;

}  // namespace

/// A prepared statement.
class TrendFile::Statement {
 public:
  Statement(const TrendFile& file, const char* sql) : file_(file) {
    if (sqlite3_prepare_v2(file.db_, sql, -1, &statement_, nullptr) != SQLITE_OK)
      file.fail(sqlite3_errmsg(file.db_));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  void bind(int at, const std::string& text) {
    sqlite3_bind_text(statement_, at, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
  }
  void bind(int at, std::optional<double> value) {
    if (value) sqlite3_bind_double(statement_, at, *value);
    else sqlite3_bind_null(statement_, at);
  }
  /// @return true if there is a row
  bool step() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) file_.fail(sqlite3_errmsg(file_.db_));
    return result == SQLITE_ROW;
  }
  std::string text(int column) const {
    const auto* const bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return bytes ? bytes : "";
  }
  std::optional<double> number(int column) const {
    if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::nullopt;
    return sqlite3_column_double(statement_, column);
  }

 private:
  const TrendFile& file_;
  sqlite3_stmt* statement_ = nullptr;
};

TrendFile::TrendFile(const std::filesystem::path& file) : file_(file) {
  if (file.empty()) throw UserError("--database '': a file name is needed");
  // SQLite has names of its own, ":memory:" and "file:...?mode="; none of them begins with a slash.
  std::error_code error;
  const std::filesystem::path place = std::filesystem::absolute(file, error);
  // SQLite follows links and changes what it finds in place.
  if (std::error_code unknown; std::filesystem::is_symlink(std::filesystem::symlink_status(place, unknown)))
    throw UserError(fmt::format("--database '{}': it is a symbolic link; allowed: the file itself",
                                app::one_line(file.string())));
  const bool failed = error || sqlite3_open(place.c_str(), &db_) != SQLITE_OK;
  try {
    if (failed) fail(sqlite3_errmsg(db_));
    sqlite3_busy_timeout(db_, kBusyMilliseconds);
    double id = 0, version = 0;
    {
      Statement s(*this, "PRAGMA application_id");
      if (s.step()) id = s.number(0).value_or(0);
      Statement tables(*this, "SELECT count(*) FROM sqlite_master");
      if (tables.step()) version = tables.number(0).value_or(0);
    }
    if (id != kApplicationId && version != 0)
      fail("it is a database of another program; allowed: a file of 'fovea trend', or a new one");
    execute(fmt::format("PRAGMA application_id = {}", kApplicationId).c_str());
    execute(
        "CREATE TABLE IF NOT EXISTS runs (number INTEGER PRIMARY KEY, commit_name TEXT NOT NULL, "
        "experiment TEXT NOT NULL, simulator TEXT NOT NULL, host_instructions REAL, "
        "figures TEXT NOT NULL, units TEXT NOT NULL, program TEXT NOT NULL DEFAULT '', "
        "folder TEXT NOT NULL DEFAULT '', UNIQUE (commit_name, experiment))");
    add_columns();
  } catch (...) {
    sqlite3_close(db_);
    throw;
  }
}

TrendFile::~TrendFile() { sqlite3_close(db_); }

void TrendFile::fail(const std::string& what) const {
  throw UserError(fmt::format("--database '{}': {}", app::one_line(file_.string()),
                              app::one_line(what)));
}

void TrendFile::execute(const char* sql) {
  Statement s(*this, sql);
  while (s.step()) {
  }
}

void TrendFile::add(const TrendLine& line, bool replace) {
  json figures = json::object(), units = json::object();
  for (const auto& [name, m] : line.figures) {
    if (!m.value) continue;
    figures[name] = app::json_number(*m.value, m.whole);
    units[name] = m.unit;
  }
  execute("BEGIN IMMEDIATE");
  try {
    if (!replace) refuse_other_program(line);
    Statement s(*this,
                "INSERT INTO runs (commit_name, experiment, simulator, host_instructions, figures, units, program, "
                "folder) VALUES (?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (commit_name, experiment) DO UPDATE SET "
                "simulator = excluded.simulator, host_instructions = excluded.host_instructions, "
                "figures = excluded.figures, units = excluded.units, program = excluded.program, "
                "folder = excluded.folder");
    s.bind(1, line.commit);
    s.bind(2, line.experiment);
    s.bind(3, line.simulator);
    s.bind(4, line.host_instructions);
    s.bind(5, figures.dump());
    s.bind(6, units.dump());
    s.bind(7, line.program);
    s.bind(8, line.folder);
    s.step();
  } catch (...) {
    sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
  execute("COMMIT");
}

void TrendFile::refuse_other_program(const TrendLine& line) {
  Statement s(*this, "SELECT program FROM runs WHERE commit_name = ? AND experiment = ?");
  s.bind(1, line.commit);
  s.bind(2, line.experiment);
  if (!s.step() || (s.text(0) == line.program && !line.program.empty())) return;
  const auto known = [](const std::string& hash) {
    return hash.empty() ? "not known" : "SHA-256 " + hash.substr(0, 12);
  };
  fail(fmt::format(
      "it has a line of commit {} and {} with another program ({}; this one: {}); allowed: --commit NAME for "
      "this one, or --replace",
      line.commit, line.experiment, known(s.text(0)), known(line.program)));
}

/// Files of earlier versions have no such columns.
void TrendFile::add_columns() {
  std::set<std::string> columns;
  {
    Statement s(*this, "SELECT name FROM pragma_table_info('runs')");
    while (s.step()) columns.insert(s.text(0));
  }
  for (const char* name : {"program", "folder"})
    if (!columns.contains(name))
      execute(fmt::format("ALTER TABLE runs ADD COLUMN {} TEXT NOT NULL DEFAULT ''", name).c_str());
}

std::vector<TrendLine> TrendFile::lines(const std::string& experiment) const {
  Statement s(*this,
              "SELECT commit_name, experiment, simulator, host_instructions, figures, units, program, folder "
              "FROM runs WHERE ? IN ('', experiment) ORDER BY number");
  s.bind(1, experiment);
  std::vector<TrendLine> out;
  while (s.step()) {
    TrendLine line{s.text(0), s.text(1), s.text(2), s.number(3), {}, s.text(6), s.text(7)};
    const json figures = app::parse_json(s.text(4));
    const json units = app::parse_json(s.text(5));
    if (!figures.is_object() || !units.is_object())
      fail("the line of commit " + line.commit + " cannot be read");
    for (const auto& [name, value] : figures.items()) {
      if (!value.is_number()) continue;
      const json unit = units.value(name, json(""));
      if (!unit.is_string()) fail("the line of commit " + line.commit + " cannot be read");
      line.figures[name] = {value.get<double>(), unit.get<std::string>(), value.is_number_integer()};
    }
    out.push_back(std::move(line));
  }
  return out;
}

std::vector<std::string> TrendFile::experiments() const {
  Statement s(*this, "SELECT DISTINCT experiment FROM runs ORDER BY experiment");
  std::vector<std::string> out;
  while (s.step()) out.push_back(s.text(0));
  return out;
}

}  // namespace fovea::regression
