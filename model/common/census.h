// All objects of a kind that exist at present.
#pragma once
#include <algorithm>
#include <vector>

namespace fovea {

/// Base of a class that keeps a list of its live objects, in order of construction. The tests compare
/// these lists with what the walk over the platform finds, so that nothing is left out in silence.
/// Objects of the simulation live on one thread.
template <class T>
class Census {
 public:
  static const std::vector<T*>& alive() { return list(); }

 protected:
  Census() { list().push_back(static_cast<T*>(this)); }
  ~Census() {
    auto& all = list();
    all.erase(std::find(all.begin(), all.end(), static_cast<T*>(this)));
  }
  Census(const Census&) = delete;
  Census& operator=(const Census&) = delete;

 private:
  static std::vector<T*>& list() {
    static auto* const all = new std::vector<T*>;  // outlives objects with static storage
    return *all;
  }
};

}  // namespace fovea
