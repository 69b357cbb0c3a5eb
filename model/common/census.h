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
  static std::vector<T*> alive() {
    std::vector<T*> out;
    for (Census* c : list()) out.push_back(static_cast<T*>(c));
    return out;
  }

 protected:
  Census() { list().push_back(this); }  // not yet a T
  ~Census() {
    auto& all = list();
    all.erase(std::find(all.begin(), all.end(), this));
  }
  Census(const Census&) = delete;
  Census& operator=(const Census&) = delete;

 private:
  static std::vector<Census*>& list() {
    static auto* const all = new std::vector<Census*>;  // outlives objects with static storage
    return *all;
  }
};

}  // namespace fovea
