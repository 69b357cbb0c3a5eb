// Call stacks of the program, followed from its branches (decision 0021).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "model/common/observers.h"

namespace fovea::cpu {

/// Follows calls, returns and everything that is neither, for each of the program's stacks: the clocks
/// between two branches belong to the function that is on top. A stack is known by the range of the
/// stack pointer; an exception is a stack of its own until it returns. All addresses are without the
/// Thumb bit.
class CallStacks {
 public:
  struct Function {
    std::uint32_t begin = 0, end = 0;
  };
  /// The program's functions, sorted and without overlaps; before the first instruction. Without them
  /// calls and returns are followed, but no tail calls.
  void set_functions(std::vector<Function> functions);
  bool same_function(std::uint32_t a, std::uint32_t b) const;

  /// The program starts, or starts again.
  void start(std::uint64_t cycle, std::uint32_t pc);
  /// A branch with link at `from`, which will return to `back`. @param sp the stack pointer
  void call(std::uint64_t cycle, std::uint32_t from, std::uint32_t target, std::uint32_t back,
            std::uint32_t sp);
  /// A branch to an address that was computed: a return, a tail call, a table of cases, another task.
  /// @param sp the stack pointer after it
  void jump(std::uint64_t cycle, std::uint32_t target, std::uint32_t sp);
  /// A plain branch from one function to another.
  void tail_call(std::uint64_t cycle, std::uint32_t target);
  /// @param back where the program was interrupted, with stack pointer `sp`
  void exception(std::uint64_t cycle, std::uint32_t vector, std::uint32_t back, std::uint32_t sp);
  void exception_return(std::uint64_t cycle, std::uint32_t target, std::uint32_t sp);
  /// The stack pointer was this low.
  void reached(std::uint32_t sp) {
    Stack& s = stacks_[current_];
    if (sp < s.low && s.base - sp < kFarthest) s.low = sp;
  }

  /// Clocks up to here are counted or not, as before; those from here on are, or not.
  void count(std::uint64_t cycle, bool on) { enter(cycle, on, section_); }
  /// The same; those from here on belong to a section of the run.
  void enter(std::uint64_t cycle, bool on, std::size_t section) {
    elapse(cycle);
    if (on != counting_ || section != section_) take();
    counting_ = on;
    section_ = section;
  }

  /// Receives which functions were active in each stretch between two branches.
  class Watcher {
   public:
    virtual ~Watcher() = default;
    /// @param functions outermost first, with those that an exception has interrupted
    /// @param same so many of them, from the outermost one on, are those of the stretch before; more may be alike
    virtual void ran(std::span<const std::uint32_t> functions, std::size_t same, std::uint64_t begin,
                     std::uint64_t end) = 0;
  };
  /// Also while nothing is counted. The watcher must outlive the subscription.
  Subscription watch(Watcher& watcher) { return watchers_.add(&watcher); }

  /// A call path is that of the caller and one function more, so all paths are a tree: written out, those of a deep
  /// recursion would need memory by the square of its depth.
  struct Path {
    std::uint32_t caller = 0;    ///< number of its path, which is lower than this one's
    std::uint32_t function = 0;  ///< address of its first instruction
    std::uint64_t clocks = 0;    ///< in the function itself
  };
  /// What was counted. Number 0 is the path without a function; others may have no clocks of their own.
  std::vector<Path> paths() const;
  /// The same paths with all clocks of a section, counted or not.
  std::vector<Path> paths_of(std::size_t section) const;
  struct Call {
    std::uint32_t from = 0, to = 0;
    std::uint64_t count = 0, clocks = 0;  ///< clocks include those of further calls
  };
  /// By address.
  std::vector<Call> calls() const;
  /// Ranges of the stack pointer, as seen at branches; without those of exceptions.
  struct Range {
    std::uint32_t base = 0, low = 0;
    std::uint32_t function = 0;  ///< the outermost one
  };
  std::vector<Range> ranges() const;

 private:
  static constexpr std::uint32_t kFarthest = 1u << 20;  // bytes that a stack may have
  static constexpr std::size_t kSites = 1024, kMostStacks = 256;
  struct Node {
    std::uint32_t parent, function;
    std::uint64_t clocks = 0;  // since the last take()
    std::uint32_t depth = 0;   // number of functions of the path
  };
  struct Taken {
    std::size_t section;
    bool counted;
    std::vector<std::uint64_t> clocks;  // by node
  };
  struct Counted {
    Call call;
    unsigned depth = 0;  // activations; a recursive call counts once
  };
  struct Frame {
    std::uint32_t node;  // of the caller
    std::uint32_t back, sp;
    Function function;   // of the caller
    Counted* counted;
    std::uint64_t ran;   // of the stack, at the call
  };
  struct Stack {
    std::uint32_t base = 0, low = 0;
    std::uint32_t node = 0;  // on top
    Function function;       // the same
    std::vector<Frame> frames;
    std::uint64_t ran = 0;   // counted clocks
    bool exception = false, free = false;
    struct Resume {
      std::uint32_t pc, sp;
    };
    std::optional<Resume> resume;  // interrupted here
    bool contains(std::uint32_t sp) const { return sp >= low && sp <= base; }
  };
  struct Site {
    std::uint32_t from = 1, node = 0, target = 0, child = 0;
    Function function;
    Counted* counted = nullptr;
  };

  void elapse(std::uint64_t cycle) {
    if (!watchers_.empty()) [[unlikely]]
      tell(cycle);
    nodes_[stacks_[current_].node].clocks += cycle - last_;
    if (counting_) stacks_[current_].ran += cycle - last_;
    last_ = cycle;
  }
  void tell(std::uint64_t cycle);
  void take();
  template <class F>
  std::vector<Path> paths_if(F wanted) const;
  std::size_t show(std::uint32_t node, std::size_t at);
  Function function_at(std::uint32_t address) const;
  std::uint32_t child(std::uint32_t node, std::uint32_t function);
  void pop(Stack& s);
  void replace_top(std::uint32_t target);
  std::size_t new_stack(std::uint32_t target, std::uint32_t sp, bool exception);
  std::optional<std::size_t> stack_at(std::uint32_t sp) const;
  bool unwind(Stack& s, std::uint32_t target, std::uint32_t sp);
  bool long_jump(Stack& s, std::uint32_t target, std::uint32_t sp);
  void leave_exception();

  std::vector<Function> functions_;
  std::vector<Node> nodes_ = {{0, 0, 0}};  // the first one is the root of all stacks
  std::unordered_map<std::uint64_t, std::uint32_t> children_;
  std::unordered_map<std::uint64_t, Counted> calls_;
  std::array<Site, kSites> sites_;
  std::vector<Stack> stacks_ = std::vector<Stack>(1);
  std::size_t current_ = 0;
  std::vector<std::size_t> interrupted_;  // stacks, innermost last
  std::uint64_t last_ = 0;
  bool counting_ = true;
  std::size_t section_ = 0;
  std::vector<Taken> taken_;
  Observers<Watcher*> watchers_;
  std::vector<std::uint32_t> active_, active_nodes_;  // for it: the functions that it was told of, and their nodes
};

}  // namespace fovea::cpu
