#include "sw/fovea/compare/matching.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sw/fovea/results/outputs.h"

namespace fovea::regression {
namespace {

using FunctionNames = std::map<FunctionKey, FunctionKey>;

/// Instructions by function, of all phases.
std::map<FunctionKey, double> instructions_of(const Attribution& a) {
  std::map<FunctionKey, double> out;
  for (const auto* rows : {&a.rows, &a.startup})
    for (const AttributionRow& r : *rows) out[r.key()] += static_cast<double>(r.instructions);
  return out;
}

std::multiset<std::pair<std::string, std::string>> codes_of(const std::set<CodePlace>& places) {
  std::multiset<std::pair<std::string, std::string>> out;
  for (const CodePlace& p : places) out.insert({p.size, p.code});
  return out;
}

/// Pairs of `gone` and `fresh` for which `same` holds for no other pair of either.
template <class Key, class F>
void pair_up(std::set<Key>& gone, std::set<Key>& fresh, std::map<Key, Key>& names, F same) {
  for (auto g = gone.begin(); g != gone.end();) {
    const Key* found = nullptr;
    bool alone = true;
    for (const Key& f : fresh)
      if (same(*g, f)) alone = alone && !found, found = &f;
    for (const Key& other : gone) alone = alone && (other == *g || !found || !same(other, *found));
    if (!found || !alone) {
      ++g;
      continue;
    }
    names[*g] = *found;
    fresh.erase(Key(*found));
    g = gone.erase(g);
  }
}

FunctionNames renamed_functions(const Attribution& before, const Attribution& after) {
  const auto a = instructions_of(before), b = instructions_of(after);
  std::set<FunctionKey> gone, fresh;
  for (const auto& [key, n] : a)
    if (!b.contains(key)) gone.insert(key);
  for (const auto& [key, n] : b)
    if (!a.contains(key)) fresh.insert(key);
  FunctionNames names;
  pair_up(gone, fresh, names, [&](const FunctionKey& x, const FunctionKey& y) {
    const auto p = before.places.find(x), q = after.places.find(y);
    return p != before.places.end() && q != after.places.end() && codes_of(p->second) == codes_of(q->second);
  });
  pair_up(gone, fresh, names, [](const FunctionKey& x, const FunctionKey& y) { return x.first == y.first; });
  pair_up(gone, fresh, names, [&](const FunctionKey& x, const FunctionKey& y) {
    const auto in_file = [&](const std::set<FunctionKey>& keys) {
      return std::count_if(keys.begin(), keys.end(), [&](const FunctionKey& k) { return k.second == x.second; });
    };
    return !x.second.empty() && x.second == y.second && in_file(gone) == 1 && in_file(fresh) == 1;
  });
  return names;
}

std::map<std::string, std::string> renamed_objects(const Attribution& before, const Attribution& after) {
  std::map<std::string, ObjectPlace> a, b;
  for (const ObjectPlace& o : before.objects) a[o.name] = o;
  for (const ObjectPlace& o : after.objects) b[o.name] = o;
  std::set<std::string> gone, fresh;
  for (const auto& [name, o] : a)
    if (!b.contains(name)) gone.insert(name);
  for (const auto& [name, o] : b)
    if (!a.contains(name)) fresh.insert(name);
  std::map<std::string, std::string> names;
  const auto same_size = [&](const std::string& x, const std::string& y) { return a[x].size == b[y].size; };
  pair_up(gone, fresh, names,
          [&](const std::string& x, const std::string& y) { return same_size(x, y) && a[x].address == b[y].address; });
  pair_up(gone, fresh, names, same_size);
  return names;
}

}  // namespace

Attribution with_names_of(const Attribution& before, const Attribution& after) {
  Attribution out = before;
  const FunctionNames functions = renamed_functions(before, after);
  const auto objects = renamed_objects(before, after);
  const auto name = [&](FunctionKey& key) {
    if (const auto found = functions.find(key); found != functions.end()) key = found->second;
  };
  const auto object = [&](std::string& region) {
    if (const auto found = objects.find(region); found != objects.end()) region = found->second;
  };
  for (auto* rows : {&out.rows, &out.startup})
    for (AttributionRow& r : *rows) {
      FunctionKey key = r.key();
      name(key);
      std::tie(r.function, r.file) = key;
      for (FunctionKey& h : r.holders) name(h);
      object(r.region);
    }
  for (CallPath& p : out.paths)
    for (FunctionKey& f : p.functions) name(f);
  for (ObjectPlace& o : out.objects) object(o.name);
  out.places.clear();
  for (const auto& [key, places] : before.places) {
    FunctionKey now = key;
    name(now);
    out.places[now] = places;
  }
  return out;
}

std::string moved_objects_text(const Attribution& before, const Attribution& after) {
  std::map<std::string, std::uint64_t> places;
  for (const ObjectPlace& o : before.objects) places[o.name] = o.address;
  std::map<std::int64_t, std::vector<std::string>> moved;  // by distance; in the order of the addresses
  for (const ObjectPlace& o : after.objects)
    if (const auto was = places.find(o.name); was != places.end() && was->second != o.address)
      moved[static_cast<std::int64_t>(o.address) - static_cast<std::int64_t>(was->second)].push_back(o.name);
  std::vector<std::pair<std::int64_t, std::vector<std::string>>> order(moved.begin(), moved.end());
  // What moved alone is a move; the many only made room.
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& x, const auto& y) { return x.second.size() < y.second.size(); });
  std::string out;
  constexpr std::size_t kMost = 2;
  for (std::size_t k = 0; k < std::min(kMost, order.size()); ++k) {
    const auto& [distance, names] = order[k];
    const std::string more = names.size() > 1 ? fmt::format(" and {} more", names.size() - 1) : "";
    out += fmt::format("{}{}{} moved by {}{} bytes", out.empty() ? "" : ", ", names.front(), more,
                       distance < 0 ? "-" : "+", app::grouped(static_cast<std::uint64_t>(std::abs(distance))));
  }
  return out;
}

CodeChange code_change(const Attribution& before, const Attribution& after, const FunctionKey& key) {
  const auto a = before.places.find(key), b = after.places.find(key);
  if (before.places.empty() || after.places.empty()) return {};
  // One run alone executes it: it is called by other code.
  if (a == before.places.end() || b == after.places.end())
    return {a != before.places.end() || b != after.places.end(), false};
  return {true, codes_of(a->second) != codes_of(b->second)};
}

}  // namespace fovea::regression
