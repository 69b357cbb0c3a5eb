// C++: exceptions through frames with destructors, virtual calls, casts at run time, containers,
// algorithms, closures, shared pointers, static objects.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <unordered_map>
#include <vector>

extern "C" {
#include "support.h"
}

namespace {

std::uint32_t seed = 2024;
std::uint32_t next() { return seed = seed * 1664525u + 1013904223u; }

int alive = 0;
struct Counted {
  std::string name;
  explicit Counted(std::string n) : name(std::move(n)) { ++alive; }
  Counted(const Counted& o) : name(o.name) { ++alive; }
  ~Counted() { --alive; }
};
Counted global("global");

struct Shape {
  virtual ~Shape() = default;
  virtual double area() const = 0;
  virtual std::string name() const { return "shape"; }
};
struct Named {
  virtual ~Named() = default;
  virtual int tag() const { return 7; }
  long padding = 12;
};
struct Square : Shape {
  double side;
  explicit Square(double s) : side(s) {}
  double area() const override { return side * side; }
  std::string name() const override { return "square"; }
};
struct Round : virtual Shape {
  double radius = 2;
  double area() const override { return 3.0 * radius * radius; }
};
struct Tagged : Round, Named {
  int tag() const override { return 9 + static_cast<int>(radius); }
  std::string name() const override { return "tagged " + Round::name(); }
};

struct Odd : std::runtime_error {
  int value;
  Odd(const std::string& what, int v) : std::runtime_error(what), value(v) {}
};

int dive(int depth, int how) {
  Counted here("frame " + std::to_string(depth));
  std::vector<Counted> some(static_cast<std::size_t>(depth % 3), here);
  if (depth == 0) {
    switch (how) {
      case 0:
        throw Odd("odd", 5);
      case 1:
        throw std::out_of_range("range");
      case 2:
        throw 42;
      case 3:
        throw std::string("a string");
      case 4:
        return static_cast<int>(std::vector<int>(3).at(static_cast<std::size_t>(how)));
      case 5:
        return std::stoi("no number");
      case 6:
        return static_cast<int>(std::string("abc").substr(9).size());
      case 7: {
        Shape* s = new Square(1);
        std::unique_ptr<Shape> owner(s);
        return dynamic_cast<Tagged&>(*s).tag();
      }
      case 8:
        return *new int[1u << 26];
      default:
        return how;
    }
  }
  try {
    return dive(depth - 1, how) + static_cast<int>(some.size());
  } catch (const Odd& e) {
    if (depth % 2) throw;
    throw Odd(std::string(e.what()) + "+", e.value + depth);
  } catch (int n) {
    throw n + depth;
  }
}

struct Fails {
  Counted first{"member"};
  Counted second;
  explicit Fails(bool now) : second(now ? throw Odd("constructor", 1) : "second") {}
};

template <typename T>
std::string joined(const T& items) {
  std::string out;
  for (const auto& i : items) out += (out.empty() ? "" : ",") + std::to_string(i);
  return out;
}

struct Greater {
  template <typename T>
  bool operator()(const T& a, const T& b) const {
    return b < a;
  }
};

int calls = 0;
const std::string& lazy() {
  static const std::string made = "made " + std::to_string(++calls);
  return made;
}

}  // namespace

int main() {
  say("%s %d\n", global.name.c_str(), alive);
  for (int how = 0; how < 10; ++how) {
    const int before = alive;
    try {
      say("returned %d", dive(6, how));
    } catch (const Odd& e) {
      say("Odd %s %d", e.what(), e.value);
    } catch (const std::logic_error& e) {
      say("logic %s", e.what());
    } catch (const std::bad_cast& e) {
      say("cast");
    } catch (const std::bad_alloc&) {
      say("memory");
    } catch (const std::string& s) {
      say("string %s", s.c_str());
    } catch (int n) {
      say("int %d", n);
    } catch (...) {
      say("else");
    }
    say(", alive %d\n", alive - before);
  }
  try {
    Fails a(false), b(true);
  } catch (const Odd& e) {
    say("%s, alive %d\n", e.what(), alive);
  }
  std::vector<std::unique_ptr<Shape>> shapes;
  for (int k = 0; k < 5; ++k)
    shapes.push_back(k % 2 ? std::unique_ptr<Shape>(new Square(k)) : std::make_unique<Tagged>());
  for (const auto& s : shapes) {
    const auto* t = dynamic_cast<const Named*>(s.get());
    const Shape& each = *s;
    say("%s %ld %d %d;", s->name().c_str(), static_cast<long>(s->area() * 100), t ? t->tag() : -1,
        typeid(each) == typeid(Square));
  }
  say("\n");
  std::vector<int> numbers(200);
  for (auto& n : numbers) n = static_cast<int>(next() >> 20) - 2048;
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  say("%d %d\n", static_cast<int>(numbers.size()),
      std::accumulate(numbers.begin(), numbers.end(), 0));
  std::stable_sort(numbers.begin(), numbers.end(), [](int a, int b) { return a % 10 < b % 10; });
  numbers.resize(20);
  say("%s\n", joined(numbers).c_str());
  std::map<std::string, int> words;
  std::unordered_map<std::uint32_t, std::string> table;
  std::set<int, Greater> high;
  for (int k = 0; k < 300; ++k) {
    const std::uint32_t v = next() >> 22;
    ++words[std::string(1 + v % 5, static_cast<char>('a' + v % 26))];
    table[v % 97] += static_cast<char>('A' + k % 26);
    high.insert(static_cast<int>(v));
    if (high.size() > 12) high.erase(std::prev(high.end()));
  }
  words.erase(words.begin(), words.lower_bound("c"));
  for (const auto& [w, n] : words) say("%s=%d ", w.c_str(), n);
  std::size_t letters = 0;
  for (std::uint32_t k = 0; k < 97; ++k) letters += table.count(k) ? table.at(k).size() * k : 0;
  say("\n%lu %s\n", static_cast<unsigned long>(letters), joined(high).c_str());
  std::string text;
  for (int k = 0; k < 40; ++k) text.insert(text.size() / 2, std::to_string(k * k));
  text.replace(3, 10, "...");
  say("%s %d %d\n", text.c_str(), static_cast<int>(text.find("81")), text < "5");
  auto shared = std::make_shared<Counted>("shared");
  std::weak_ptr<Counted> weak = shared;
  std::vector<std::function<int(int)>> steps;
  for (int k = 1; k < 5; ++k)
    steps.emplace_back(
        [k, shared](int v) { return v * k + static_cast<int>(shared->name.size()); });
  int v = 1;
  for (const auto& s : steps) v = s(v);
  say("%d %ld ", v, shared.use_count());
  steps.clear();
  shared.reset();
  say("%d\n%s %s %d\n", weak.expired(), lazy().c_str(), lazy().c_str(), calls);
  say("alive %d\n", alive);
  return 0;
}
