#include "model/dma/core/transfer_controller.h"

#include <algorithm>
#include <array>
#include <utility>

#include "model/common/check.h"
#include "model/common/mem_request.h"

namespace fovea::dma {
namespace {

/// SPRUH82C, "Error Generation": addresses and indices of a side with constant addressing must be
/// multiples of 32 bytes.
bool breaks_constant_rules(const TransferRequest::Side& side, const TransferRequest& r) {
  constexpr std::uint32_t kAlignment = 32;
  return side.constant && (side.address % kAlignment ||
                           (r.bcnt > 1 && static_cast<std::uint32_t>(side.index) % kAlignment));
}

}  // namespace

void TransferController::Supply::add(unsigned amount, Picoseconds at) {
  pieces_.push_back({amount, at});
  amount_ += amount;
}

Picoseconds TransferController::Supply::take(unsigned amount) {
  FOVEA_CHECK(amount <= amount_, "more taken than there is");
  amount_ -= amount;
  Picoseconds at = 0;
  while (amount > 0) {
    Piece& p = pieces_.front();
    const unsigned n = std::min(amount, p.amount);
    at = std::max(at, p.at);
    p.amount -= n;
    amount -= n;
    if (p.amount == 0) pieces_.pop_front();
  }
  return at;
}

TransferController::TransferController(Host& host, Sizes sizes) : host_(host), sizes_(sizes) {
  FOVEA_CHECK(sizes.depth > 0, "no destination register");
  set_burst(sizes.burst);
  reset();
}

void TransferController::set_burst(unsigned bytes) {
  FOVEA_CHECK(sizes_.fifo >= 2 * bytes, "two bursts do not fit into the FIFO");
  sizes_.burst = bytes;
}

void TransferController::reset() {
  program_.reset();
  source_.reset();
  destinations_.clear();
  programmed_ = read_ = {};
  written_.assign(sizes_.depth, {});
  loaded_ = 0;
  loaded_at_ = 0;
  read_before_ = written_before_ = {};
  reads_ = written_bursts_ = acknowledged_ = ends_ = {};
  writes_.clear();
  data_.clear();
  registers_ = {};
  room_ = {};
  arrived_ = {};
  registers_.add(sizes_.depth, 0);
  room_.add(sizes_.fifo, 0);
  program_at_ = source_free_ = next_read_ = next_write_ = 0;
}

void TransferController::submit(const TransferRequest& request, Picoseconds at) {
  FOVEA_CHECK(!program_, "the program register is taken");
  FOVEA_CHECK(request.acnt > 0 && request.bcnt > 0, "an empty transfer is none");
  programmed_ = request;
  if (breaks_constant_rules(request.source, request) ||
      breaks_constant_rules(request.destination, request)) {
    host_.failed(request, Failure::kRequest, at);
    host_.program_free(host_.edge(at, 1));
    return;
  }
  if (idle()) busy_since_ = std::max(at, busy_until_);
  program_ = request;
  program_at_ = at;
  advance();
}

void TransferController::advance() {
  while (load() || issue_read() || issue_write()) {
  }
}

RegisterSet TransferController::source_set(Picoseconds now) const {
  const std::uint64_t n = loaded(now);
  if (n == 0) return {};
  const std::uint32_t ahead = reads_.bytes_after(now, n - 1);
  if (n < loaded_) return {read_before_, ahead};
  return {read_, ahead + (source_ ? source_->reads.bytes() : 0)};
}

RegisterSet TransferController::destination_set(unsigned n, Picoseconds now) const {
  const std::uint64_t loads = loaded(now);
  const bool ahead = loads < loaded_ && loads % sizes_.depth == n;
  const TransferRequest& request = ahead ? written_before_ : written_[n];
  if (loads <= n) return {request, 0};
  return {request, left_to_write(loads - 1 - (loads - 1 - n) % sizes_.depth, now)};
}

std::uint32_t TransferController::left_to_write(std::uint64_t request, Picoseconds now) const {
  const std::uint64_t place = request - ends_.count();  // large if it has ended
  return written_bursts_.bytes_after(now, request) +
         (place < destinations_.size() ? destinations_[place].writes.bytes() : 0);
}

unsigned TransferController::destination_writing(Picoseconds now) const {
  const std::uint64_t loads = loaded(now);
  for (std::uint64_t n = ended(now); n < loads; ++n)
    if (left_to_write(n, now) > 0) return static_cast<unsigned>(n % sizes_.depth);
  return static_cast<unsigned>((loads + sizes_.depth - 1) % sizes_.depth);
}

bool TransferController::writing(Picoseconds now) const {
  return written_bursts_.count(now) > acknowledged_.count(now);
}

Picoseconds TransferController::busy(Picoseconds now) const {
  if (idle()) return busy_ - (busy_until_ > now ? busy_until_ - now : 0);
  return busy_ + now - busy_since_;  // busy_ is large enough where busy_since_ lies ahead
}

void TransferController::start_count(Picoseconds now) {
  busy_ = idle() && busy_until_ > now ? busy_until_ - now : 0;
  busy_since_ = now;
  if (!idle()) busy_until_ = now;
}

/// From the program register to the source active and a destination register.
bool TransferController::load() {
  if (!program_ || source_ || registers_.amount() == 0) return false;
  const Picoseconds free = std::max(registers_.take(1), source_free_);
  const Picoseconds at = host_.edge(std::max(program_at_, free), 1);
  const TransferRequest& r = *program_;
  read_before_ = read_;
  written_before_ = std::exchange(written_[loaded_ % sizes_.depth], r);
  read_ = r;
  ++loaded_;
  loaded_at_ = at;
  source_.emplace(Source{r, Commands(r, r.source, sizes_.burst)});
  destinations_.push_back({r, Commands(r, r.destination, sizes_.burst), r.bytes()});
  next_read_ = std::max(next_read_, at);
  program_.reset();
  host_.program_free(at);
  return true;
}

bool TransferController::issue_read() {
  if (!source_) return false;
  const Command c = source_->reads.next();
  const Picoseconds port = host_.read_free();
  if (room_.amount() < c.bytes || port == kNever) return false;
  const Picoseconds at = host_.edge(std::max({next_read_, room_.take(c.bytes), port}), 0);
  next_read_ = host_.edge(at, read_interval_);
  source_->reads.pop();
  if (source_->reads.done()) {
    source_free_ = host_.edge(at, 1);
    source_.reset();
  }
  reads_.add({at, loaded_ - 1, c.bytes});
  host_.read(c, at);
  return true;
}

/// Place of the oldest request with writes left to issue; that behind the last one if there is none.
std::size_t TransferController::oldest_to_write() const {
  std::size_t place = 0;
  while (place < destinations_.size() && destinations_[place].writes.done()) ++place;
  return place;
}

bool TransferController::issue_write() {
  const std::size_t place = oldest_to_write();
  if (place == destinations_.size()) return false;
  Destination* const d = &destinations_[place];
  const Command c = d->writes.next();
  const Picoseconds port = host_.write_free();
  if (arrived_.amount() < c.bytes || port == kNever) return false;
  const Picoseconds at = host_.edge(std::max({next_write_, arrived_.take(c.bytes), port}), 0);
  next_write_ = host_.edge(at, 1);
  d->writes.pop();
  writes_.push_back({c.bytes, d->writes.done()});
  std::array<std::uint8_t, kMaxBurstBytes> bytes;
  std::copy_n(data_.begin(), c.bytes, bytes.begin());
  data_.erase(data_.begin(), data_.begin() + c.bytes);
  written_bursts_.add({at, ends_.count() + place, c.bytes});
  host_.write(c, {bytes.data(), c.bytes}, at);
  return true;
}

/// Data arrives in the order of the requests.
void TransferController::read_done(std::span<const std::uint8_t> data, bool error, Picoseconds at) {
  data_.insert(data_.end(), data.begin(), data.end());
  arrived_.add(static_cast<unsigned>(data.size()), at);
  const auto d = std::find_if(destinations_.begin(), destinations_.end(),
                              [](const Destination& x) { return x.to_arrive > 0; });
  FOVEA_CHECK(d != destinations_.end() && d->to_arrive >= data.size(), "data that no request asked for");
  d->to_arrive -= static_cast<std::uint32_t>(data.size());
  if (error) host_.failed(d->request, Failure::kRead, at);
  advance();
}

void TransferController::write_done(bool error, Picoseconds at) {
  FOVEA_CHECK(!writes_.empty(), "an acknowledgement without a write");
  const Write w = writes_.front();
  writes_.pop_front();
  room_.add(w.bytes, at);
  acknowledged_.add({at, 0, 0});
  if (error) host_.failed(destinations_.front().request, Failure::kWrite, at);
  if (w.last) {
    const TransferRequest request = destinations_.front().request;
    destinations_.pop_front();
    ends_.add({at, 0, 0});
    registers_.add(1, at);
    if (idle()) {
      busy_ += at - busy_since_;
      busy_until_ = at;
    }
    host_.completed(request, at);
  }
  advance();
}

}  // namespace fovea::dma
