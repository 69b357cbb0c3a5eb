#include "model/common/param.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "model/common/nearest.h"

namespace fovea {
namespace {

using Unit = IntParam::Unit;

struct Suffix {
  std::string_view text;
  std::uint64_t scale;
};

/// Largest unit first: format() uses the first one that divides the value.
const std::vector<Suffix>& suffixes(Unit unit) {
  static const std::vector<Suffix> count = {{"", 1}};
  static const std::vector<Suffix> cycles = {{"cycles", 1}};
  static const std::vector<Suffix> bytes = {
      {"GiB", 1ull << 30}, {"MiB", 1ull << 20}, {"KiB", 1ull << 10}, {"B", 1}};
  static const std::vector<Suffix> time = {
      {"s", kPsPerSecond}, {"ms", kPsPerMs}, {"us", kPsPerUs}, {"ns", kPsPerNs}, {"ps", 1}};
  static const std::vector<Suffix> hertz = {
      {"GHz", 1'000'000'000}, {"MHz", 1'000'000}, {"kHz", 1'000}, {"Hz", 1}};
  switch (unit) {
    case Unit::kCycles: return cycles;
    case Unit::kBytes: return bytes;
    case Unit::kTime: return time;
    case Unit::kHertz: return hertz;
    case Unit::kCount: break;
  }
  return count;
}

std::string_view trim(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

/// Splits "12.5 ns" into the text of the number and the text of the unit.
std::pair<std::string_view, std::string_view> split(std::string_view s) {
  s = trim(s);
  std::size_t i = 0;
  while (i < s.size() && (std::isdigit(static_cast<unsigned char>(s[i])) || s[i] == '.' ||
                          s[i] == '-' || s[i] == '+' ||
                          ((s[i] == 'e' || s[i] == 'E') && i + 1 < s.size() && i > 0 &&
                           (std::isdigit(static_cast<unsigned char>(s[i + 1])) ||
                            s[i + 1] == '-' || s[i + 1] == '+'))))
    ++i;
  return {s.substr(0, i), trim(s.substr(i))};
}

bool to_real(std::string_view s, double& out) {
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  auto [end, ec] = std::from_chars(s.data(), s.data() + s.size(), out);
  return ec == std::errc() && end == s.data() + s.size() && std::isfinite(out);
}

std::string real_text(double v) {
  std::array<char, 40> buffer{};
  auto [end, ec] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), v);
  return {buffer.data(), end};
}

std::string list_text(const std::vector<double>& v) {
  std::string out = "[";
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (i) out += ", ";
    out += real_text(v[i]);
  }
  out += ']';
  return out;
}

[[noreturn]] void refuse(std::string_view text, const std::string& allowed) {
  throw UserError("'" + std::string(text) + "' is not allowed; allowed: " + allowed);
}

/// The most frequent mistake is a number without its unit, which gets a sentence of its own.
[[noreturn]] void refuse_quantity(std::string_view text, const std::string& allowed,
                                  std::string_view unit, bool wants_unit) {
  refuse(text, allowed + (unit.empty() && wants_unit ? "; a number alone lacks its unit" : ""));
}

}  // namespace

std::string_view to_string(Origin origin) {
  switch (origin) {
    case Origin::kSourced: return "sourced";
    case Origin::kFamily: return "family";
    case Origin::kCalibrated: return "calibrated";
    case Origin::kAssumed: return "assumed";
    case Origin::kChoice: break;
  }
  return "choice";
}

ParamBase::ParamBase(ParamGroup& group, std::string name, std::string sentence, Origin origin,
                     std::string source, Belief belief)
    : key_(group.prefix().empty() ? name : group.prefix() + "." + name),
      sentence_(std::move(sentence)),
      source_(std::move(source)),
      belief_(std::move(belief)),
      origin_(origin) {
  group.params_.push_back(this);
}

void ParamBase::check_belief() {
  const bool needed = origin_ == Origin::kAssumed || origin_ == Origin::kFamily;
  FOVEA_CHECK(needed != belief_.empty(),
              key_ + (needed ? ": assumed and family figures need a belief interval"
                             : ": only assumed and family figures have a belief interval"));
  if (!needed) return;
  FOVEA_CHECK(!belief_.reason.empty(), key_ + ": the belief interval has no reason");
  const std::string own = text();
  const double rank_of_default = rank();
  const auto rank_of = [&](const std::string& end) {
    try {
      parse(end);
    } catch (const UserError& e) {
      FOVEA_CHECK(false, key_ + ": belief interval: " + e.what());
    }
    return rank();
  };
  const double low = rank_of(belief_.low);
  const double high = rank_of(belief_.high);
  parse(own);
  FOVEA_CHECK(low <= rank_of_default && rank_of_default <= high,
              key_ + ": the default lies outside its belief interval");
}

IntParam::IntParam(ParamGroup& group, std::string name, Unit unit, std::uint64_t def,
                   std::uint64_t min, std::uint64_t max, std::string sentence, Origin origin,
                   std::string source, Belief belief)
    : ParamBase(group, std::move(name), std::move(sentence), origin, std::move(source),
                std::move(belief)),
      unit_(unit), value_(def), default_(def), min_(min), max_(max) {
  FOVEA_CHECK(min <= def && def <= max, "default of " + key() + " out of its own range");
  check_belief();
}

std::string IntParam::format(std::uint64_t v) const {
  const auto& list = suffixes(unit_);
  for (const auto& s : list)
    if (v != 0 && v % s.scale == 0)
      return std::to_string(v / s.scale) + (unit_ == Unit::kCycles ? " " : "") +
             std::string(s.text);
  return "0" + std::string(unit_ == Unit::kCycles ? " " : "") + std::string(list.back().text);
}

std::string IntParam::unit() const {
  switch (unit_) {
    case Unit::kCycles: return "cycles";
    case Unit::kBytes: return "bytes";
    case Unit::kTime: return "time";
    case Unit::kHertz: return "frequency";
    case Unit::kCount: break;
  }
  return "count";
}

std::string IntParam::allowed() const {
  std::string units;
  for (const auto& s : suffixes(unit_))
    if (!s.text.empty()) units.append(units.empty() ? "" : " ").append(s.text);
  return format(min_) + " .. " + format(max_) + (units.empty() ? "" : " (unit: " + units + ")");
}

void IntParam::parse(std::string_view text) {
  const auto [number, unit] = split(text);
  for (const auto& s : suffixes(unit_)) {
    if (s.text != unit) continue;
    std::uint64_t whole = 0;
    auto [end, ec] = std::from_chars(number.data(), number.data() + number.size(), whole);
    std::uint64_t v = 0;
    if (ec == std::errc() && end == number.data() + number.size() &&
        whole <= ~std::uint64_t{0} / s.scale) {
      v = whole * s.scale;
    } else {
      double d = 0;
      if (!to_real(number, d) || d < 0 || d * static_cast<double>(s.scale) > 1.8e19) break;
      const double scaled = d * static_cast<double>(s.scale);
      const double rounded = std::round(scaled);
      // A fraction of the smallest unit cannot be represented: report it instead of rounding
      // silently.
      if (std::abs(scaled - rounded) > 1e-6 * std::max(1.0, scaled)) break;
      v = static_cast<std::uint64_t>(rounded);
    }
    if (v < min_ || v > max_) break;
    value_ = v;
    return;
  }
  refuse_quantity(text, allowed(), unit, unit_ != Unit::kCount);
}

RealParam::RealParam(ParamGroup& group, std::string name, std::string unit, double def, double min,
                     double max, std::string sentence, Origin origin, std::string source,
                     Belief belief)
    : ParamBase(group, std::move(name), std::move(sentence), origin, std::move(source),
                std::move(belief)),
      unit_(std::move(unit)), value_(def), default_(def), min_(min), max_(max) {
  check_belief();
}
std::string RealParam::text() const { return real_text(value_) + unit_; }
std::string RealParam::default_text() const { return real_text(default_) + unit_; }
std::string RealParam::allowed() const {
  return real_text(min_) + unit_ + " .. " + real_text(max_) + unit_;
}
void RealParam::parse(std::string_view text) {
  const auto [number, unit] = split(text);
  double v = 0;
  if (unit != unit_ || !to_real(number, v) || v < min_ || v > max_)
    refuse_quantity(text, allowed(), unit, !unit_.empty());
  value_ = v;
}

ListParam::ListParam(ParamGroup& group, std::string name, std::vector<double> def,
                     std::vector<std::size_t> sizes, std::string sentence, Origin origin,
                     std::string source)
    : ParamBase(group, std::move(name), std::move(sentence), origin, std::move(source)),
      value_(def), default_(std::move(def)), sizes_(std::move(sizes)) {
  check_belief();
}
std::string ListParam::text() const { return list_text(value_); }
std::string ListParam::default_text() const { return list_text(default_); }
std::string ListParam::allowed() const {
  std::string n;
  for (std::size_t i = 0; i < sizes_.size(); ++i)
    n.append(i ? " or " : "").append(std::to_string(sizes_[i]));
  return "a list of " + n + " plain numbers, [a, b, ...]";
}
void ListParam::parse(std::string_view text) {
  std::string_view s = trim(text);
  if (s.size() < 2 || s.front() != '[' || s.back() != ']') refuse(text, allowed());
  s = s.substr(1, s.size() - 2);
  std::vector<double> out;
  while (!trim(s).empty()) {
    const std::size_t comma = s.find(',');
    double v = 0;
    if (!to_real(trim(s.substr(0, comma)), v)) refuse(text, allowed());
    out.push_back(v);
    if (comma == std::string_view::npos) break;
    s.remove_prefix(comma + 1);
  }
  if (std::find(sizes_.begin(), sizes_.end(), out.size()) == sizes_.end()) refuse(text, allowed());
  value_ = std::move(out);
}

BoolParam::BoolParam(ParamGroup& group, std::string name, bool def, std::string sentence,
                     Origin origin, std::string source, Belief belief)
    : ParamBase(group, std::move(name), std::move(sentence), origin, std::move(source),
                std::move(belief)),
      value_(def), default_(def) {
  check_belief();
}
void BoolParam::parse(std::string_view text) {
  const auto s = trim(text);
  if (s != "true" && s != "false") refuse(text, allowed());
  value_ = s == "true";
}

EnumParam::EnumParam(ParamGroup& group, std::string name, std::string def,
                     std::vector<std::string> words, std::string sentence, Origin origin,
                     std::string source, Belief belief)
    : ParamBase(group, std::move(name), std::move(sentence), origin, std::move(source),
                std::move(belief)),
      value_(def), default_(std::move(def)), words_(std::move(words)) {
  check_belief();
}
std::size_t EnumParam::index() const {
  return static_cast<std::size_t>(std::find(words_.begin(), words_.end(), value_) -
                                  words_.begin());
}
std::string EnumParam::allowed() const {
  std::string out;
  for (const auto& w : words_) out.append(out.empty() ? "" : ", ").append(w);
  return out;
}
void EnumParam::parse(std::string_view text) {
  const std::string s(trim(text));
  if (std::find(words_.begin(), words_.end(), s) == words_.end()) refuse(text, allowed());
  value_ = s;
}

TextParam::TextParam(ParamGroup& group, std::string name, std::string def, std::string sentence,
                     std::string allowed)
    : ParamBase(group, std::move(name), std::move(sentence), Origin::kChoice, ""),
      value_(def), default_(std::move(def)), allowed_(std::move(allowed)) {}

void ParamSet::add(ParamGroup& group) {
  add_alone(group);
  for (ParamGroup* part : group.parts()) add(*part);
}

void ParamSet::add_alone(ParamGroup& group) {
  for (auto* p : group.params()) {
    FOVEA_CHECK(find(p->key()) == nullptr, "parameter declared twice: " + p->key());
    all_.push_back(p);
  }
}

ParamBase* ParamSet::find(std::string_view key) const {
  for (auto* p : all_)
    if (p->key() == key) return p;
  return nullptr;
}

namespace {

/// The keys that have this word, or words, between dots or at their beginning: `kernel`, `dcache`, `priority.edma`. The
/// shortest three; none of numbered copies.
std::vector<std::string> with_word(const std::vector<ParamBase*>& all, std::string_view word) {
  std::vector<std::string> out;
  if (word.size() < 3) return out;
  for (const auto* p : all) {
    const std::string key = "." + p->key();
    if (key.find("." + std::string(word)) == std::string::npos) continue;
    if (std::none_of(key.begin(), key.end() - 1, [&](const char& c) { return c == '.' && std::isdigit(*(&c + 1)); }))
      out.push_back(p->key());
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (out.size() > 3) out.resize(3);
  return out;
}

}  // namespace

std::string ParamSet::nearest(std::string_view key) const {
  std::string best;
  std::size_t best_distance = ~std::size_t{0};
  const auto consider = [&](const std::string& known) {
    std::size_t common = 0;
    for (std::size_t i = 0; i < std::min(key.size(), known.size()) && key[i] == known[i]; ++i)
      if (key[i] == '.') common = i + 1;
    const std::size_t d = edit_distance(key.substr(common), known.substr(common));
    if (d >= best_distance || d > std::max<std::size_t>(2, (key.size() - common) / 3)) return;
    best_distance = d;
    best = known;
  };
  for (const auto* p : all_) consider(p->key());
  for (const auto& [known, hint] : foreign_) consider(known);
  return best;
}

void ParamSet::set(std::string_view key, std::string_view text) {
  ParamBase* p = find(key);
  if (!p) {
    const std::string near = nearest(key);
    const auto foreign = foreign_.find(near);
    if (foreign != foreign_.end() && near == key) throw UserError("key '" + near + "' " + foreign->second);
    std::string hint = near.empty() ? "; 'fovea params' lists all keys"
                                    : "; did you mean '" + near + "'?";
    if (const auto words = with_word(all_, key); !words.empty()) {
      hint = "; did you mean ";
      for (std::size_t i = 0; i < words.size(); ++i)
        hint += (i == 0 ? "'" : i + 1 < words.size() ? ", '" : " or '") + words[i] + "'";
      hint += "?";
    } else if (foreign != foreign_.end()) {
      hint = "; did you mean '" + near + "'? It " + foreign->second;
    }
    throw UserError("unknown key '" + std::string(key) + "'" + hint);
  }
  try {
    p->set(text);
  } catch (const UserError& e) {
    throw UserError("key '" + p->key() + "': " + e.what());
  }
}

}  // namespace fovea
