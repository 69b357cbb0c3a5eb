#include "model/cpu/core/call_stacks.h"

#include <algorithm>
#include <set>
#include <utility>

namespace fovea::cpu {
namespace {

constexpr std::uint64_t pair(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; }

}  // namespace

void CallStacks::set_functions(std::vector<Function> functions) { functions_ = std::move(functions); }

CallStacks::Function CallStacks::function_at(std::uint32_t address) const {
  const auto above = std::upper_bound(
      functions_.begin(), functions_.end(), address,
      [](std::uint32_t a, const Function& f) { return a < f.begin; });
  if (above != functions_.begin() && address < std::prev(above)->end) return *std::prev(above);
  return {address, address};
}

bool CallStacks::same_function(std::uint32_t a, std::uint32_t b) const {
  const Function f = function_at(a);
  return f.begin == f.end || (b >= f.begin && b < f.end);
}

std::uint32_t CallStacks::child(std::uint32_t node, std::uint32_t function) {
  const auto [place, added] =
      children_.try_emplace(pair(node, function), static_cast<std::uint32_t>(nodes_.size()));
  if (added) nodes_.push_back({node, function, 0, nodes_[node].depth + 1});
  return place->second;
}

/// Makes the functions of a path those that are active from position `at` on, and only looks at those that were others:
/// a node that is at its place there has its whole path below it. @return the first position that was changed
std::size_t CallStacks::show(std::uint32_t node, std::size_t at) {
  std::size_t k = at + nodes_[node].depth;
  if (active_.size() < k) {
    active_.resize(k);
    active_nodes_.resize(k);  // node 0 is at no place
  }
  for (; k > at && active_nodes_[k - 1] != node; --k) {
    active_[k - 1] = nodes_[node].function;
    active_nodes_[k - 1] = node;
    node = nodes_[node].parent;
  }
  return k;
}

void CallStacks::tell(std::uint64_t cycle) {
  std::size_t size = 0, same = active_.size();
  const auto add = [&](std::uint32_t node) {
    const std::size_t end = size + nodes_[node].depth, kept = show(node, size);
    if (kept < end) same = std::min(same, kept);
    size = end;
  };
  for (const std::size_t k : interrupted_) add(stacks_[k].node);
  add(stacks_[current_].node);
  active_.resize(size);
  active_nodes_.resize(size);
  same = std::min(same, size);
  watchers_.each([&](Watcher* w) { w->ran(active_, same, last_, cycle); });
}

/// Stacks of the program before are forgotten, but not what was counted.
void CallStacks::start(std::uint64_t cycle, std::uint32_t pc) {
  if (nodes_.size() == 1) last_ = cycle;
  else elapse(cycle);
  for (Stack& s : stacks_)
    while (!s.frames.empty()) pop(s);
  stacks_.clear();
  interrupted_.clear();
  current_ = new_stack(pc, 0, false);
}

std::size_t CallStacks::new_stack(std::uint32_t target, std::uint32_t sp, bool exception) {
  std::size_t at = 0;
  while (at < stacks_.size() && !stacks_[at].free) ++at;
  if (at == stacks_.size()) {
    if (at >= kMostStacks) {  // the oldest one that nothing returns to
      at = 0;
      while (at < stacks_.size() &&
             (at == current_ || std::count(interrupted_.begin(), interrupted_.end(), at)))
        ++at;
      if (at == stacks_.size()) {  // the outermost one that waits is given up
        at = interrupted_.front() == current_ && interrupted_.size() > 1 ? interrupted_[1]
                                                                         : interrupted_.front();
        std::erase(interrupted_, at);
      }
      while (!stacks_[at].frames.empty()) pop(stacks_[at]);
    } else {
      stacks_.emplace_back();
    }
  }
  Stack& s = stacks_[at];
  s = {};
  s.base = s.low = sp;
  s.exception = exception;
  s.function = function_at(target);
  s.node = child(0, s.function.begin);
  return at;
}

void CallStacks::pop(Stack& s) {
  const Frame& f = s.frames.back();
  if (--f.counted->depth == 0) f.counted->call.clocks += s.ran - f.ran;
  s.node = f.node;
  s.function = f.function;
  s.frames.pop_back();
}

void CallStacks::call(std::uint64_t cycle, std::uint32_t from, std::uint32_t target,
                      std::uint32_t back, std::uint32_t sp) {
  elapse(cycle);
  if (!stacks_[current_].contains(sp)) {
    Stack& s = stacks_[current_];
    const auto other = s.exception ? std::nullopt : stack_at(sp);
    if (other) {
      current_ = *other;
    } else if (sp < s.low && s.base - sp < kFarthest) {
      s.low = sp;
    } else if (s.frames.empty() || s.exception) {
      s.base = s.low = sp;  // the program has set its stack pointer
    } else {
      current_ = new_stack(from, sp, false);
    }
  }
  Stack& s = stacks_[current_];
  Site& site = sites_[(from / 2 + s.node * 37u) % kSites];
  if (site.from != from || site.node != s.node || site.target != target) {
    const Function f = function_at(target);
    Counted& counted = calls_[pair(from, f.begin)];
    counted.call.from = from;
    counted.call.to = f.begin;
    site = {from, s.node, target, child(s.node, f.begin), f, &counted};
  }
  site.counted->call.count += counting_;
  ++site.counted->depth;
  s.frames.push_back({s.node, back, sp, s.function, site.counted, s.ran});
  s.node = site.child;
  s.function = site.function;
}

void CallStacks::replace_top(std::uint32_t target) {
  Stack& s = stacks_[current_];
  s.function = function_at(target);
  s.node = child(nodes_[s.node].parent, s.function.begin);
}

void CallStacks::tail_call(std::uint64_t cycle, std::uint32_t target) {
  elapse(cycle);
  replace_top(target);
}

std::optional<std::size_t> CallStacks::stack_at(std::uint32_t sp) const {
  for (std::size_t k = 0; k < stacks_.size(); ++k)
    if (k != current_ && !stacks_[k].free && !stacks_[k].exception && stacks_[k].contains(sp))
      return k;
  return std::nullopt;
}

/// Returns to the frame that expects this, and drops those above it.
bool CallStacks::unwind(Stack& s, std::uint32_t target, std::uint32_t sp) {
  const auto expects = [&](const Frame& f) { return f.back == target && f.sp == sp; };
  const auto found = std::find_if(s.frames.rbegin(), s.frames.rend(), expects);
  if (found == s.frames.rend()) return false;
  for (auto n = found - s.frames.rbegin() + 1; n > 0; --n) pop(s);
  return true;
}

/// A jump out of functions whose part of the stack it frees, into a function that called them.
bool CallStacks::long_jump(Stack& s, std::uint32_t target, std::uint32_t sp) {
  const auto expects = [&](const Frame& f) {
    return f.sp <= sp && target >= f.function.begin && target < f.function.end;
  };
  const auto found = std::find_if(s.frames.rbegin(), s.frames.rend(), expects);
  if (found == s.frames.rend() || target == found->function.begin) return false;
  // Of several activations of the function, the one whose part of the stack begins above `sp`.
  auto keep = found;
  for (auto k = found; k != s.frames.rend() && k->sp <= sp; ++k)
    if (expects(*k)) keep = k;
  for (auto n = keep - s.frames.rbegin() + 1; n > 0; --n) pop(s);
  return true;
}

void CallStacks::jump(std::uint64_t cycle, std::uint32_t target, std::uint32_t sp) {
  elapse(cycle);
  Stack& s = stacks_[current_];
  if (!s.frames.empty() && s.frames.back().back == target && s.frames.back().sp == sp) return pop(s);
  const bool within = target >= s.function.begin && target < s.function.end;
  // A table of cases, or a switch of tasks; but the function may have called itself.
  if (within && (s.frames.empty() || sp <= s.frames.back().sp)) {
    if (!s.exception && !s.contains(sp)) current_ = stack_at(sp).value_or(current_);
    return;
  }
  if (unwind(s, target, sp)) return;
  for (std::size_t k = 0; k < stacks_.size(); ++k)
    if (k != current_ && !stacks_[k].free && unwind(stacks_[k], target, sp)) {
      current_ = k;
      return;
    }
  for (std::size_t k = 0; k < stacks_.size(); ++k)
    if (const auto& r = stacks_[k].resume; r && r->pc == target && r->sp == sp) {
      stacks_[k].resume.reset();
      current_ = k;
      return;
    }
  if (long_jump(s, target, sp)) return;
  // A function that has freed its part of the stack goes on as another one.
  const bool freed = s.frames.empty() ? s.base == sp || s.base == 0 : s.frames.back().sp == sp;
  if (freed || s.exception) return replace_top(target);
  current_ = new_stack(target, sp, false);
}

void CallStacks::exception(std::uint64_t cycle, std::uint32_t vector, std::uint32_t back,
                           std::uint32_t sp) {
  elapse(cycle);
  stacks_[current_].resume = {back, sp};
  reached(sp);
  interrupted_.push_back(current_);
  current_ = new_stack(vector, 0, true);
}

void CallStacks::leave_exception() {
  Stack& s = stacks_[current_];
  if (s.exception) {
    while (!s.frames.empty()) pop(s);
    s.free = true;
  }
}

void CallStacks::exception_return(std::uint64_t cycle, std::uint32_t target, std::uint32_t sp) {
  if (interrupted_.empty()) return jump(cycle, target, sp);
  elapse(cycle);
  // A data abort returns to the instruction or the one after it.
  const auto expects = [&](const Stack& s) {
    return s.resume && target - s.resume->pc + 8 <= 12 && s.resume->sp == sp;
  };
  const auto resume = [&](std::size_t k) {
    leave_exception();
    stacks_[k].resume.reset();
    current_ = k;
  };
  const auto at = std::find_if(interrupted_.rbegin(), interrupted_.rend(),
                               [&](std::size_t k) { return expects(stacks_[k]); });
  if (at != interrupted_.rend()) {
    const std::size_t k = *at;
    interrupted_.erase(std::prev(at.base()), interrupted_.end());
    return resume(k);
  }
  // Another task than the one that was interrupted.
  interrupted_.pop_back();
  for (std::size_t k = 0; k < stacks_.size(); ++k) {
    if (stacks_[k].free) continue;
    if (expects(stacks_[k])) return resume(k);
    if (!stacks_[k].exception && unwind(stacks_[k], target, sp)) {
      leave_exception();
      current_ = k;
      return;
    }
  }
  leave_exception();
  current_ = new_stack(target, sp, false);
}

/// The clocks of the nodes go to the section that was current.
void CallStacks::take() {
  auto to = std::find_if(taken_.begin(), taken_.end(),
                         [this](const Taken& t) { return t.section == section_ && t.counted == counting_; });
  if (to == taken_.end()) to = taken_.insert(to, {section_, counting_, {}});
  to->clocks.resize(nodes_.size());
  for (std::size_t n = 1; n < nodes_.size(); ++n) to->clocks[n] += std::exchange(nodes_[n].clocks, 0);
}

template <class F>
std::vector<CallStacks::Path> CallStacks::paths_if(F wanted) const {
  std::vector<Path> out(nodes_.size());
  for (std::size_t n = 1; n < nodes_.size(); ++n) {
    out[n] = {nodes_[n].parent, nodes_[n].function, wanted(section_, counting_) ? nodes_[n].clocks : 0};
    for (const Taken& t : taken_)
      if (n < t.clocks.size() && wanted(t.section, t.counted)) out[n].clocks += t.clocks[n];
  }
  return out;
}

std::vector<CallStacks::Path> CallStacks::paths() const {
  return paths_if([](std::size_t, bool counted) { return counted; });
}

std::vector<CallStacks::Path> CallStacks::paths_of(std::size_t section) const {
  return paths_if([section](std::size_t of, bool) { return of == section; });
}

std::vector<CallStacks::Call> CallStacks::calls() const {
  std::vector<Call> out;
  for (const auto& [key, counted] : calls_) {
    if (counted.call.count == 0 && counted.call.clocks == 0) continue;
    out.push_back(counted.call);
  }
  // Calls that have not returned; of a recursive one the outermost, which comes first.
  std::set<const Counted*> seen;
  for (const Stack& s : stacks_)
    for (const Frame& f : s.frames) {
      if (!seen.insert(f.counted).second) continue;
      for (Call& c : out)
        if (c.from == f.counted->call.from && c.to == f.counted->call.to) c.clocks += s.ran - f.ran;
    }
  std::sort(out.begin(), out.end(), [](const Call& a, const Call& b) {
    return pair(a.from, a.to) < pair(b.from, b.to);
  });
  return out;
}

std::vector<CallStacks::Range> CallStacks::ranges() const {
  std::vector<Range> out;
  for (const Stack& s : stacks_)
    if (!s.free && !s.exception && s.base != 0)
      out.push_back({s.base, s.low,
                     s.frames.empty() ? s.function.begin : s.frames.front().function.begin});
  std::sort(out.begin(), out.end(), [](const Range& a, const Range& b) { return a.base < b.base; });
  return out;
}

}  // namespace fovea::cpu
