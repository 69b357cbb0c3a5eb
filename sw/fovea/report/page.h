// The page of HTML.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/report/results.h"

namespace fovea::report {

/// A report of one or several runs as one file of HTML that needs nothing else. Equal folders give
/// equal bytes. @throws UserError for a damaged picture
std::string report_page(const std::vector<Results>& runs);

/// Verdict and findings as plain text, for a terminal or a log.
std::string report_text(const std::vector<Results>& runs);

/// True for the first bytes of a file that report_page() made.
bool is_report_page(std::string_view first_bytes);

/// "A", "B" ... for the runs of a report.
std::string run_label(std::size_t index);

/// More runs would not fit side by side.
inline constexpr std::size_t kMaxRuns = 8;

}  // namespace fovea::report
