// A queue in an array.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace fovea::engine {

/// At most N elements, which the caller sees to. Both ends are counted on and on, as that is cheapest to move.
template <class T, std::size_t N>
class Ring {
  static_assert((N & (N - 1)) == 0, "a power of two");

 public:
  bool empty() const { return head_ == tail_; }
  std::size_t size() const { return tail_ - head_; }
  const T& front() const { return items_[head_ % N]; }
  T& front() { return items_[head_ % N]; }
  T& at(std::size_t n) { return items_[(head_ + n) % N]; }  ///< the n-th from the front
  const T& at(std::size_t n) const { return items_[(head_ + n) % N]; }
  void push(const T& item) { push() = item; }
  T& push() { return items_[tail_++ % N]; }  ///< what was there before
  void pop() { ++head_; }
  void clear() { head_ = tail_ = 0; }

 private:
  std::array<T, N> items_{};
  std::uint32_t head_ = 0, tail_ = 0;
};

}  // namespace fovea::engine
