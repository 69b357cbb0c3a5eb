#include "model/engine/rtl/wave_file.h"

#include <verilated_fst_c.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "Vremap_top.h"
#include "model/common/check.h"

namespace fovea::rtl {
namespace {
constexpr Picoseconds kMostLow = 5 * kPsPerNs;  ///< before an edge that ends a pause

/// The library says nothing of a file that it cannot open, and overwrites any.
void check_file(const std::filesystem::path& file) {
  // An FST file begins with its header, block 0, of 329 bytes (GTKWave, fstapi.c).
  constexpr std::array<char, 9> kHeader{0, 0, 0, 0, 0, 0, 0, 1, 73};
  if (std::filesystem::is_symlink(file))
    throw UserError("--waves '" + file.string() + "': it is a symbolic link; choose another name");
  std::array<char, 9> head{};
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), head.size());
  if (in.gcount() > 0 && head != kHeader)
    throw UserError("--waves '" + file.string() + "': it exists and is not an FST file; choose another name");
  if (!std::ofstream(file, std::ios::binary | std::ios::app))
    throw UserError("--waves '" + file.string() + "': it cannot be written");
}

}  // namespace

struct WaveFile::File {
  VerilatedFstC fst;
};

WaveFile::WaveFile(const Waves& options, Vremap_top& top)
    : options_(options), file_(std::make_unique<File>()), left_(options.skip) {
  check_file(options.file);
  top.trace(&file_->fst, 99);
  file_->fst.set_time_unit("1ps");
  file_->fst.set_time_resolution("1ps");
  file_->fst.open(options.file.c_str());
}

WaveFile::~WaveFile() { close(); }

void WaveFile::close() {
  if (file_->fst.isOpen()) file_->fst.close();
}

void WaveFile::dump(Picoseconds at) {
  if (begin_ == kNever || at <= dumped_ || !file_->fst.isOpen()) return;
  if (at > end_ || (options_.length != kNever && at > begin_ + options_.length)) return close();
  file_->fst.dump(at);
  dumped_ = at;
}

void WaveFile::low(Picoseconds next_edge) {
  dump(next_edge - std::min(kMostLow, (next_edge - edge_) / 2));
}

bool WaveFile::triggered(Picoseconds edge, const Events& events) {
  if (edge < options_.from) return false;
  switch (options_.trigger) {
    case Waves::Trigger::kBusy:
      return true;
    case Waves::Trigger::kJob:
      return events.job;
    case Waves::Trigger::kInterrupt:
      return events.interrupt;
    case Waves::Trigger::kError:
      return events.error;
  }
  return false;
}

void WaveFile::high(Picoseconds edge, const Events& events) {
  edge_ = edge;
  if (begin_ == kNever && triggered(edge, events) && left_-- == 0) begin_ = edge;
  dump(edge);
}

}  // namespace fovea::rtl
