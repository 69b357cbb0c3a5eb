#include "sw/fovea/console/dialogue.h"

#include <fmt/format.h>

#include "model/common/check.h"
#include "sw/fovea/config/run_until.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {

Dialogue Dialogue::load(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = 16u << 20;
  return parse(one_line(file.string()), read_file(file, kMaxBytes));
}

Dialogue Dialogue::parse(const std::string& name, const std::string& text) {
  Dialogue d;
  d.name_ = name;
  unsigned number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || line.starts_with('#')) continue;
    const std::size_t blank = line.find(' ');
    const std::string word = line.substr(0, blank);
    const std::string value = blank == std::string::npos ? "" : line.substr(blank + 1);
    const std::string where = fmt::format("{}:{}", name, number);
    Step step;
    step.line = number;
    step.written = line;
    if (word != "wait" && word != "send" && word != "at")
      throw UserError(fmt::format("{}: '{}' is not a step; allowed: wait TEXT, send TEXT, at TIME",
                                  where, one_line(word)));
    if (value.empty()) throw UserError(fmt::format("{}: '{}' lacks its value", where, word));
    if (word == "at") {
      step.kind = Step::Kind::kAt;
      step.time = parse_time(where, value);
    } else {
      step.kind = word == "wait" ? Step::Kind::kWait : Step::Kind::kSend;
      step.text = unescape(where, value);
    }
    d.steps_.push_back(std::move(step));
  }
  return d;
}

void Dialogue::next_step() {
  ++at_;
  sent_ = 0;
  received_.clear();
}

void Dialogue::received(std::uint8_t byte) {
  if (over() || steps_[at_].kind != Step::Kind::kWait) return;
  const std::string& wanted = steps_[at_].text;
  received_ += static_cast<char>(byte);
  if (received_.size() > wanted.size()) received_.erase(0, 1);
  if (received_ == wanted) next_step();
}

std::optional<std::uint8_t> Dialogue::next(Picoseconds now) {
  while (!over()) {
    const Step& step = steps_[at_];
    if (step.kind == Step::Kind::kWait) return std::nullopt;
    if (step.kind == Step::Kind::kAt) {
      if (now < step.time) return std::nullopt;
      next_step();
      continue;
    }
    const auto byte = static_cast<std::uint8_t>(step.text[sent_]);
    if (++sent_ == step.text.size()) next_step();
    return byte;
  }
  return std::nullopt;
}

std::optional<Picoseconds> Dialogue::waits_until() const {
  if (over() || steps_[at_].kind != Step::Kind::kAt) return std::nullopt;
  return steps_[at_].time;
}

std::string Dialogue::position() const {
  if (over()) return "";
  return fmt::format("{}:{}: {}", name_, steps_[at_].line, one_line(steps_[at_].written));
}

std::string dialogue_lines(Picoseconds at, const std::string& typed) {
  return fmt::format("at {}ps\nsend {}\n", at, escape(typed));
}

}  // namespace fovea::app
