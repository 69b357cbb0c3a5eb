#include "model/bus/load_generator.h"

#include <algorithm>

#include "model/contract/memory_map.h"

namespace fovea::bus {
namespace {

constexpr unsigned kSlots = 16;  // LoadParams::outstanding
constexpr Picoseconds kPause = 10 * kPsPerUs;  // after an error, or while the SDRAM is set up
constexpr std::uint32_t kSdram = DDR_BASE, kInternalRam = INTERNAL_RAM_DATA_BASE;
}  // namespace

std::vector<std::string> LoadParams::ports() {
  std::vector<std::string> words{std::string(stat_name(Master::kLoad))};
  for (const MasterInfo& m : kMasters.rows)
    if (m.load_allowed && m.id != Master::kLoad && m.side != Side::kWrites)
      words.emplace_back(m.statistics);
  return words;
}
Master LoadParams::reader() const { return kMasters.find(port(), false)->id; }
Master LoadParams::writer() const { return kMasters.find(port(), true)->id; }

LoadGenerator::LoadGenerator(sc_core::sc_module_name name, const LoadParams& params)
    : sc_module(name),
      params_(params),
      reads_("memory", params.reader(), kSlots),
      pause_(params.gap()) {
  if (params.writer() != params.reader())
    other_side_ = std::make_unique<BurstMaster>("writes", params.writer(), kSlots);
  const auto report = [this](const BurstMaster::Completion& c) { done(c); };
  reads_.on_done = report;
  if (other_side_) other_side_->on_done = report;
  const auto outstanding = static_cast<unsigned>(params.outstanding());
  if (other_side_) {
    add_master(params.reader(), reads_.socket, params.reads() ? outstanding : 0);
    add_master(params.writer(), other_side_->socket, params.writes() ? outstanding : 0,
               params.copies() ? Pace::kData : Pace::kRepeating);
  } else {
    add_master(params.reader(), reads_.socket, outstanding);
  }
  SC_METHOD(fill);
  sensitive << wake_.event();
  dont_initialize();
  SC_METHOD(sdram_changed);
  sensitive << sdram_initialised;
  if (!params.active()) return;
  // Not at power-up itself: the clocks get their first values in that instant.
  const Picoseconds start = std::max<Picoseconds>(params.start(), kPsPerNs);
  for (std::uint64_t i = 0; i < params.outstanding(); ++i) ready_.push(start);
  wake_.at(start);
}

void LoadGenerator::sdram_changed() {
  if (!params_.memory.is("sdram")) return;
  usable_from_ = sdram_initialised.read() ? kernel_time() + kPause : kNever;
  if (!ready_.empty()) wake_.at(usable_from_);
}

void LoadGenerator::fill() {
  const Picoseconds now = kernel_time();
  for (; !copies_.empty() && copies_.front().since < now; copies_.pop_front())
    reads_.write(copies_.front().address, copies_.front().data);
  if (!copies_.empty()) wake_.at(copies_.front().since + 1);
  if (params_.end() && now >= params_.end()) return;
  if (now < usable_from_) {
    wake_.at(usable_from_);
    return;
  }
  while (!ready_.empty() && ready_.top() <= now) {
    ready_.pop();
    issue();
  }
  if (!ready_.empty()) wake_.at(ready_.top());
}

void LoadGenerator::issue() {
  const std::uint64_t n = serial_++;
  const std::uint64_t slots = region() / params_.bytes();
  // A fixed generator: the same load in every run.
  state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
  const std::uint64_t slot = params_.pattern.is("random") ? (state_ >> 33) % slots : n % slots;
  const auto address =
      static_cast<std::uint32_t>((params_.memory.is("sdram") ? kSdram : kInternalRam) +
                                 params_.base() + slot * params_.bytes());
  const auto bytes = static_cast<unsigned>(params_.bytes());
  if (params_.kind.is("write") || (params_.kind.is("mixed") && n % 2 == 1))
    writes().write(address, {data_.data(), bytes});
  else
    reads_.read(address, bytes);
}

void LoadGenerator::done(const BurstMaster::Completion& c) {
  const Picoseconds now = kernel_time();
  if (params_.copies() && !c.write && !c.error) {
    const std::uint32_t to = c.address + static_cast<std::uint32_t>(region());
    if (other_side_) return other_side_->write(to, c.data);
    copies_.push_back({now, to, {c.data.begin(), c.data.end()}});
    return wake_.at(now + 1);
  }
  ready_.push(now + (c.error ? kPause : pause_));
  wake_.at(ready_.top());
}

}  // namespace fovea::bus
