#include "sw/fovea/regression/pair_check.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <ostream>
#include <thread>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/points/child.h"
#include "sw/fovea/regression/first_baseline.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kPause = std::chrono::milliseconds(20);
/// How long a run may take to end after SIGTERM before it is killed.
constexpr auto kPatience = std::chrono::seconds(10);

fs::path new_folder() {
  std::error_code error;
  std::string name = (fs::temp_directory_path(error) / "fovea-check-XXXXXX").string();
  if (error || !::mkdtemp(name.data()))
    throw UserError(
        fmt::format("no folder for the runs can be made in '{}': {}; allowed: --out DIR and a TMPDIR that "
                    "can be written",
                    app::one_line(name), std::strerror(errno)));
  return name;
}

/// A run as a process of its own, whose messages are handed on line by line under the program's name.
class OneRun {
 public:
  OneRun(std::string name, const std::vector<std::string>& command, const fs::path& log, const app::CliContext& context)
      : name_(std::move(name)),
        messages_(log.string() + ".messages"),
        context_(context),
        child_(command, log.string() + ".output", messages_) {}

  /// True when it has ended, and all its messages are handed on.
  bool look() {
    const bool ran = !ended_;
    if (ran) ended_ = child_.ended();
    hand_on();
    if (ran && ended_ && ended_->signal)
      context_.err << fmt::format("fovea: {}: ended by signal {}\n", name_, ended_->signal) << std::flush;
    return ended_.has_value();
  }
  void ask_to_end() { child_.ask_to_end(); }
  bool hangs() { return !ended_ && silence_.too_long(child_); }
  const std::string& name() const { return name_; }
  int status() const { return ended_ ? ended_->status : 128; }

 private:
  void hand_on() {
    std::ifstream file(messages_);
    file.seekg(static_cast<std::streamoff>(read_));
    std::string line;
    while (std::getline(file, line)) {
      if (file.eof() && !ended_) return;  // not whole yet
      read_ += line.size() + 1;
      constexpr std::string_view kOwn = "fovea: ";
      if (line.starts_with(kOwn)) line.erase(0, kOwn.size());
      context_.err << fmt::format("fovea: {}: {}\n", name_, app::printable(line)) << std::flush;
    }
  }

  std::string name_;
  fs::path messages_;
  const app::CliContext& context_;
  points::Child child_;
  points::Silence silence_{points::kLongestSilence};
  std::optional<points::Ended> ended_;
  std::size_t read_ = 0;
};

std::vector<std::string> command_of(const PairRequest& request, const std::string& program, const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> out = {fs::read_symlink("/proc/self/exe", error).string(), "run", request.experiment};
  for (const auto& s : request.settings) out.insert(out.end(), {"-s", s});
  out.insert(out.end(), {"-s", "firmware.elf=" + program, "--profile", "--no-frames", "-o", folder.string()});
  return out;
}

/// Both at once. @return the status of the first one that failed, or 0 @throws Stopped @throws UserError if one hangs
int run_both(std::array<std::unique_ptr<OneRun>, 2>& runs, const app::CliContext& context) {
  const auto stop_both = [&] {
    for (auto& run : runs) run->ask_to_end();
    const auto until = Clock::now() + kPatience;
    for (auto& run : runs)
      while (!run->look() && Clock::now() < until) std::this_thread::sleep_for(kPause);
  };
  for (;;) {
    const bool first = runs[0]->look(), second = runs[1]->look();
    for (const auto& [over, run] : {std::pair(first, runs[0].get()), {second, runs[1].get()}})
      if (over && run->status() != 0) {
        stop_both();
        return run->status();
      }
    if (first && second) return 0;
    if (context.stop && context.stop->load()) {
      stop_both();
      throw app::Stopped("stopped before both programs were run");
    }
    for (auto& run : runs)
      if (run->hangs()) {
        stop_both();
        throw UserError(fmt::format("the run of '{}' hangs: for {} s it has neither used the processor nor written "
                                    "anything, and was ended",
                                    run->name(), std::chrono::seconds(points::kLongestSilence.count() / 1000).count()));
      }
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace

PairRuns::PairRuns(const PairRequest& request, const app::CliContext& context) : temporary_(new_folder()) {
  try {
    const Tolerance tolerance =
        parse_tolerance(request.tolerance.empty() ? kFirstTolerance : request.tolerance, "--tolerance");
    const fs::path place = request.out.empty() ? temporary_ : fs::path(request.out);
    const std::array<std::string, 2> programs = {request.before, request.after}, names = {"a", "b"};
    std::array<std::unique_ptr<OneRun>, 2> runs;
    std::error_code error;
    fs::create_directories(place, error);
    for (std::size_t i = 0; i < runs.size(); ++i)
      runs[i] = std::make_unique<OneRun>(app::one_line(programs[i]), command_of(request, programs[i], place / names[i]),
                                         temporary_ / names[i], context);
    status_ = run_both(runs, context);
    if (status_) return;
    const RunFigures before = read_run(place / "a");
    after_ = read_run(place / "b");
    const fs::path reference = temporary_ / "reference";
    fs::create_directories(reference, error);
    for (const auto& [name, text] : reference_files(before)) {
      app::CheckedFile file(reference / name, app::CheckedFile::New{});
      file.write(text);
      file.close();
    }
    baseline_ = parse_baseline(
        temporary_ / "a.yaml",
        new_baseline({.run = &before, .tolerance = tolerance, .reference = "reference", .why = "the program before"}));
    baseline_.file = request.before;
    baseline_.text.clear();
    after_.subject.name += " by " + app::one_line(request.after);
    baseline_.subject = after_.subject;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
    throw;
  }
}

PairRuns::~PairRuns() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

}  // namespace fovea::regression
