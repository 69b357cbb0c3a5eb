#include "sw/fovea/points/runner.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <exception>
#include <ostream>
#include <thread>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::points {
namespace {

// Much less than the shortest run takes.
constexpr auto kPause = std::chrono::milliseconds(5);
constexpr std::size_t kMaxMessages = 16u << 20;

std::string replaced(std::string text, const std::filesystem::path& folder) {
  if (const auto at = text.find(kFolder); at != text.npos)
    text.replace(at, kFolder.size(), folder.string());
  return text;
}

/// Whether a point that ended so would end so again: it has results, or its own program failed. Other statuses may be
/// the host's fault: a full disk, an input that is repaired since, a Fovea that is.
bool belongs_to_point(int status) { return status == 0 || status == 1 || status == 3; }

std::string duration(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

}  // namespace

Runner::Runner(PointStore& store, RunnerOptions options)
    : store_(store), options_(std::move(options)) {
  FOVEA_CHECK(options_.jobs > 0, "no process may run");
  if (::access(options_.program.c_str(), X_OK) != 0)
    throw UserError(fmt::format("program '{}': it cannot be executed",
                                app::one_line(options_.program.string())));
}

Runner::~Runner() { stop_children(); }

void Runner::add(Point point, Done done) {
  std::string key = key_of(point);
  const auto found = by_key_.find(key);
  if (found != by_key_.end()) {
    Known& known = *found->second;
    known.waiting.push_back(std::move(done));
    if (known.result && known.waiting.size() == 1) ready_.push_back(&known);
    return;
  }
  auto& known = *known_.emplace_back(std::make_unique<Known>());
  known.point = std::move(point);
  known.key = key;
  known.waiting.push_back(std::move(done));
  by_key_[key] = &known;
  queue_.push_back(&known);
}

bool Runner::run() {
  for (;;) {
    while (!ready_.empty()) {
      Known* known = ready_.front();
      ready_.pop_front();
      deliver(*known);
    }
    while (running_.size() < options_.jobs && !queue_.empty() && ready_.empty()) {
      Known* known = queue_.front();
      queue_.pop_front();
      start(*known);
    }
    if (!ready_.empty()) continue;
    if (running_.empty()) return true;
    if (options_.stop && options_.stop->load()) {
      stop_children();
      return false;
    }
    std::this_thread::sleep_for(kPause);
    collect();
    look_for_silence();
  }
}

/// A point that hangs has no result, and the others run again with the next call.
void Runner::look_for_silence() {
  const auto hangs = std::find_if(running_.begin(), running_.end(),
                                  [](Running& r) { return r.silence.too_long(*r.child); });
  if (hangs == running_.end()) return;
  const std::string message = fmt::format(
      "the point '{}' hangs: for {} s it has neither used the processor nor written anything, and was ended; the same "
      "command goes on with what is left",
      app::one_line(hangs->known->point.label), std::chrono::duration<double>(hangs->silence.longest()).count());
  stop_children();
  throw UserError(message);
}

/// Takes an earlier result, or starts the program.
void Runner::start(Known& known) {
  if (auto earlier = store_.find(known.key)) {
    if (earlier->status == 0 || (belongs_to_point(earlier->status) && !options_.retry_failed)) {
      known.result = std::make_unique<PointResult>(std::move(*earlier));
      ++reused_;
      ready_.push_back(&known);
      return;
    }
    store_.forget(known.key);
  }
  const std::filesystem::path folder = store_.begin(known.key);
  Running running{&known, nullptr, {options_.program.string(), known.point.command,
                                    known.point.input}, Clock::now(), Silence(options_.silence)};
  for (const std::string& o : known.point.options) running.command.push_back(replaced(o, folder));
  for (const std::string& s : known.point.settings)
    running.command.insert(running.command.end(), {"-s", s});
  running.command.insert(running.command.end(), {"-o", (folder / "run").string()});
  running.child = std::make_unique<Child>(running.command, folder / "output.txt",
                                          folder / "messages.txt");
  running_.push_back(std::move(running));
}

void Runner::collect() {
  // In the order of their start, so that points which end together are taken in one order.
  std::vector<Running> still;
  std::vector<std::pair<Running, Ended>> over;
  for (Running& r : running_) {
    if (const auto ended = r.child->ended())
      over.emplace_back(std::move(r), *ended);
    else
      still.push_back(std::move(r));
  }
  running_ = std::move(still);
  std::exception_ptr failed;  // the others are results nevertheless
  for (auto& [running, ended] : over) {
    try {
      finish(running, ended);
    } catch (...) {
      if (!failed) failed = std::current_exception();
    }
  }
  if (failed) std::rethrow_exception(failed);
}

void Runner::finish(Running& running, const Ended& ended) {
  Known& known = *running.known;
  PointResult result;
  result.key = known.key;
  result.status = ended.status;
  result.wall_seconds = std::chrono::duration<double>(Clock::now() - running.since).count();
  const std::filesystem::path folder = store_.folder(known.key).string() + ".tmp";
  const std::string messages = app::read_file(folder / "messages.txt", kMaxMessages);
  if (ended.status != 0) result.message = reason_in(messages);
  // What somebody else has ended is no result, and neither is what never began.
  const bool by_signal = ended.signal || ended.status == 128 + SIGINT || ended.status == 128 + SIGTERM;
  if (by_signal || ended.status == 127) {
    store_.abandon(known.key);
    if (options_.stop && options_.stop->load()) return queue_.push_front(&known);
    throw UserError(
        by_signal
            ? fmt::format("the point '{}' was ended by signal {}, perhaps for want of memory; the "
                          "same command goes on with what is left, with fewer --jobs if need be",
                          app::one_line(known.point.label), ended.status - 128)
            : fmt::format("'{}' cannot be executed", app::one_line(options_.program.string())));
  }
  store_.finish(result, running.command);
  ++ran_;
  seconds_ += result.wall_seconds;
  known.result = std::make_unique<PointResult>(std::move(result));
  ready_.push_back(&known);
}

void Runner::deliver(Known& known) {
  auto waiting = std::move(known.waiting);
  known.waiting.clear();
  for (const Done& done : waiting) done(*known.result);
  report(known);
}

/// Ends the own children, and removes what they have not finished.
void Runner::stop_children() {
  for (Running& r : running_) r.child->ask_to_end();
  const auto until = Clock::now() + options_.patience;
  for (Running& r : running_) {
    while (!r.child->ended() && Clock::now() < until) std::this_thread::sleep_for(kPause);
    r.child.reset();  // kills it if it still runs
    store_.abandon(r.known->key);
    queue_.push_front(r.known);
  }
  running_.clear();
}

void Runner::report(Known& known) const {
  if (!options_.progress || known.result->reused || known.reported) return;
  known.reported = true;
  const PointResult& r = *known.result;
  std::string line = fmt::format("[{}] {}: ", ran_, app::one_line(known.point.label));
  line += r.status == 0 ? fmt::format("{:.1f} s", r.wall_seconds)
                        : fmt::format("status {}, {}", r.status, r.message);
  *options_.progress << line << time_left() << std::endl;
}

/// From the mean of the points that ran, as if all processes were always busy; a search may need
/// fewer points than it might.
std::string Runner::time_left() const {
  const std::size_t known = queue_.size() + running_.size() + ready_.size();
  const std::size_t more = may_follow ? may_follow() : 0;
  if (known + more == 0 || ran_ == 0) return "";
  const double mean = seconds_ / static_cast<double>(ran_);
  // The last points of a search follow each other, whatever the number of processes.
  const double rounds =
      std::ceil(static_cast<double>(known + more) / static_cast<double>(options_.jobs));
  return fmt::format("; {}{} to go, ETA {}", more ? "at most " : "", known + more,
                     duration(mean * rounds));
}

std::vector<Runner::Entry> Runner::entries() const {
  std::vector<Entry> out;
  for (const auto& k : known_) out.push_back({k->point, k->result.get()});
  return out;
}

}  // namespace fovea::points
