#include "sw/fovea/config/run_until.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "model/common/param.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

[[noreturn]] void refuse(const std::string& item, const std::string& why) {
  throw UserError(fmt::format("key 'run.until': '{}' {}; allowed: {}", one_line(item), why,
                              kEndConditionsAllowed));
}

std::string_view trim(std::string_view s) {
  constexpr std::string_view kBlank = " \t";
  const auto first = s.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string> items_of(const std::string& text) {
  std::string_view rest = trim(text);
  if (!rest.starts_with('[')) return {std::string(rest)};
  if (!rest.ends_with(']')) refuse(text, "lacks its closing bracket");
  rest = rest.substr(1, rest.size() - 2);
  std::vector<std::string> items;
  std::string item;
  bool quoted = false;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const char c = rest[i];
    if (quoted && c == '\\' && i + 1 < rest.size() && (rest[i + 1] == '"' || rest[i + 1] == '\\')) {
      // Escapes are kept here and replaced when the condition is parsed.
      item += c;
      item += rest[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      items.emplace_back(trim(item));
      item.clear();
    } else {
      item += c;
    }
  }
  if (quoted) refuse(text, "lacks its closing quotation mark");
  items.emplace_back(trim(item));
  return items;
}

std::optional<std::uint32_t> number(std::string_view text) {
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  if (hex) text.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hex ? 16 : 10);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The address of "0x8000", "main" or "main+0x10".
/// @param symbols null: a name is taken for one of the program's
std::uint32_t address_of(const std::string& item, std::string_view text, const Symbols* symbols) {
  if (const auto value = number(text)) return *value & ~1u;
  std::uint32_t offset = 0;
  if (const auto plus = text.rfind('+'); plus != std::string_view::npos) {
    const auto value = number(text.substr(plus + 1));
    if (!value) refuse(item, "has no number behind the '+'");
    offset = *value;
    text = text.substr(0, plus);
  }
  if (!symbols) return 0;
  const auto symbol = symbols->find(text);
  if (!symbol)
    refuse(item, fmt::format("names no symbol of the program or of --symbols ('{}')",
                             one_line(std::string(text))));
  return (*symbol + offset) & ~1u;
}

EndCondition condition_of(const std::string& item, const Symbols* symbols) {
  using Kind = EndCondition::Kind;
  EndCondition c;
  c.written = item;
  if (item.empty()) refuse(item, "is empty");
  const auto colon = item.find(':');
  const std::string word = item.substr(0, colon);
  const std::string value = colon == std::string::npos ? "" : item.substr(colon + 1);
  const bool alone = colon == std::string::npos;
  const std::pair<const char*, Kind> plain[] = {{"frames", Kind::kFrames},
                                                {"exit", Kind::kExit},
                                                {"halt", Kind::kHalt},
                                                {"reset", Kind::kReset}};
  for (const auto& [name, kind] : plain)
    if (word == name) {
      if (!alone) refuse(item, "has a value but takes none");
      c.kind = kind;
      return c;
    }
  if (word != "time" && word != "pc" && word != "uart") refuse(item, "is not a condition");
  if (value.empty()) refuse(item, "lacks its value");
  if (word == "time") {
    c.kind = Kind::kTime;
    c.time = parse_time("key 'run.until': time", std::string(trim(value)));
  } else if (word == "pc") {
    c.kind = Kind::kPc;
    c.address = address_of(item, trim(value), symbols);
  } else {
    c.kind = Kind::kUart;
    c.text = unescape("key 'run.until'", value);
  }
  return c;
}

}  // namespace

std::string Symbols::place(std::uint32_t address) const {
  const std::string name = describe(address);
  return fmt::format("0x{:08x}{}", address, name.empty() ? "" : " (" + name + ")");
}

std::vector<EndCondition> parse_run_until(const std::string& text, const Symbols& symbols) {
  std::vector<EndCondition> out;
  for (const auto& item : items_of(text)) out.push_back(condition_of(item, &symbols));
  return out;
}

void check_run_until(const std::string& text) {
  for (const auto& item : items_of(text)) condition_of(item, nullptr);
}

Picoseconds parse_time(const std::string& what, const std::string& text) {
  constexpr Picoseconds kMost = 1'000'000 * kPsPerSecond;
  ParamGroup group("limit");
  IntParam time(group, "time", IntParam::Unit::kTime, kPsPerSecond, 1, kMost, "", Origin::kChoice,
                "");
  try {
    time.set(text);
  } catch (const UserError& error) {
    throw UserError(fmt::format("{}: {}", what, error.what()));
  }
  return time();
}

std::string unescape(const std::string& what, std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      out += text[i];
      continue;
    }
    const char c = ++i < text.size() ? text[i] : '\0';
    switch (c) {
      case 'n': out += '\n'; break;
      case 'r': out += '\r'; break;
      case 't': out += '\t'; break;
      case '"': out += '"'; break;
      case '\\': out += '\\'; break;
      case 'x': {
        unsigned value = 0;
        const char* from = text.data() + i + 1;
        const bool there = i + 2 < text.size();
        if (!there || std::from_chars(from, from + 2, value, 16).ptr != from + 2)
          throw UserError(fmt::format("{}: '{}': \\x needs two hexadecimal digits", what,
                                      one_line(std::string(text))));
        out += static_cast<char>(value);
        i += 2;
        break;
      }
      default:
        throw UserError(fmt::format(
            "{}: '{}': unknown escape; allowed: \\n, \\r, \\t, \\\", \\\\ and \\xHH", what,
            one_line(std::string(text))));
    }
  }
  return out;
}

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\n': out += "\\n"; break;
      case '\r': out += "\\r"; break;
      case '\t': out += "\\t"; break;
      case '\\': out += "\\\\"; break;
      default:
        if (c < 0x20 || c == 0x7F)
          out += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
        else
          out += c;
    }
  }
  return out;
}

}  // namespace fovea::app
