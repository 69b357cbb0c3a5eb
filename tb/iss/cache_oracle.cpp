#include "tb/iss/cache_oracle.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace fovea::cpu::test {

OracleCache::Line* OracleCache::find(std::uint32_t mva) {
  for (Line& line : sets[mva / 32 % sets.size()])
    if (line.valid && line.mva == mva / 32 * 32) return &line;
  return nullptr;
}

OracleCache::Line& OracleCache::victim(std::uint32_t mva) {
  auto& ways = sets[mva / 32 % sets.size()];
  const auto free = [this](unsigned way) { return (locked >> way) % 2 == 0; };
  for (unsigned way = 0; way < 4; ++way)
    if (!ways[way].valid && free(way)) return ways[way];
  while (!free(next_way)) next_way = (next_way + 1) % 4;
  Line& line = ways[next_way];
  next_way = (next_way + 1) % 4;
  return line;
}

CacheOracle::CacheOracle(std::uint32_t base, std::vector<std::uint8_t> memory,
                         std::function<Page(std::uint32_t)> pages, unsigned icache, unsigned dcache)
    : base_(base),
      memory_(std::move(memory)),
      pages_(std::move(pages)),
      icache_(icache),
      dcache_(dcache) {}

/// Halves that differ from memory go there; the line stays.
void CacheOracle::clean(OracleCache::Line& line) {
  const bool low = line.dirty[0], high = line.dirty[1];
  if (!line.valid || (!low && !high)) return;
  const unsigned from = low ? 0 : 16, to = high ? 32 : 16;
  const std::vector<std::uint8_t> data(line.bytes.begin() + from, line.bytes.begin() + to);
  std::copy(data.begin(), data.end(), at(line.pa + from));
  traffic_.write_backs.push_back({line.pa + from, data});
  line.dirty[0] = line.dirty[1] = false;
  ++counts_.dcache_writebacks;
}

OracleCache::Line& CacheOracle::fill(OracleCache& cache, std::uint32_t mva, std::uint32_t pa) {
  OracleCache::Line& line = cache.victim(mva);
  clean(line);
  line.valid = true;
  line.mva = mva / 32 * 32;
  line.pa = pa / 32 * 32;
  std::copy_n(at(line.pa), 32, line.bytes.begin());
  Transfer read{pa / 4 * 4, copy(line.pa, 32)};
  if (&cache == &icache_) {
    ++counts_.icache_fills;
    traffic_.instruction_fills.push_back(std::move(read));
  } else {
    ++counts_.dcache_fills;
    traffic_.data_fills.push_back(std::move(read));
    // A counter that goes on too far, once in a while.
    if (fault == Fault::kVictimOneOff && counts_.dcache_fills % 64 == 0) ++cache.next_way;
    cache.next_way %= 4;
  }
  return line;
}

/// What follows is not behind the last instruction fetched here.
void CacheOracle::end_run() {
  if (run_end_ && run_cached_) (run_thumb_ ? half_words_ : words_) += run_thumb_ ? 3 : 2;
  run_end_.reset();
}

std::uint32_t CacheOracle::fetch(std::uint32_t mva, bool thumb) {
  const std::uint32_t word = mva / 4 * 4;
  const Page page = mmu() ? pages_(word) : Page{word, true, true};
  if (run_end_ && (*run_end_ != mva || run_thumb_ != thumb)) end_run();
  run_end_ = mva + (thumb ? 2 : 4);
  run_thumb_ = thumb;
  run_cached_ = page.cacheable && (control >> 12 & 1u);
  std::uint32_t out = 0;
  const std::uint8_t* from = at(page.pa);
  if (page.cacheable && (control >> 12 & 1u)) {
    (thumb ? half_words_ : words_) += 1;
    if (fetch_line_ != mva / 32) ++line_changes_;
    fetch_line_ = mva / 32;
    OracleCache::Line* line = icache_.find(word);
    if (!line) line = &fill(icache_, word, page.pa);
    from = line->bytes.data() + word % 32;
  } else {
    fetch_line_.reset();
  }
  for (unsigned k = 0; k < 4; ++k) out |= std::uint32_t{from[k]} << (8 * k);
  return out;
}

std::uint32_t CacheOracle::load(std::uint32_t mva, unsigned bytes) {
  const Page page = mmu() ? pages_(mva) : Page{mva, false, false};
  const std::uint8_t* from = at(page.pa);
  if (data_cached(page)) {
    ++counts_.dcache_reads;
    OracleCache::Line* line = dcache_.find(mva);
    if (!line) line = &fill(dcache_, mva, page.pa);
    from = line->bytes.data() + mva % 32;
  } else {
    traffic_.reads.push_back({page.pa, copy(page.pa, bytes)});
  }
  std::uint32_t out = 0;
  for (unsigned k = 0; k < bytes; ++k) out |= std::uint32_t{from[k]} << (8 * k);
  return out;
}

/// To memory through the write buffer, in bursts of eight, four or one word; none crosses 1 KB.
void CacheOracle::send(std::uint32_t pa, const std::vector<std::uint8_t>& bytes) {
  std::copy(bytes.begin(), bytes.end(), at(pa));
  for (std::size_t k = 0; k < bytes.size();) {
    const auto here = static_cast<std::uint32_t>(pa + k);
    std::size_t n = std::min<std::size_t>(bytes.size() - k, 1024 - here % 1024);
    n = n >= 32 ? 32 : n >= 16 ? 16 : std::min<std::size_t>(n, 4);
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(k);
    traffic_.buffered.push_back({here, {first, first + static_cast<std::ptrdiff_t>(n)}});
    k += n;
  }
}

void CacheOracle::store(std::uint32_t mva, unsigned bytes,
                        const std::vector<std::uint32_t>& values) {
  std::uint32_t begin = 0;  // what waits to be sent together
  std::vector<std::uint8_t> together;
  const auto flush = [&] {
    if (!together.empty()) send(begin, together);
    together.clear();
  };
  for (const std::uint32_t value : values) {
    std::vector<std::uint8_t> data;
    for (unsigned k = 0; k < bytes; ++k) data.push_back(static_cast<std::uint8_t>(value >> 8 * k));
    const Page page = mmu() ? pages_(mva) : Page{mva, false, false};
    bool to_buffer = page.bufferable && mmu();
    if (data_cached(page)) {
      ++counts_.dcache_writes;
      OracleCache::Line* line = dcache_.find(mva);
      if (!line) ++counts_.dcache_write_misses;
      if (!line && fault == Fault::kWriteAllocates && counts_.dcache_write_misses % 64 == 0)
        line = &fill(dcache_, mva, page.pa);
      const bool keeps = line && page.bufferable && !(cache_debug & 4u);
      if (line) std::copy(data.begin(), data.end(), line->bytes.begin() + mva % 32);
      if (keeps && !(fault == Fault::kDirtyHalfLost && counts_.dcache_writes % 64 == 0))
        line->dirty[mva % 32 / 16] = true;
      to_buffer = !keeps;
      if (keeps) {
        flush();
        mva += bytes;
        continue;
      }
    }
    if (to_buffer) {
      if (!together.empty() && page.pa != begin + together.size()) flush();
      if (together.empty()) begin = page.pa;
      together.insert(together.end(), data.begin(), data.end());
    } else {
      flush();
      std::copy(data.begin(), data.end(), at(page.pa));
      traffic_.unbuffered.push_back({page.pa, data});
    }
    mva += bytes;
  }
  flush();
}

bool CacheOracle::test_and_clean(bool invalidate) {
  ++operations_;
  for (auto& set : dcache_.sets)
    for (auto& line : set)
      if (line.valid && (line.dirty[0] || line.dirty[1])) {
        clean(line);
        return false;
      }
  if (invalidate) operate(6, 0, 0);
  return true;
}

bool CacheOracle::operate(unsigned crm, unsigned op2, std::uint32_t value) {
  ++operations_;
  const bool instruction = crm == 5;
  OracleCache& cache = instruction ? icache_ : dcache_;
  const auto drop = [](OracleCache::Line* line) {
    if (line) line->valid = line->dirty[0] = line->dirty[1] = false;
  };
  const auto drop_all = [&](OracleCache& c) {
    for (auto& set : c.sets)
      for (auto& line : set) drop(&line);
  };
  // A line by address or by set and way; the way is in the top bits.
  const auto chosen = [&]() -> OracleCache::Line* {
    if (op2 == 1) return cache.find(value);
    return &cache.at(value / 32 % cache.sets.size(), value >> 30);
  };
  // What has no line is no reason to look anything up.
  if (crm == 5 || crm == 13 || crm == 7) fetch_line_.reset();
  if (crm == 10 && op2 == 4) return true;  // drain: of no effect on what is stored where
  if ((crm == 5 || crm == 6) && op2 == 0) {
    drop_all(cache);
  } else if (crm == 7 && op2 == 0) {
    drop_all(icache_);
    drop_all(dcache_);
  } else if ((crm == 5 || crm == 6) && op2 <= 2) {
    OracleCache::Line* line = chosen();
    if (line && line->valid && ++invalidates_ % 8 == 0 && fault == Fault::kInvalidateMissed)
      return true;
    drop(line);
  } else if ((crm == 10 || crm == 14) && (op2 == 1 || op2 == 2)) {
    OracleCache::Line* line = chosen();
    if (line) clean(*line);
    if (crm == 14) drop(line);
  } else if (crm == 13 && op2 == 1) {
    const std::uint32_t mva = value / 32 * 32;
    const Page page = pages_(mva);
    if ((control >> 12 & 1u) && page.cacheable && !icache_.find(mva)) fill(icache_, mva, page.pa);
  } else {
    return false;
  }
  return true;
}

namespace {

std::string text(const Transfer& t) {
  std::ostringstream out;
  out << t.data.size() << " bytes at 0x" << std::hex << t.address << ':';
  for (const unsigned byte : t.data) out << ' ' << byte;
  return out.str();
}

std::string compare(const char* what, const std::vector<Transfer>& expected,
                    const std::vector<Transfer>& seen) {
  for (std::size_t k = 0; k < std::max(expected.size(), seen.size()); ++k) {
    if (k < expected.size() && k < seen.size() && expected[k] == seen[k]) continue;
    return std::string(what) + " " + std::to_string(k) + ": expected " +
           (k < expected.size() ? text(expected[k]) : "none") + ", seen " +
           (k < seen.size() ? text(seen[k]) : "none");
  }
  return {};
}

}  // namespace

std::string difference(const Traffic& expected, const Traffic& seen) {
  for (const auto& out :
       {compare("instruction fill", expected.instruction_fills, seen.instruction_fills),
        compare("data fill", expected.data_fills, seen.data_fills),
        compare("read", expected.reads, seen.reads),
        compare("unbuffered write", expected.unbuffered, seen.unbuffered)})
    if (!out.empty()) return out;
  // Two buffers share the bus: each write must be the next of one of them. Where both would write
  // the same, both ways are followed: so many of the writes so far were write-backs.
  std::set<std::size_t> ways = {0};
  for (std::size_t k = 0; k < seen.buffered.size(); ++k) {
    std::set<std::size_t> next;
    for (const std::size_t v : ways) {
      const std::size_t m = k - v;
      if (v < expected.write_backs.size() && seen.buffered[k] == expected.write_backs[v])
        next.insert(v + 1);
      if (m < expected.buffered.size() && seen.buffered[k] == expected.buffered[m]) next.insert(v);
    }
    if (next.empty()) {
      const std::size_t v = *ways.begin(), m = k - v;
      return "write " + std::to_string(k) + ": expected " +
             (v < expected.write_backs.size() ? text(expected.write_backs[v]) : "none") + " or " +
             (m < expected.buffered.size() ? text(expected.buffered[m]) : "none") + ", seen " +
             text(seen.buffered[k]);
    }
    ways = std::move(next);
  }
  if (!ways.contains(expected.write_backs.size()) ||
      seen.buffered.size() != expected.write_backs.size() + expected.buffered.size())
    return "expected " + std::to_string(expected.write_backs.size()) + " write-backs and " +
           std::to_string(expected.buffered.size()) + " other buffered writes, seen " +
           std::to_string(seen.buffered.size()) + " in all";
  return {};
}

}  // namespace fovea::cpu::test
