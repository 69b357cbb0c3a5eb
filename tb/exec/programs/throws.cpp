// C++: constructors before main, exceptions through frames, containers, streams, destructors at
// exit.
#include <cstddef>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

// libstdc++ refers to it; rdimon has none.
extern "C" int getentropy(void *, std::size_t) { return -1; }

namespace {

struct Noisy {
  const char *name;
  explicit Noisy(const char *n) : name(n) { std::cout << "made " << name << '\n'; }
  ~Noisy() { std::cout << "gone " << name << '\n'; }
};
Noisy global("global");

struct Shape {
  virtual ~Shape() = default;
  virtual double area() const = 0;
};
struct Square : Shape {
  double side;
  explicit Square(double s) : side(s) {}
  double area() const override {
    if (side < 0) throw std::domain_error("negative side");
    return side * side;
  }
};

__attribute__((noinline)) double sum(const std::vector<std::unique_ptr<Shape>> &shapes) {
  const Noisy local("local");
  double all = 0;
  for (const auto &s : shapes) all += s->area();
  return all;
}

}  // namespace

int main() {
  std::vector<std::unique_ptr<Shape>> shapes;
  for (int k = 1; k < 5; ++k) shapes.push_back(std::make_unique<Square>(1.5 * k));
  std::cout << "sum " << sum(shapes) << '\n';
  shapes.push_back(std::make_unique<Square>(-1));
  try {
    sum(shapes);
  } catch (const std::exception &e) {
    std::cout << "caught " << e.what() << '\n';
  }
  std::map<std::string, int> words;
  for (const char *w : {"one", "two", "one", "three", "two", "one"}) ++words[w];
  for (const auto &[word, n] : words) std::cout << word << ' ' << n << '\n';
  try {
    return std::stoi("no number");
  } catch (const std::invalid_argument &) {
    return 17;
  }
}
