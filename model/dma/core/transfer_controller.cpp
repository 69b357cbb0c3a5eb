#include "model/dma/core/transfer_controller.h"

#include <algorithm>
#include <array>

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
  head_ = 0;
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
  if (idle()) busy_since_ = at;
  program_ = request;
  program_at_ = at;
  advance();
}

void TransferController::advance() {
  while (load() || issue_read() || issue_write()) {
  }
}

RegisterSet TransferController::destination_set(unsigned n) const {
  const unsigned place = (n + sizes_.depth - head_) % sizes_.depth;
  return {written_[n], place < destinations_.size() ? destinations_[place].writes.bytes() : 0};
}

unsigned TransferController::destination_writing() const {
  for (unsigned place = 0; place < destinations_.size(); ++place)
    if (!destinations_[place].writes.done()) return (head_ + place) % sizes_.depth;
  return static_cast<unsigned>(head_ + destinations_.size() + sizes_.depth - 1) % sizes_.depth;
}

/// From the program register to the source active and a destination register.
bool TransferController::load() {
  if (!program_ || source_ || registers_.amount() == 0) return false;
  const Picoseconds free = std::max(registers_.take(1), source_free_);
  const Picoseconds at = host_.edge(std::max(program_at_, free), 1);
  const TransferRequest& r = *program_;
  read_ = written_[(head_ + destinations_.size()) % sizes_.depth] = r;
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
  host_.read(c, at);
  return true;
}

/// The oldest request with writes left to issue.
TransferController::Destination* TransferController::writing() {
  for (Destination& d : destinations_)
    if (!d.writes.done()) return &d;
  return nullptr;
}

bool TransferController::issue_write() {
  Destination* const d = writing();
  if (!d) return false;
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
  host_.write(c, {bytes.data(), c.bytes}, at);
  return true;
}

/// Data arrives in the order of the requests.
void TransferController::read_done(std::span<const std::uint8_t> data, bool error, Picoseconds at) {
  data_.insert(data_.end(), data.begin(), data.end());
  arrived_.add(static_cast<unsigned>(data.size()), at);
  const auto d = std::find_if(destinations_.begin(), destinations_.end(),
                              [](const Destination& x) { return x.to_arrive > 0; });
  FOVEA_CHECK(d != destinations_.end() && d->to_arrive >= data.size(), "data that nobody asked for");
  d->to_arrive -= static_cast<std::uint32_t>(data.size());
  if (error) host_.failed(d->request, Failure::kRead, at);
  advance();
}

void TransferController::write_done(bool error, Picoseconds at) {
  FOVEA_CHECK(!writes_.empty(), "an acknowledgement without a write");
  const Write w = writes_.front();
  writes_.pop_front();
  room_.add(w.bytes, at);
  if (error) host_.failed(destinations_.front().request, Failure::kWrite, at);
  if (w.last) {
    const TransferRequest request = destinations_.front().request;
    destinations_.pop_front();
    head_ = (head_ + 1) % sizes_.depth;
    registers_.add(1, at);
    if (idle()) busy_ += at - busy_since_;
    host_.completed(request, at);
  }
  advance();
}

}  // namespace fovea::dma
