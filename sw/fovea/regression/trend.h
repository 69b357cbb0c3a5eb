// `fovea trend`: the figures of one run for each commit, in an SQLite file, and a plot of them.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/compare/tolerance.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/run_figures.h"

struct sqlite3;

namespace fovea::regression {

/// One line of the file.
struct TrendLine {
  std::string commit, experiment, simulator;
  std::optional<double> host_instructions;  ///< of the simulator, for each guest instruction
  std::map<std::string, Metric> figures;
  std::string program = {};  ///< SHA-256 of what ran; empty: not known
  std::string folder = {};   ///< of the results when the line was added
};

/// An SQLite file with the table `runs`: a line for each commit and experiment, in the order in
/// which they were first added. The column `figures` is a JSON object of values, for
/// `json_extract(figures, '$."frame.rate"')`; `units` holds their units.
class TrendFile {
 public:
  /// Opens or creates the file. @throws UserError if it is not one of Fovea's, or cannot be opened
  explicit TrendFile(const std::filesystem::path& file);
  ~TrendFile();
  TrendFile(const TrendFile&) = delete;
  TrendFile& operator=(const TrendFile&) = delete;

  /// Adds a line, or replaces the one of the same commit and experiment, which keeps its place.
  /// @throws UserError: that one is of another program, or of one that is not known, unless `replace`
  void add(const TrendLine& line, bool replace);
  /// The lines of an experiment, or of all with an empty name, in order.
  std::vector<TrendLine> lines(const std::string& experiment) const;
  /// Names of the experiments, sorted.
  std::vector<std::string> experiments() const;

 private:
  class Statement;
  void execute(const char* sql);
  void refuse_other_program(const TrendLine& line);
  void add_columns();
  [[noreturn]] void fail(const std::string& what) const;
  std::filesystem::path file_;
  sqlite3* db_ = nullptr;
};

/// A name for the host instructions among the figures of a plot.
inline constexpr const char* kHostInstructions = "host_instructions";

/// A figure of a line; empty: it has none.
std::optional<Metric> trend_figure(const TrendLine& line, const std::string& name);

/// A figure that differs by more than the tolerance from the line before of the same experiment.
struct Jump {
  const TrendLine *before = nullptr, *after = nullptr;
  std::string figure;
  double relative = 0;  ///< change as a share; infinite from 0
};
/// All jumps, in the order of the lines. The simulator's host instructions are no figure of the program and make none.
std::vector<Jump> jumps_of(const std::vector<TrendLine>& lines, const std::vector<std::string>& figures,
                           const Tolerance& tolerance);
/// Who is to blame for what is different between two lines, as one sentence, or why that is not known.
std::string blame_of_jump(const TrendLine& before, const TrendLine& after);

/// A picture with a panel for each figure: its values over the commits, one curve for each
/// experiment, and marks where it jumps. Figures without any value are left out. @throws UserError if nothing is left
std::string trend_svg(const std::vector<TrendLine>& lines, const std::vector<std::string>& figures,
                      const Tolerance& tolerance);

}  // namespace fovea::regression
