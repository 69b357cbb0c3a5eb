#include "model/engine/rtl/pair_backend.h"

#include <algorithm>
#include <cstdio>

#include "model/engine/core/engine_offsets.h"

namespace fovea::rtl {
namespace {

using engine::Answer;
using engine::Burst;
namespace at = engine::at;

constexpr std::array kStreams{"reads of the map", "reads of the source", "writes"};

std::string text(const char* format, unsigned long long a, unsigned long long b, unsigned long long c = 0,
                 unsigned long long d = 0) {
  char out[160];
  std::snprintf(out, sizeof out, format, a, b, c, d);
  return out;
}

std::string milliseconds(Picoseconds at) {
  char out[40];
  std::snprintf(out, sizeof out, "%.6f ms", static_cast<double>(at) * 1e-9);
  return out;
}

/// The pixel whose luma is next to a byte (Cb Y0 Cr Y1). @param base, pitch of the picture, in words
std::string pixel(std::uint32_t address, std::uint32_t base, std::uint32_t pitch) {
  const std::uint32_t bytes = address - 4 * base, row = pitch ? bytes / (4 * pitch) : 0;
  return text("pixel (%llu, %llu)", (bytes - row * 4 * pitch) / 2, row);
}

/// The job of a request, and where in its pictures the byte at `address` is.
std::string place(unsigned stream, std::uint32_t address, const engine::JobPlace& job) {
  if (job.number == 0) return "";
  const std::string of = text(", job %llu (tag 0x%02llx), ", job.number, job.tag);
  if (stream == engine::kMapReads) return of + text("word %llu of the map", (address - job.map_base) / 4, 0);
  if (stream == engine::kSourceReads) return of + pixel(address, job.src_base, job.src_pitch) + " of the source";
  return of + pixel(address, job.dst_base, job.dst_pitch) + " of the result";
}

}  // namespace

PairBackend::PairBackend(Host& host, const Clock& clock, const Maker& owner, const Maker& twin,
                         OnDifference on_difference)
    : host_(host), clock_(clock), on_difference_(std::move(on_difference)), owner_(owner(owner_side_)),
      twin_(twin(twin_side_)) {}

PairBackend::~PairBackend() = default;

/// Only the first: what follows from it differs too.
void PairBackend::difference(const std::string& what, Picoseconds at) {
  if (different_) return;
  different_ = true;
  on_difference_("remap engine: RTL and model differ: " + what + "; at " + milliseconds(at), at);
}

/// @param job of the request, by whichever of the two can tell
void PairBackend::difference(const std::string& what, unsigned stream, const Request& r, const engine::JobPlace& job) {
  difference(kStreams[stream] + (", " + what) + place(stream, r.address, job), r.at);
}

void PairBackend::skip(std::uint64_t requests) {
  if (requests == 0) return;
  summary_.skipped += requests;
  if (on_skipped) on_skipped(requests);
}

void PairBackend::issued(bool twin, const Burst& b, Picoseconds at) {
  const unsigned n = stream_of(b.write, b.id);
  Stream& s = streams_[n];
  if (twin) s.asking.push_back({b.tag, b.bytes, at});
  if (disturbed_ || different_) {
    skip(1);
  } else {
    (twin ? s.twin : s.owner)
        .push_back({b.address, {b.data.begin(), b.data.end()}, b.bytes, at, (twin ? twin_ : owner_)->job()});
    if (twin && b.write && ++twin_writes_ == planted) s.twin.back().data.front() ^= 1;
    compare(n);
  }
  if (twin) return;
  Burst out = b;
  out.tag = ++tags_;
  open_[out.tag] = {n, b.tag};
  host_.issue(out, at);
}

void PairBackend::compare(unsigned stream) {
  Stream& s = streams_[stream];
  while (!s.owner.empty() && !s.twin.empty()) {
    Request a = std::move(s.owner.front());
    const Request b = std::move(s.twin.front());
    s.owner.pop_front();
    s.twin.pop_front();
    const engine::JobPlace& job = a.job.number ? a.job : b.job;
    const std::string where = "number " + std::to_string(s.compared);
    if (a.address != b.address || a.bytes != b.bytes)
      return difference(where + text(": 0x%08llx, %llu bytes; its twin 0x%08llx, %llu bytes", a.address,
                                     a.bytes, b.address, b.bytes),
                        stream, a, job);
    const auto [x, y] = std::mismatch(a.data.begin(), a.data.end(), b.data.begin());
    if (x != a.data.end()) {
      a.address += static_cast<unsigned>(x - a.data.begin());
      return difference(where + text(": byte 0x%08llx is 0x%02llx; its twin's 0x%02llx", a.address, *x, *y), stream, a,
                        job);
    }
    ++s.compared;
    ++summary_.requests;
    const auto edge = [this](Picoseconds t) { return static_cast<std::int64_t>(clock_.edge_at_or_after(t)); };
    const std::int64_t lag = edge(b.at) - edge(a.at);
    ++summary_.lag[lag];
    if (on_compared) on_compared(lag);
  }
}

void PairBackend::answer(const Answer& a) {
  const auto open = open_.find(a.tag);
  if (open == open_.end()) return;
  const auto [stream, tag] = open->second;
  open_.erase(open);
  if (!disturbed_ && !different_)
    streams_[stream].replies.push_back({a.error, {a.data.begin(), a.data.end()}, a.first, a.last});
  Answer own = a;
  own.tag = tag;
  owner_->answer(own);
  if (a.error) disturb();
}

/// From here on the requests of both need not be the same.
void PairBackend::disturb() {
  disturbed_ = true;
  for (Stream& s : streams_) {
    skip(s.owner.size() + s.twin.size());
    s.owner.clear();
    s.twin.clear();
  }
}

/// Hands the twin what it has asked for. True: something.
bool PairBackend::feed(Picoseconds now) {
  bool any = false;
  for (unsigned n = 0; n < streams_.size(); ++n) {
    Stream& s = streams_[n];
    while (!s.asking.empty() && (!s.replies.empty() || disturbed_ || different_)) {
      Answer a;
      Reply r;
      const Asking asked = s.asking.front();
      s.asking.pop_front();
      a.tag = asked.tag;
      a.write = n == 2;
      if (!s.replies.empty()) {
        r = std::move(s.replies.front());
        s.replies.pop_front();
      } else {
        r = {false, std::vector<std::uint8_t>(a.write ? 0 : asked.bytes), now, now};
      }
      a.error = r.error;
      a.data = r.data;
      a.first = std::max({r.first, now, asked.at});
      a.last = std::max(r.last, a.first);
      twin_->answer(a);
      any = true;
    }
  }
  return any;
}

/// The owner is quiet: what the twin asks for beyond it has no answer. Both are: nothing may be left over.
void PairBackend::settle() {
  for (unsigned n = 0; n < streams_.size(); ++n) {
    const Stream& s = streams_[n];
    if (!disturbed_ && !s.twin.empty())
      difference(std::to_string(s.twin.size()) + " that only the twin asked for", n, s.twin.front(),
                 s.twin.front().job);
  }
  if (twin_->busy()) return;
  for (unsigned n = 0; n < streams_.size(); ++n) {
    Stream& s = streams_[n];
    if (!disturbed_ && !s.owner.empty())
      difference(std::to_string(s.owner.size()) + " that the twin did not ask for", n, s.owner.front(),
                 s.owner.front().job);
    const std::uint64_t compared = s.compared;
    s = {};
    s.compared = compared;
  }
  disturbed_ = false;
}

Picoseconds PairBackend::run(Picoseconds now) {
  const Picoseconds owner = owner_->run(now);
  Picoseconds twin = twin_->run(now);
  while (feed(now)) twin = twin_->run(now);
  if (!owner_->busy()) settle();
  return std::min(owner, twin);
}

std::uint32_t PairBackend::read(std::uint32_t offset, Picoseconds now) {
  const std::uint32_t word = owner_->read(offset, now), other = twin_->read(offset, now);
  const bool lasting = offset == at::kId || offset == at::kCtrl || offset == at::kEnables ||
                       offset == at::kSubmit || offset >= at::kMode;
  if (lasting && word != other)
    difference(text("register 0x%02llx reads 0x%08llx; its twin's 0x%08llx", offset, word, other), now);
  return word;
}

void PairBackend::write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) {
  if (offset == at::kCtrl && strobes & 1 && engine::bits::kAbort.of(word)) disturb();
  owner_->write(offset, word, strobes, now);
  twin_->write(offset, word, strobes, now);
}

void PairBackend::reset() {
  owner_->reset();
  twin_->reset();
  streams_ = {};
  open_.clear();
  disturbed_ = false;
}

std::string PairBackend::table() const {
  std::string out = "lag_clocks,requests\n";
  for (const auto& [lag, n] : summary_.lag) out += std::to_string(lag) + "," + std::to_string(n) + "\n";
  return out;
}

}  // namespace fovea::rtl
