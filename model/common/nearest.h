// The name that a user may have meant.
#pragma once
#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace fovea {

/// Letters to change, add or leave out.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (const char letter : a) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (letter != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// The same for dotted names of equally many parts: a part whose end was forgotten counts as one letter.
inline std::size_t name_distance(std::string_view a, std::string_view b) {
  if (std::count(a.begin(), a.end(), '.') != std::count(b.begin(), b.end(), '.')) return edit_distance(a, b);
  std::size_t sum = 0;
  for (bool more = true; more;) {
    const std::string_view x = a.substr(0, a.find('.')), y = b.substr(0, b.find('.'));
    const bool cut = !x.empty() && x != y && y.starts_with(x);
    sum += cut ? 1 : edit_distance(x, y);
    more = x.size() < a.size();
    if (more) {
      a.remove_prefix(x.size() + 1);
      b.remove_prefix(y.size() + 1);
    }
  }
  return sum;
}

/// The one of `names` that is nearest to `name`, the first of equally near ones; empty if none is similar.
template <class Names>
std::string nearest_name(std::string_view name, const Names& names) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const auto& candidate : names)
    if (const std::size_t d = name_distance(name, candidate); d < least) {
      least = d;
      best = candidate;
    }
  return best;
}

}  // namespace fovea
