// Lists of observers that are released by RAII.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace fovea {

/// The place of an observer in a list: its destructor takes the observer out. May outlive the list.
class [[nodiscard]] Subscription {
 public:
  Subscription() = default;
  explicit Subscription(std::function<void()> remove) : remove_(std::move(remove)) {}
  Subscription(Subscription&& other) noexcept : remove_(std::exchange(other.remove_, nullptr)) {}
  Subscription& operator=(Subscription&& other) noexcept {
    if (this != &other) {
      reset();
      remove_ = std::exchange(other.remove_, nullptr);
    }
    return *this;
  }
  ~Subscription() { reset(); }
  void reset() {
    if (const auto remove = std::exchange(remove_, nullptr)) remove();
  }
  explicit operator bool() const { return remove_ != nullptr; }

 private:
  std::function<void()> remove_;
};

/// Any number of observers, called in the order in which they were added. An observer may add and
/// remove observers, itself included, while it is called; a new one is not called in the same round.
/// @tparam T a pointer to an observer, or a function
template <class T>
class Observers {
 public:
  /// `changed` is called when the first observer has come, and when the last one has gone.
  explicit Observers(std::function<void()> changed = {}) : changed_(std::move(changed)) {
    list_->owner = this;
  }
  ~Observers() { list_->owner = nullptr; }
  Observers(const Observers&) = delete;
  Observers& operator=(const Observers&) = delete;

  Subscription add(T observer) {
    const std::uint64_t id = ++list_->last_id;
    list_->entries.push_back({id, std::move(observer)});
    list_->count_is(list_->count + 1);
    return Subscription([list = std::weak_ptr<List>(list_), id] {
      if (const auto l = list.lock()) l->remove(id);
    });
  }
  /// A look at one byte of this object, so that hot paths may ask.
  bool empty() const { return empty_; }
  /// Calls f(observer) for each observer until a call returns true.
  /// @return true if one did
  template <class F>
  bool any(F f) {
    const std::shared_ptr<List> list = list_;  // an observer may destroy the owner of the list
    struct Round {
      List& list;
      explicit Round(List& l) : list(l) { ++list.rounds; }
      ~Round() {
        if (--list.rounds == 0) list.tidy();
      }
    } round(*list);
    const std::size_t end = list->entries.size();
    for (std::size_t k = 0; k < end; ++k) {
      if (!list->entries[k].id) continue;
      T observer = list->entries[k].observer;  // the list may move when another one is added
      if (f(observer)) return true;
    }
    return false;
  }
  template <class F>
  void each(F f) {
    any([&f](T& observer) {
      f(observer);
      return false;
    });
  }

 private:
  struct Entry {
    std::uint64_t id;  // 0: removed
    T observer;
  };
  struct List {
    Observers* owner;  // null: it has ended
    std::vector<Entry> entries;
    std::size_t count = 0;
    unsigned rounds = 0;  // calls of any() that are under way
    std::uint64_t last_id = 0;
    void remove(std::uint64_t id) {
      const auto e = std::find_if(entries.begin(), entries.end(),
                                  [id](const Entry& entry) { return entry.id == id; });
      if (e == entries.end()) return;
      e->id = 0;
      if (rounds == 0) tidy();
      count_is(count - 1);
    }
    void count_is(std::size_t n) {
      count = n;
      if (owner && owner->empty_ != (n == 0)) {
        owner->empty_ = n == 0;
        if (owner->changed_) owner->changed_();
      }
    }
    void tidy() {
      std::erase_if(entries, [](const Entry& entry) { return entry.id == 0; });
    }
  };
  bool empty_ = true;
  std::function<void()> changed_;
  std::shared_ptr<List> list_ = std::make_shared<List>();
};

}  // namespace fovea
