// The picture of `fovea trend`: plain SVG, readable on light and dark pages and in print.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/files/xml.h"
#include "sw/fovea/regression/trend.h"

namespace fovea::regression {
namespace {

// All lengths in pixels.
constexpr double kLeft = 96, kRight = 24, kTop = 46, kPanel = 110, kGap = 46, kPlot = 720, kLabel = 74;

/// Colours that people with a colour deficiency can tell apart (Okabe and Ito), with marks of
/// different shapes.
constexpr std::array<const char*, 6> kColours = {"#0072b2", "#d55e00", "#009e73",
                                                 "#cc79a7", "#e69f00", "#56b4e9"};

struct Point {
  std::size_t commit;
  double value;
};

std::string mark(std::size_t series, double x, double y, const std::string& title) {
  const char* const colour = kColours[series % kColours.size()];
  const std::string what = fmt::format("<title>{}</title>", app::xml_text(title));
  switch (series % 3) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\">{}</circle>\n", x, y, colour, what);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"7\" height=\"7\" fill=\"{}\">{}</rect>\n",
                         x - 3.5, y - 3.5, colour, what);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l4 7h-8z\" fill=\"{}\">{}</path>\n", x, y - 4, colour, what);
  }
}

std::string title_of(const std::string& figure, bool relative) {
  return fmt::format("{}{}",
                     figure == kHostInstructions
                         ? "host instructions of the simulator for each guest instruction"
                         : app::xml_text(figure),
                     relative ? ", change since the first commit" : "");
}

/// A level of a panel: short, with a prefix for large counts.
std::string tick_text(double level, const std::string& unit) {
  constexpr std::array<std::pair<double, const char*>, 3> kPrefixes = {{{1e9, " G"}, {1e6, " M"}, {1e3, " k"}}};
  if (unit == "s" || unit == "B" || unit == "W" || unit == "ratio") {
    Metric m;
    m.value = level;
    m.unit = unit;
    return figure_text(m);
  }
  for (const auto& [scale, prefix] : kPrefixes)
    if (std::abs(level) >= scale) return fmt::format("{:.4g}{}", level / scale, prefix);
  return fmt::format("{:.4g}{}", level, unit == "1" || unit.size() > 8 ? "" : " " + unit);
}

/// A commit as a label: hashes are cut as git does, names are kept.
std::string short_name(const std::string& commit) {
  const bool hash = commit.size() > 9 && commit.find_first_not_of("0123456789abcdef") == commit.npos;
  return hash ? commit.substr(0, 9) : commit.size() > 14 ? commit.substr(0, 13) + "…" : commit;
}

/// A panel for each figure, one above the other, over the commits from left to right.
class TrendPlot {
 public:
  TrendPlot(const std::vector<TrendLine>& lines, const std::vector<std::string>& figures, const Tolerance& tolerance)
      : lines_(lines), jumps_(jumps_of(lines, figures, tolerance)) {
    for (const auto& line : lines) {
      if (std::find(commits_.begin(), commits_.end(), line.commit) == commits_.end())
        commits_.push_back(line.commit);
      if (std::find(experiments_.begin(), experiments_.end(), line.experiment) == experiments_.end())
        experiments_.push_back(line.experiment);
    }
    for (const auto& name : figures)
      if (std::any_of(lines.begin(), lines.end(), [&](const auto& l) { return trend_figure(l, name); }))
        shown_.push_back(name);
    if (shown_.empty()) throw UserError("none of the figures has a value in the database; nothing to plot");
    relative_ = experiments_.size() > 1;
  }

  std::string svg() const {
    const double height = kTop + static_cast<double>(shown_.size()) * (kPanel + kGap) + kLabel;
    const double width = kLeft + kPlot + kRight;
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\" "
        "aria-label=\"Figures over commits\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        width, height);
    out += legend();
    for (std::size_t p = 0; p < shown_.size(); ++p)
      out += panel(shown_[p], kTop + static_cast<double>(p) * (kPanel + kGap) + 18);
    return out + commit_labels() + "</svg>\n";
  }

 private:
  double x_of(std::size_t commit) const {
    return commits_.size() == 1 ? kLeft + kPlot / 2
                                : kLeft + kPlot * static_cast<double>(commit) /
                                              static_cast<double>(commits_.size() - 1);
  }
  std::string legend() const {
    std::string out;
    double at = kLeft;
    for (std::size_t e = 0; e < experiments_.size(); ++e) {
      out += mark(e, at, 18, experiments_[e]);
      out += fmt::format("<text x=\"{:.0f}\" y=\"22\">{}</text>\n", at + 10, app::xml_text(experiments_[e]));
      at += 30 + 7.5 * static_cast<double>(experiments_[e].size());
    }
    return out;
  }
  /// Of each experiment, the value of a figure at its first commit.
  std::vector<double> first_values(const std::string& figure) const {
    std::vector<double> first(experiments_.size(), 0);
    for (std::size_t e = 0; e < experiments_.size(); ++e)
      for (auto line = lines_.rbegin(); line != lines_.rend(); ++line)
        if (const auto m = trend_figure(*line, figure); m && line->experiment == experiments_[e]) first[e] = *m->value;
    return first;
  }

  std::string panel(const std::string& figure, double top) const {
    const std::vector<double> first = first_values(figure);
    const auto height_of = [&](const TrendLine& line, double value) {
      if (!relative_) return value;
      const auto e = static_cast<std::size_t>(
          std::find(experiments_.begin(), experiments_.end(), line.experiment) - experiments_.begin());
      return first[e] == 0 ? (value == 0 ? 0 : 100) : 100 * (value / first[e] - 1);
    };
    double low = INFINITY, high = -INFINITY;
    std::string unit;
    for (const auto& line : lines_)
      if (const auto m = trend_figure(line, figure)) {
        low = std::min(low, height_of(line, *m->value));
        high = std::max(high, height_of(line, *m->value));
        unit = relative_ ? "%" : m->unit;
      }
    // A curve that does not change is drawn in the middle, not as a line of noise.
    const double least = relative_ ? 0.5 : std::max(std::abs(high) * 0.02, 1e-12);
    const double centre = (low + high) / 2, half = std::max((high - low) / 2 * 1.1, least);
    const auto y_of = [&](double value) { return top + kPanel * (0.5 - (value - centre) / (2 * half)); };
    std::string out = fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" font-weight=\"bold\">{}</text>\n", kLeft, top - 8,
                                  title_of(figure, relative_));
    for (const double level : {centre - half * 0.9, centre, centre + half * 0.9})
      out += grid_line(y_of(level), relative_ ? fmt::format("{:+.2g} %", level) : tick_text(level, unit));
    for (std::size_t e = 0; e < experiments_.size(); ++e)
      out += curve(e, figure, [&](const TrendLine& line, double value) { return y_of(height_of(line, value)); });
    return out;
  }
  static std::string grid_line(double y, const std::string& label) {
    return fmt::format("<line x1=\"{0:.0f}\" x2=\"{1:.0f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#d0d0d0\"/>\n",
                       kLeft, kLeft + kPlot, y) +
           fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\" fill=\"#404040\">{}</text>\n",
                       kLeft - 8, y + 4, app::xml_text(label));
  }
  template <class HeightOf>
  std::string curve(std::size_t experiment, const std::string& figure, HeightOf y_of) const {
    std::string path, marks;
    for (std::size_t c = 0; c < commits_.size(); ++c)
      for (const auto& line : lines_)
        if (line.commit == commits_[c] && line.experiment == experiments_[experiment])
          if (const auto m = trend_figure(line, figure)) {
            const double y = y_of(line, *m->value);
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_of(c), y);
            marks += mark(experiment, x_of(c), y,
                          fmt::format("{} {}: {}", line.commit, line.experiment, figure_text(*m)));
            marks += jump_mark(line, figure, x_of(c), y);
          }
    if (path.empty()) return "";
    return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n{}", path,
                       kColours[experiment % kColours.size()], marks);
  }
  /// A ring around the value, and how far it is from the one before.
  std::string jump_mark(const TrendLine& line, const std::string& figure, double x, double y) const {
    const auto jump = std::find_if(jumps_.begin(), jumps_.end(),
                                   [&](const Jump& j) { return j.after == &line && j.figure == figure; });
    if (jump == jumps_.end()) return "";
    return fmt::format(
        "<circle class=\"jump\" cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7\" fill=\"none\" stroke=\"#000000\"/>\n"
        "<text x=\"{2:.1f}\" y=\"{3:.1f}\" text-anchor=\"end\" fill=\"#000000\">{4}</text>\n",
        x, y, x - 9, y + 4, std::isinf(jump->relative) ? "from 0" : fmt::format("{:+.1f} %", 100 * jump->relative));
  }
  /// At most as many as there is room for.
  std::string commit_labels() const {
    std::string out;
    const std::size_t step = std::max<std::size_t>(1, (commits_.size() + 23) / 24);
    const double base = kTop + static_cast<double>(shown_.size()) * (kPanel + kGap) - 10;
    for (std::size_t c = 0; c < commits_.size(); c += step)
      out += fmt::format("<text transform=\"translate({:.1f} {:.0f}) rotate(-45)\" text-anchor=\"end\" "
                         "fill=\"#404040\">{}</text>\n",
                         x_of(c) + 4, base, app::xml_text(short_name(commits_[c])));
    return out;
  }

  const std::vector<TrendLine>& lines_;
  std::vector<Jump> jumps_;
  std::vector<std::string> commits_, experiments_, shown_;
  /// Curves of several experiments differ too much in height to show a change of a few percent; they
  /// are drawn as changes since their first commit.
  bool relative_ = false;
};

}  // namespace

std::string trend_svg(const std::vector<TrendLine>& lines, const std::vector<std::string>& figures,
                      const Tolerance& tolerance) {
  return TrendPlot(lines, figures, tolerance).svg();
}

}  // namespace fovea::regression
