#include "model/engine/core/remap_model.h"

#include <algorithm>

namespace fovea::engine {

void RemapModel::reset() {
  state_ = State::kIdle;
  map_.clear();
  addresses_.clear();
  cache_.clear();
  packer_.clear();
  which_ = reads_ = 0;
  line_asked_ = word_valid_ = blended_valid_ = sending_ = part_error_ = frozen_ = false;
  read_arrivals_.clear();
  write_arrivals_.clear();
  next_arrival_ = kNoClock;
  read_from_ = write_from_ = 0;
  parts_.clear();
  done_at_ = kNoClock;
}

void RemapModel::start(const Job& job, std::uint64_t clock) {
  reset();
  job_ = job;
  end_ = {};
  accepted_ = clock;
  now_ = clock + 1;
  state_ = State::kBegin;
}

void RemapModel::abort(std::uint64_t clock) {
  if (state_ != State::kBegin && state_ != State::kRun) return;
  end_.aborted = state_ == State::kRun || job_.possible();
  end_.refused = !end_.aborted;
  state_ = State::kDrain;
  now_ = std::max(now_, clock + 1);
  frozen_ = false;
}

std::uint64_t RemapModel::run(std::uint64_t safe) {
  while (state_ != State::kIdle) {
    if (frozen_) {
      const std::uint64_t event = next_event();
      if (event == kNoClock) return kNoClock;
      if (event > safe && waits(event)) return event;
      now_ = event;
      frozen_ = false;
    }
    if (state_ == State::kRun && word_valid_ && blended_valid_ && !job_.bilinear) flow(std::max(safe, read_from_));
    if (now_ > safe && waits(now_)) return now_;
    frozen_ = !step();
    ++now_;
  }
  return kNoClock;
}

/// What `clock` does depends on an answer that is not known.
inline bool RemapModel::waits_in_run(std::uint64_t clock) const {
  if (clock > read_from_ && wants_read()) return true;
  return clock > write_from_ && write_arrivals_.empty() && packer_.under_way() > 0 &&
         (packer_.finished_but_for_answers() || packer_.waits_for_answer(blended_valid_, blended_dst_));
}

bool RemapModel::waits_in_drain(std::uint64_t clock) const {
  if (state_ != State::kDrain) return false;
  return (clock > read_from_ && reads_ > 0) || (clock > write_from_ && parts_.size() > write_arrivals_.size());
}

/// When something may move again, as far as is known. @pre nothing has moved in the clock before now_
std::uint64_t RemapModel::next_event() const {
  std::uint64_t at = kNoClock;
  const auto consider = [&](std::uint64_t clock) {
    if (clock >= now_) at = std::min(at, clock);
  };
  if (!read_arrivals_.empty()) consider(std::max(read_arrivals_.front().clock, now_));
  if (!write_arrivals_.empty()) consider(std::max(write_arrivals_.front().clock, now_));
  if (!map_.empty()) consider(map_.there());
  if (!cache_.no_line()) consider(cache_.line_at());
  if (sending_) consider(packer_.sent_at());
  return at;
}

bool RemapModel::step() {
  if (state_ == State::kRun) [[likely]]
    return run_clock();
  if (state_ == State::kDrain) {
    const bool moved = arrivals(now_ - 1);  // those that were not known when that clock was computed
    return drain() || moved;
  }
  begin();
  return true;
}

void RemapModel::begin() {
  state_ = State::kRun;
  if (job_.possible()) {
    addresses_.start(job_);
    map_.start(job_.map_base, job_.map_words);
  } else {
    end_.refused = true;
    state_ = State::kDrain;
  }
}

/// From the result back to the map, so that each part sees what its neighbour had before this clock.
[[gnu::always_inline]] inline bool RemapModel::run_clock() {
  bool moved = arrivals(now_ - 1);  // those that were not known when that clock was computed
  if (state_ != State::kRun) [[unlikely]]
    return drain() || moved;
  const bool finished = packer_.finished(), room = cache_.room(), may_ask = cache_.may_ask();
  bool map_asked = false;
  // Requests first: those of the address channel come before the write whose data end in the same clock.
  moved |= ask(map_asked);
  moved |= send();
  const bool packed = packer_.clock(now_, blended_valid_, blended_, blended_dst_, blended_last_, false);
  moved |= packer_.moved();
  sending_ |= packer_.handed_over();
  const bool blend_ready = packed || !blended_valid_ || !access_.final;
  moved |= blend_words(packed);
  if (!word_valid_ || blend_ready) moved |= fetch();
  moved |= feed<false>(room, may_ask, map_asked);
  moved |= arrivals(now_);
  if (finished && state_ == State::kRun) [[unlikely]] {
    state_ = State::kDrain;
    moved = true;
  }
  return moved;
}

/// What is in front of the data: tags, addresses, the map. @return anything has moved
template <bool kNearest>
[[gnu::always_inline]] inline bool RemapModel::feed(bool room, bool may_ask, bool map_asked) {
  const Pair* const pair = addresses_.front();
  const bool access_taken = pair && room && tags<kNearest>(*pair, may_ask);
  const bool pair_taken = access_taken && (kNearest || which_ == 0);
  const bool moved = addresses_.clock(pair_taken, map_.word(now_));
  return map_.clock(map_asked, addresses_.took_map(), false) || moved || access_taken;
}

/// By far the most clocks of a job without interpolation, as long as they follow each other: each unit behind the cache
/// hands its word on, and nothing is exchanged with the memory. Each of them is the same as run_clock().
/// @param reads no read that is not known arrives before this clock
void RemapModel::flow(std::uint64_t reads) {
  const std::uint64_t until = sending_ ? std::min(next_arrival_, packer_.sent_at()) : next_arrival_;
  for (; now_ < until && !line_asked_ && !map_.asks() && packer_.takes(blended_dst_); ++now_) {
    if (now_ > reads && wants_read()) return;
    const bool room = cache_.room(), may_ask = cache_.may_ask();
    packer_.take(blended_, blended_dst_, blended_last_);
    blend_last<true>();
    const bool there = fetch();
    feed<true>(room, may_ask, false);
    if (!there) {
      ++now_;
      return;
    }
  }
}

/// Nothing new is asked for; what is under way comes in, then all is cleared.
bool RemapModel::drain() {
  const bool quiet = reads_ == 0 && read_arrivals_.empty() && packer_.under_way() == 0 && !line_asked_ &&
                     !map_.asks();
  if (quiet) {
    end_.clocks = static_cast<std::uint32_t>(now_ - accepted_);
    const std::uint64_t at = now_;
    const JobEnd end = end_;
    reset();
    end_ = end;
    done_at_ = at;
    return true;
  }
  bool map_asked = false;
  bool moved = ask(map_asked);
  moved |= send();
  if (map_asked) map_.clock(true, false, true);
  return moved | arrivals(now_);
}

/// One of the two readers asks, the source first.
inline bool RemapModel::ask(bool& map_asked) {
  if (line_asked_) {
    line_asked_ = false;
    ++end_.lines;
    ++reads_;
    const std::uint32_t address = line_ * 4 * SourceCache::kLineWords;
    port_.issue({kSourceReads, false, kSourceReads, address, 4 * SourceCache::kLineWords, {}}, now_);
    return true;
  }
  map_asked = map_.asks();
  if (!map_asked) return false;
  ++reads_;
  port_.issue({kMapReads, false, kMapReads, map_.address(), map_.length(), {}}, now_);
  return true;
}

inline bool RemapModel::send() {
  if (!sending_ || now_ != packer_.sent_at()) return false;
  send_burst();
  return true;
}

/// Issues a burst of the result when its last data are taken: one request for each run of words.
void RemapModel::send_burst() {
  sending_ = false;
  const Packer::Burst& b = packer_.out();
  unsigned parts = 0;
  for (unsigned from = 0; from < Packer::kWords;) {
    if (!(b.mask >> from & 1)) {
      ++from;
      continue;
    }
    unsigned to = from;
    while (to < Packer::kWords && b.mask >> to & 1) ++to;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(b.words.data() + from);
    ++parts;
    port_.issue({0, true, 0, b.address + 4 * from, 4 * (to - from), {bytes, 4 * (to - from)}}, now_);
    from = to;
  }
  parts_.push(parts);
}

/// The words of a pair become one of the result.
[[gnu::always_inline]] inline bool RemapModel::blend_words(bool taken) {
  const bool free = !blended_valid_ || taken;
  if (!word_valid_) {
    blended_valid_ = !free;
    return false;
  }
  if (access_.final && !free) return false;
  if (job_.bilinear) [[unlikely]]
    words_[access_.which] = word_;
  if (!access_.final) {
    blended_valid_ = !free;
    return true;
  }
  blend_last<false>();
  return true;
}

/// The last word of a pair is there.
template <bool kNearest>
[[gnu::always_inline]] inline void RemapModel::blend_last() {
  const Pair& pair = addresses_.oldest();
  blended_ = pair.border ? job_.border : !kNearest && job_.bilinear ? blend(pair, words_) : word_;
  blended_dst_ = pair.dst;
  blended_last_ = pair.last;
  blended_valid_ = true;
  addresses_.forget();
}

/// The next access gets its word, out of the cache or of the line that has come for it.
[[gnu::always_inline]] inline bool RemapModel::fetch() {
  const CacheAccess* const access = cache_.next();
  word_valid_ = access && (!access->miss || cache_.line_there(now_));
  if (!word_valid_) return false;
  access_ = *access;
  word_ = cache_.pop();
  return true;
}

/// The next access of the pair at hand. @return it is taken; which_ == 0 then: the pair too
template <bool kNearest>
[[gnu::always_inline]] inline bool RemapModel::tags(const Pair& pair, bool may_ask) {
  CacheAccess a;
  a.final = kNearest || !job_.bilinear || pair.border || which_ == 3;
  if (!kNearest) a.which = static_cast<std::uint8_t>(which_);
  std::uint32_t word = pair.src;
  if (!kNearest && which_ != 0) [[unlikely]]
    word = (word + (which_ % 2 && !pair.edge_x) + (which_ / 2 && !pair.edge_y ? job_.src_pitch : 0)) & 0x3FFF'FFFF;
  if (!pair.border) cache_.look_up(a, word);
  if (a.miss) {
    if (!may_ask) return false;
    line_asked_ = true;
    line_ = word / SourceCache::kLineWords;
    cache_.replace(a, line_);
  }
  cache_.push(a);
  if (!a.final) {
    ++which_;
    return true;
  }
  if (!kNearest) which_ = 0;
  if (pair.bad) [[unlikely]]
    ++end_.bad;
  return true;
}

/// What arrives up to a clock.
bool RemapModel::arrive(std::uint64_t clock) {
  bool failed = false, moved = false;
  while (!read_arrivals_.empty() && read_arrivals_.front().clock <= clock) {
    failed |= read_arrivals_.front().error;
    end_.read_error |= read_arrivals_.front().error;
    read_arrivals_.pop();
    moved = true;
  }
  while (!write_arrivals_.empty() && write_arrivals_.front().clock <= clock) {
    failed |= write_arrivals_.front().error;
    end_.write_error |= write_arrivals_.front().error;
    write_arrivals_.pop();
    parts_.pop();
    packer_.answered();
    ++end_.writes;
    moved = true;
  }
  if (failed && state_ == State::kRun) state_ = State::kDrain;
  note_arrivals();
  return moved;
}

void RemapModel::note_arrivals() {
  next_arrival_ = std::min(read_arrivals_.empty() ? kNoClock : read_arrivals_.front().clock,
                           write_arrivals_.empty() ? kNoClock : write_arrivals_.front().clock);
}

void RemapModel::note_read(bool error, std::uint64_t first, std::uint64_t last) {
  --reads_;
  if (error) read_arrivals_.push({first, true});
  read_arrivals_.push({last, error});
  read_from_ = last + 1;
  note_arrivals();
}

// What came while the model was ahead of it is new to it now.
void RemapModel::answer_line(bool error, std::span<const std::uint8_t> data, std::uint64_t first,
                             std::uint64_t last) {
  note_read(error, first, last);
  if (state_ != State::kDrain) cache_.arrive(data, std::max(last + 1, now_));
}

void RemapModel::answer_map(bool error, std::span<const std::uint8_t> data, std::span<const std::uint64_t> beats) {
  note_read(error, beats.front(), beats.back());
  if (state_ == State::kDrain) return;
  for (std::size_t n = 0; n < beats.size(); ++n) map_.arrive(data.data() + 8 * n, std::max(beats[n] + 1, now_));
}

void RemapModel::answer_write(bool error, std::uint64_t clock) {
  part_error_ |= error;
  write_from_ = clock + 1;
  // The writes whose answers lie ahead are the oldest ones.
  unsigned& parts = parts_.at(write_arrivals_.size());
  if (--parts > 0) return;
  write_arrivals_.push({clock, part_error_});
  note_arrivals();
  part_error_ = false;
}

}  // namespace fovea::engine
