#include "sw/fovea/tools/profile_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "sw/fovea/program/code_places.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {
namespace {

using cpu::ProfileRow;
// Issue, sleeps, stalls; the last places may belong to no cause.
constexpr std::size_t kMostColumns = ProfileRow::kStall + cpu::kCauses;
std::size_t columns() { return ProfileRow::kStall + cpu::kCauseTable.size(); }

std::string cause_text(std::size_t cause) {
  if (cause == ProfileRow::kIssue) return "issue";
  if (cause < ProfileRow::kWait)
    return std::string("idle.") + cpu::kWakeTable[cause - ProfileRow::kIdle].name;
  if (cause < ProfileRow::kStall)
    return std::string("wait.") + cpu::kWakeTable[cause - ProfileRow::kWait].name;
  return cpu::cause_name(static_cast<cpu::Cause>(cause - ProfileRow::kStall));
}

/// Clocks by cause, and instructions.
struct Sums {
  std::array<std::uint64_t, kMostColumns> by_cause{};
  std::uint64_t instructions = 0;
  std::uint64_t clocks() const {
    std::uint64_t n = 0;
    for (const std::uint64_t c : by_cause) n += c;
    return n;
  }
  void add(const ProfileRow& r) {
    by_cause[r.cause] += r.clocks;
    instructions += r.instructions;
  }
};

template <class Key>
using SumsBy = std::map<Key, Sums>;

/// The window's sums by what key(address) says.
template <class F>
auto window_sums(const ProfileData& data, F key) {
  SumsBy<decltype(key(std::uint32_t{}))> out;
  for (const ProfilePhase& p : data.phases)
    if (p.window)
      for (const ProfileRow& r : p.rows) out[key(r.address)].add(r);
  return out;
}

/// Entries with clocks, most first; equal ones by name.
template <class Key>
std::vector<std::pair<Key, Sums>> ranked(const SumsBy<Key>& sums) {
  std::vector<std::pair<Key, Sums>> out;
  for (const auto& entry : sums)
    if (entry.second.clocks()) out.push_back(entry);
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.second.clocks() > b.second.clocks(); });
  return out;
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// "issue 61 %, dcache 30 %": the causes with at least 5 %, most first.
std::string causes_text(const Sums& s) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t k = 0; k < columns(); ++k) order.emplace_back(s.by_cause[k], k);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string out;
  for (const auto& [n, k] : order)
    if (percent(n, s.clocks()) >= 5)
      out += fmt::format("{}{} {:.0f} %", out.empty() ? "" : ", ", cause_text(k),
                         percent(n, s.clocks()));
  return out;
}

constexpr const char* kHeads = "  share      clocks  instructions  where";

std::string line_of(const Sums& s, std::uint64_t all, const std::string& where) {
  return fmt::format("{:5.1f} %  {:>10}  {:>12}  {}: {}\n", percent(s.clocks(), all), s.clocks(),
                     s.instructions, where, causes_text(s));
}

std::uint64_t window_clocks(const ProfileData& data) {
  std::uint64_t n = 0;
  for (const ProfilePhase& p : data.phases)
    if (p.window)
      for (const ProfileRow& r : p.rows) n += r.clocks;
  return n;
}

std::string place(const SourceFrame& f) {
  return f.file.empty() ? f.function : fmt::format("{} ({}:{})", f.function, f.file, f.line);
}

std::string functions_text(const ProfileData& data, SourceLines& lines, std::size_t most,
                           double least) {
  const std::uint64_t all = window_clocks(data);
  const auto order = ranked(window_sums(data, [&](std::uint32_t a) {
    const SourceFrame& f = lines.at(a).front();
    return f.file.empty() ? f.function : fmt::format("{} ({})", f.function, f.file);
  }));
  std::string out;
  std::size_t shown = 0;
  for (const auto& [name, sums] : order) {
    if (shown == most || percent(sums.clocks(), all) < least) break;
    out += line_of(sums, all, name);
    ++shown;
  }
  if (order.size() > shown) out += fmt::format("         and {} more\n", order.size() - shown);
  return out;
}

/// "function|file", as in a path of paths.csv.
std::string path_element(const SourceFrame& f) {
  std::string text = f.function + "|" + f.file;
  std::replace(text.begin(), text.end(), ';', ',');
  return text;
}

/// The functions that hold the innermost one at an address, outermost first.
std::string holders_of(std::uint32_t address, SourceLines& lines) {
  const auto& frames = lines.at(address);
  std::string out;
  for (std::size_t k = frames.size(); k-- > 1;) out += (out.empty() ? "" : ";") + path_element(frames[k]);
  return out;
}

/// Clocks by call path. `name(function)` is the text of one of its functions.
template <class F>
std::map<std::string, std::uint64_t> clocks_by_path(const ProfileStacks& stacks, F name) {
  // Of each path how deep it is, and the last one of the paths to it that is shown as it is.
  std::vector<std::uint32_t> depth(stacks.size()), shown(stacks.size());
  // Equal texts are added up before they are made. The second of the pair: the function behind a gap.
  std::map<std::pair<std::uint32_t, std::optional<std::uint32_t>>, std::uint64_t> sums;
  for (std::uint32_t n = 0; n < stacks.size(); ++n) {
    const auto& s = stacks[n];
    if (n > 0) depth[n] = depth[s.caller] + 1;
    shown[n] = depth[n] <= kShownDepth ? n : shown[s.caller];
    if (s.clocks) sums[{shown[n], shown[n] == n ? std::nullopt : std::optional(s.function)}] += s.clocks;
  }
  std::map<std::string, std::uint64_t> out;
  for (const auto& [key, clocks] : sums) {
    std::vector<std::uint32_t> functions;
    for (std::uint32_t n = key.first; n; n = stacks[n].caller) functions.push_back(stacks[n].function);
    std::string text;
    for (auto f = functions.rbegin(); f != functions.rend(); ++f) text += (text.empty() ? "" : ";") + name(*f);
    if (key.second) text += ";...;" + name(*key.second);
    out[text] += clocks;
  }
  return out;
}

/// The name of a function in a stack; a semicolon would begin another one.
std::string stack_name(std::uint32_t address, SourceLines& lines) {
  std::string name = lines.function_text(address);
  std::replace(name.begin(), name.end(), ';', ',');
  return name;
}

}  // namespace

std::vector<cpu::CallStacks::Function> program_functions(std::span<const ElfImage* const> programs) {
  std::map<std::uint32_t, std::uint32_t> ends;  // by beginning
  const auto covered = [&](std::uint32_t a) {
    const auto above = ends.upper_bound(a);
    return above != ends.begin() && a < std::prev(above)->second;
  };
  for (const ElfImage* const image : programs) {
    if (!image) continue;
    std::vector<const ElfSymbol*> labels;
    for (const ElfSymbol& s : image->symbols()) {
      if (!s.function) continue;
      if (s.size == 0) labels.push_back(&s);
      else if (!covered(s.address)) ends[s.address] = s.address + s.size;
    }
    for (std::size_t k = 0; k < labels.size(); ++k) {
      const std::uint32_t begin = labels[k]->address;
      if (covered(begin)) continue;
      std::uint32_t end = begin;
      for (const ElfSegment& s : image->segments())
        if (begin - s.virtual_address < s.memory_size) end = s.virtual_address + s.memory_size;
      if (const auto next = ends.upper_bound(begin); next != ends.end())
        end = std::min(end, next->first);
      for (std::size_t n = k + 1; n < labels.size(); ++n)
        if (labels[n]->address > begin) {
          end = std::min(end, labels[n]->address);
          break;
        }
      ends[begin] = end;
    }
  }
  std::vector<cpu::CallStacks::Function> out;
  for (const auto& [begin, end] : ends) {
    if (!out.empty() && out.back().end > begin) out.back().end = begin;
    out.push_back({begin, end});
  }
  return out;
}

std::string profile_csv(const ProfileData& data, SourceLines& lines, const PollLoops& polls) {
  std::string out = "phase,function,file,line,cause,region,culprit,clocks,instructions,inlined_in,polls\n";
  struct Key {
    SourceFrame frame;
    std::string holders;
    bool polls;
    std::uint8_t cause, region, culprit;
    auto flat() const {
      return std::tie(frame.function, frame.file, frame.line, cause, region, culprit, holders, polls);
    }
    bool operator<(const Key& other) const { return flat() < other.flat(); }
  };
  for (const ProfilePhase& phase : data.phases) {
    std::map<Key, std::pair<std::uint64_t, std::uint64_t>> sums;
    for (const ProfileRow& r : phase.rows) {
      auto& s = sums[{lines.at(r.address).front(), holders_of(r.address, lines), polls.contains(r.address), r.cause,
                      r.region, r.culprit}];
      s.first += r.clocks;
      s.second += r.instructions;
    }
    for (const auto& [key, sum] : sums) {
      if (sum.first == 0) continue;
      const bool stalled = key.cause >= ProfileRow::kStall;
      out += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(phase.name), csv_field(key.frame.function),
                         csv_field(key.frame.file), key.frame.line ? std::to_string(key.frame.line) : "",
                         cause_text(key.cause), stalled ? csv_field(data.regions.at(key.region)) : "",
                         stalled ? csv_field(std::string(cpu::stall_culprit_name(key.culprit))) : "", sum.first,
                         sum.second, csv_field(key.holders), key.polls ? "1" : "");
    }
  }
  return out;
}

std::string paths_csv(const ProfileData& data, SourceLines& lines) {
  std::string out = "phase,path,clocks\n";
  for (const ProfilePhase& phase : data.phases) {
    const auto name = [&](std::uint32_t f) { return path_element(lines.at(f).back()); };
    for (const auto& [path, clocks] : clocks_by_path(phase.stacks, name))
      out += fmt::format("{},{},{}\n", csv_field(phase.name), csv_field(path), clocks);
  }
  return out;
}

std::string objects_csv(std::span<const ElfImage* const> programs) {
  std::string out = "object,address,size\n";
  for (const ElfImage* const image : programs) {
    if (!image) continue;
    for (const ElfSymbol& s : image->symbols())
      if (!s.function && s.size >= kObjectBytes)
        out += fmt::format("{},0x{:08x},{}\n", csv_field(s.text()), s.address, s.size);
  }
  return out;
}

std::string functions_csv(const ProfileData& data, SourceLines& lines,
                          std::span<const ElfImage* const> programs) {
  // By function and file, the functions that hold its code, by address.
  using Homes = std::map<std::uint32_t, std::pair<const ElfImage*, const ElfSymbol*>>;
  std::map<std::pair<std::string, std::string>, Homes> places;
  for (const ProfilePhase& phase : data.phases)
    for (const ProfileRow& r : phase.rows) {
      if (r.clocks == 0) continue;
      const auto home = lines.function_at(r.address);
      const SourceFrame& f = lines.at(r.address).front();
      if (home.second) places[{f.function, f.file}][home.second->address] = home;
    }
  std::map<std::uint32_t, std::uint32_t> ends;  // labels have no size
  for (const auto& f : program_functions(programs)) ends[f.begin] = f.end;
  std::string out = "function,file,address,size,code\n";
  std::map<const ElfSymbol*, std::string> hashes;
  for (const auto& [function, homes] : places)
    for (const auto& [address, home] : homes) {
      const auto end = ends.find(address);
      const std::uint32_t size = end == ends.end() ? home.second->size : end->second - address;
      std::string& hash = hashes[home.second];
      if (hash.empty()) hash = code_hash(*home.first, address, size, home.second->thumb);
      out += fmt::format("{},{},0x{:08x},{},{}\n", csv_field(function.first), csv_field(function.second),
                         address, size, hash);
    }
  for (const ElfImage* const image : programs) {
    if (!image) continue;
    std::uint64_t bytes = 0;
    for (const ElfSymbol& s : image->symbols())
      if (!s.function) bytes += s.size;
    out += fmt::format("(data),,,{},{}\n", bytes, data_hash(*image));
  }
  return out;
}

std::string profile_callgrind(const ProfileData& data, SourceLines& lines) {
  std::string out = fmt::format(
      "# callgrind format\nversion: 1\ncreator: fovea\ncmd: {}\npositions: instr line\n",
      data.program);
  out += "event: Clocks : core clocks\nevents: Clocks Instructions";
  for (std::size_t k = 0; k < columns(); ++k) {
    std::string name = cause_text(k);
    name[0] = static_cast<char>(name[0] - 'a' + 'A');
    std::replace(name.begin(), name.end(), '.', '_');
    out += " " + name;
  }
  const auto numbers = [](const Sums& s) {
    std::string text = fmt::format("{} {}", s.clocks(), s.instructions);
    for (std::size_t k = 0; k < columns(); ++k) text += fmt::format(" {}", s.by_cause[k]);
    return text;
  };
  const auto by_address = window_sums(data, [](std::uint32_t a) { return a; });
  Sums all;
  for (const ProfilePhase& p : data.phases)
    if (p.window)
      for (const ProfileRow& r : p.rows) all.add(r);
  out += "\nsummary: " + numbers(all) + "\n";
  // Functions in the order of their addresses; a call's costs follow the instruction that calls.
  std::map<std::uint32_t, std::vector<const ProfileCall*>> calls;
  for (const ProfileCall& c : data.calls) calls[c.from].push_back(&c);
  std::string function, file;
  const auto head = [&](const SourceFrame& f) {
    const std::string of = f.file.empty() ? "(unknown)" : f.file;
    if (f.function == function && of == file) return;
    function = f.function;
    file = of;
    out += fmt::format("\nfl={}\nfn={}\n", file, function);
  };
  for (const auto& [address, sums] : by_address) {
    const SourceFrame& f = lines.at(address).front();
    head(f);
    out += fmt::format("0x{:x} {} {}\n", address, f.line, numbers(sums));
    for (const ProfileCall* c : calls[address]) {
      const SourceFrame& to = lines.at(c->to).back();
      out += fmt::format("cfi={}\ncfn={}\ncalls={} 0x{:x} {}\n0x{:x} {} {}\n",
                         to.file.empty() ? "(unknown)" : to.file, to.function, c->count, c->to, to.line,
                         address, f.line, c->clocks);
    }
  }
  return out;
}

std::string profile_folded(const ProfileData& data, SourceLines& lines) {
  std::string out;
  for (const auto& [names, clocks] : clocks_by_path(data.stacks, [&](std::uint32_t f) { return stack_name(f, lines); }))
    out += fmt::format("{} {}\n", names.empty() ? "(unknown)" : names, clocks);
  return out;
}

std::string interrupts_csv(const ProfileData& data) {
  std::string out = "interrupt,count,mean_ns,p99_ns,max_ns\n";
  for (const auto& [name, unsorted] : data.interrupts) {
    std::vector<Picoseconds> times = unsorted;
    std::sort(times.begin(), times.end());
    Picoseconds sum = 0;
    for (const Picoseconds t : times) sum += t;
    out += fmt::format("{},{},{},{},{}\n", csv_field(name), times.size(), ns_text(sum / times.size()),
                       ns_text(times[(times.size() * 99 + 99) / 100 - 1]), ns_text(times.back()));
  }
  return out;
}

std::string profile_table(const ProfileData& data, SourceLines& lines, std::size_t functions) {
  const std::uint64_t all = window_clocks(data);
  if (all == 0) return "";
  return fmt::format("{}\n{}", kHeads, functions_text(data, lines, functions, 0.1));
}

std::string profile_text(const ProfileData& data, SourceLines& lines) {
  const std::uint64_t all = window_clocks(data);
  std::string out = "Core clocks of the run by phase:\n";
  for (const ProfilePhase& p : data.phases) {
    Sums sums;
    for (const ProfileRow& r : p.rows) sums.add(r);
    if (sums.clocks())
      out += fmt::format("  {:<8} {:>13}{}  {}\n", p.name, sums.clocks(),
                         p.window ? " (the measured window)" : "", causes_text(sums));
  }
  out += fmt::format("\nFunctions of the window; an inlined function counts for itself:\n{}\n{}",
                     kHeads, functions_text(data, lines, ~std::size_t{0}, 0.01));
  if (!data.ranges.empty()) {
    out += "\nStacks, by the values of the stack pointer at calls and returns:\n";
    for (const auto& r : data.ranges)
      out += fmt::format("  0x{:08x} down to 0x{:08x}: {} bytes, begun in {}\n", r.base, r.low,
                         r.base - r.low, lines.function_text(r.function));
  }
  if (data.masked.clocks)
    out += fmt::format("\nLongest stretch with IRQs masked, without sleep: {} clocks, from 0x{:08x} {} "
                       "to 0x{:08x} {}\n",
                       data.masked.clocks, data.masked.begin, place(lines.at(data.masked.begin).front()),
                       data.masked.end, place(lines.at(data.masked.end).front()));
  const auto ranking = [&](const char* title, const auto& order) {
    constexpr std::size_t kMost = 40;
    out += fmt::format("\n{}\n{}\n", title, kHeads);
    for (std::size_t k = 0; k < std::min(kMost, order.size()); ++k)
      out += line_of(order[k].second, all, order[k].first);
    if (order.size() > kMost) out += fmt::format("         and {} more\n", order.size() - kMost);
  };
  ranking("Source lines of the window:", ranked(window_sums(data, [&](std::uint32_t a) {
            return place(lines.at(a).front());
          })));
  ranking("Instructions of the window:", ranked(window_sums(data, [&](std::uint32_t a) {
            return fmt::format("0x{:08x} {}", a, place(lines.at(a).front()));
          })));
  return out;
}

ToolOutput profile_result(const ProfileData& data, std::span<const ElfImage* const> programs) {
  SourceLines lines;
  for (const ElfImage* const p : programs)
    if (p) lines.add(*p);
  constexpr std::size_t kFunctions = 12;
  ToolOutput out;
  out.table = profile_table(data, lines, kFunctions);
  if (!lines.have_lines())
    out.table += "  the program has no debug information: the profile knows functions, but no lines\n";
  out.files = {{"profile.csv", profile_csv(data, lines, PollLoops(programs))},
               {"paths.csv", paths_csv(data, lines)},
               {"objects.csv", objects_csv(programs)},
               {"profile.folded", profile_folded(data, lines)},
               {"profile.callgrind", profile_callgrind(data, lines)},
               {"profile.txt", profile_text(data, lines)},
               {"interrupts.csv", interrupts_csv(data)},
               {"functions.csv", functions_csv(data, lines, programs)}};
  return out;
}

}  // namespace fovea::app
