#include "model/engine/core/tlm_backend.h"

#include <algorithm>

#include "model/engine/core/engine_registers.h"

namespace fovea::engine {
namespace {

using namespace at;

/// The bits of each register that keep what is written.
const std::array<std::uint32_t, kRegisterWords>& kept_bits() {
  static const std::array<std::uint32_t, kRegisterWords> kKept = [] {
    std::array<std::uint32_t, kRegisterWords> bits{};
    for (EngineRegs declared; const Reg* reg : declared.regs()) bits[reg->offset() / 4] = reg->writable();
    return bits;
  }();
  return kKept;
}

std::uint32_t lanes_of(unsigned strobes) {
  std::uint32_t lanes = 0;
  for (unsigned n = 0; n < 4; ++n)
    if (strobes >> n & 1) lanes |= 0xFFu << 8 * n;
  return lanes;
}

}  // namespace

void TlmBackend::reset() {
  registers_.fill(0);
  queue_.clear();
  model_.reset();
  enabled_from_ = idle_from_ = beat_free_ = answer_free_ = 0;
  running_ = false;
  update_interrupt();
}

bool TlmBackend::enabled() const { return bits::kEnable.of(value(kCtrl)); }

/// The time from which on the model may count on every answer before `clock`: that of the edge before it.
Picoseconds TlmBackend::time_before(std::uint64_t clock) const { return clock_.edge(clock - 1); }

/// The clock in which the oldest job is taken.
std::uint64_t TlmBackend::take_at() const {
  if (!enabled() || queue_.empty() || !model_.idle()) return RemapModel::kNoClock;
  return std::max({queue_.front().there, enabled_from_, idle_from_});
}

/// Clocks up to that before `next` have happened.
Picoseconds TlmBackend::run(Picoseconds now) {
  if (!clock_.running()) return kNever;
  const std::uint64_t next = clock_.edge_after(now);
  for (;;) {
    const std::uint64_t wait = model_.run(next);
    // The registers learn of the end a clock after it; the next job may begin in that clock.
    const bool over = running_ && model_.done_at() != RemapModel::kNoClock;
    const std::uint64_t end = over ? model_.done_at() + 1 : RemapModel::kNoClock;
    if (over && end < next) {
      end_job();
      continue;
    }
    const std::uint64_t begin = over ? RemapModel::kNoClock : take_at();
    if (begin < next) {
      take(begin);
      continue;
    }
    const std::uint64_t event = std::min(end, begin);  // seen at its own edge
    Picoseconds call = event == RemapModel::kNoClock ? kNever : clock_.edge(event);
    if (wait != RemapModel::kNoClock) call = std::min(call, time_before(wait));
    return call;
  }
}

void TlmBackend::take(std::uint64_t clock) {
  const Entry entry = queue_.front();
  queue_.pop();
  running_ = true;
  tag_ = entry.tag;
  model_.start(entry.job, clock);
}

void TlmBackend::end_job() {
  const JobEnd& e = model_.end();
  std::uint32_t events = bits::kRefused.put(e.refused) | bits::kReadError.put(e.read_error) |
                         bits::kWriteError.put(e.write_error) | bits::kAborted.put(e.aborted);
  if (!events) events = bits::kDone.mask();
  const std::uint32_t count = bits::kEndedCount.of(value(kEnded)) + 1;
  cell(kEnded) = bits::kEndedCount.put(count) | bits::kEndedEvents.put(events) | bits::kEndedTag.put(tag_);
  cell(kClocks) = e.clocks;
  cell(kLines) = e.lines;
  cell(kWrites) = e.writes;
  cell(kBad) = e.bad;
  running_ = false;
  idle_from_ = model_.done_at() + 1;
  model_.reset();
  raise(events);
}

void TlmBackend::raise(std::uint32_t events) {
  cell(kEvents) |= events;
  update_interrupt();
}

void TlmBackend::update_interrupt() {
  const bool level = value(kEvents) & value(kEnables);
  if (level != interrupt_) host_.interrupt(level);
  interrupt_ = level;
}

std::uint32_t TlmBackend::read(std::uint32_t offset, Picoseconds) {
  switch (offset) {
    case kId:
      return kIdentity;
    case kStatus: {
      const auto waiting = static_cast<std::uint32_t>(queue_.size());
      return bits::kBusy.put(running_) | bits::kQueued.put(waiting) | bits::kFull.put(waiting == kQueueDepth);
    }
    default:
      return offset / 4 < kRegisterWords ? value(offset) : 0;
  }
}

void TlmBackend::write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) {
  if (offset >= kMode && offset / 4 < kRegisterWords) {
    const std::uint32_t lanes = lanes_of(strobes) & kept_bits()[offset / 4];
    cell(offset) = (cell(offset) & ~lanes) | (word & lanes);
    return;
  }
  if (!(strobes & 1)) return;  // all that acts is in the lowest byte
  const std::uint64_t clock = clock_.edge_after(now);  // at whose end it takes effect
  switch (offset) {
    case kCtrl:
      if (bits::kAbort.of(word)) abort(clock);
      if (bits::kEnable.of(word) && !enabled()) enabled_from_ = clock + 1;
      cell(kCtrl) = word & bits::kEnable.mask();
      return;
    case kEvents:
      cell(kEvents) &= ~word;
      return update_interrupt();
    case kEnables:
      cell(kEnables) = word & bits::kAllEvents.mask();
      return update_interrupt();
    case kSubmit:
      return submit(static_cast<std::uint8_t>(bits::kTag.of(word)), clock);
    default:
      return;
  }
}

void TlmBackend::submit(std::uint8_t tag, std::uint64_t clock) {
  if (queue_.size() == kQueueDepth) return raise(bits::kOverflow.mask());
  queue_.push({window(), tag, clock + 1});
}

void TlmBackend::abort(std::uint64_t clock) {
  model_.abort(clock);
  if (queue_.empty()) return;
  queue_.clear();
  raise(bits::kDropped.mask());
}

JobPlace TlmBackend::job() const {
  const Job& j = model_.job();
  return {bits::kEndedCount.of(value(kEnded)) + 1, tag_,          j.src_base, j.src_pitch, j.dst_base,
          j.dst_pitch,                             j.map_base};
}

/// The job of the window.
Job TlmBackend::window() const {
  const auto field = [this](std::uint32_t offset, Bits b) { return b.of(value(offset)); };
  Job job;
  job.mode = static_cast<RemapMode>(field(kMode, bits::kRemapMode));
  job.bilinear = field(kMode, bits::kBilinear);
  job.grid_log2 = field(kMode, bits::kGridLog2);
  job.pieces = field(kMode, bits::kPieces);
  job.piece_log2 = field(kMode, bits::kPieceLog2);
  job.pairs = field(kSize, bits::kPairs);
  job.rows = field(kSize, bits::kRows);
  job.src_base = field(kSrcBase, bits::kBase);
  job.src_pitch = field(kSrcPitch, bits::kPitch);
  job.src_width = field(kSrcSize, bits::kWidth);
  job.src_height = field(kSrcSize, bits::kHeight);
  job.dst_base = field(kDstBase, bits::kBase);
  job.dst_pitch = field(kDstPitch, bits::kPitch);
  job.map_base = value(kMapBase) & bits::kMapBase.mask();
  job.map_words = field(kMapWords, bits::kMapWords);
  job.border = value(kBorder);
  job.radius_limit = value(kRadiusLimit);
  job.centre_x = static_cast<std::int32_t>(value(kCentreX));
  job.centre_y = static_cast<std::int32_t>(value(kCentreY));
  for (unsigned n = 0; n < 3; ++n) {
    job.a[n] = static_cast<std::int32_t>(value(kA0 + 4 * n));
    job.b[n] = static_cast<std::int32_t>(value(kB0 + 4 * n));
    job.c[n] = static_cast<std::int32_t>(value(kC0 + 4 * n));
  }
  return job;
}

/// Tags carry what an answer has to tell: the identifier of a read.
void TlmBackend::issue(const Burst& burst, std::uint64_t clock) { host_.issue(burst, clock_.edge(clock)); }

void TlmBackend::answer(const Answer& a) {
  if (a.write) {
    answer_free_ = std::max(clock_.edge_after(a.last), answer_free_ + 1);
    return model_.answer_write(a.error, answer_free_);
  }
  const std::size_t count = a.data.size() / 8;
  const std::uint64_t begin = count == 1 ? clock_.edge_after(a.last) : clock_.edge_after(a.first);
  if (a.tag == kSourceReads) {
    // Of evenly spread beats, no more than one an edge, either the first decides when the last one comes, or that one
    // itself, or the answer before.
    const std::uint64_t first = std::max(begin, beat_free_ + 1);
    beat_free_ = std::max({begin + count - 1, clock_.edge_after(a.last), beat_free_ + count});
    return model_.answer_line(a.error, a.data, first, beat_free_);
  }
  std::array<std::uint64_t, 8> beats;
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint64_t edge = n == 0 ? begin : clock_.edge_after(a.first + (a.last - a.first) * n / (count - 1));
    beats[n] = beat_free_ = std::max(edge, beat_free_ + 1);
  }
  model_.answer_map(a.error, a.data, {beats.data(), count});
}

}  // namespace fovea::engine
