// Parameters: each is declared once, with key, unit, default, range, description and origin.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/census.h"
#include "model/common/check.h"
#include "model/common/units.h"

namespace fovea {

/// Where a default value comes from. kSourced: a public document about this chip. kFamily: a public
/// document about a sister chip only. kCalibrated: fitted to a measurement. kAssumed: no public
/// source. kChoice: the user's free choice, which needs no source.
enum class Origin { kSourced, kFamily, kCalibrated, kAssumed, kChoice };
std::string_view to_string(Origin origin);

/// Interval in which the chip's true figure is believed to lie, and the reason for it. Required for
/// the origins kFamily and kAssumed and forbidden for the others. It is usually narrower than the
/// allowed range, which only limits the input. `low` and `high` are written as a user would write
/// them; for a parameter with words, they are the first and the last word of a part of the word
/// list.
struct Belief {
  std::string low, high, reason;
  bool empty() const { return low.empty(); }
};

class ParamGroup;

class ParamBase {
 public:
  ParamBase(ParamGroup& group, std::string name, std::string sentence, Origin origin,
            std::string source, Belief belief = {});
  virtual ~ParamBase() = default;
  ParamBase(const ParamBase&) = delete;
  ParamBase& operator=(const ParamBase&) = delete;

  const std::string& key() const { return key_; }
  const std::string& sentence() const { return sentence_; }
  Origin origin() const { return origin_; }
  const std::string& source() const { return source_; }
  const Belief& belief() const { return belief_; }
  /// True once set() was called: the value was given by the user and is not the default.
  bool user_set() const { return user_set_; }
  /// Sets the value from its text with unit. @throws UserError that says what is allowed; the
  /// caller adds the key
  void set(std::string_view text) {
    parse(text);
    user_set_ = true;
  }

  /// A condition under which the value has an effect. `condition` completes the sentence "KEY has
  /// an effect only with ..."; `deciders` are the parameters that `effective` reads.
  struct Effect {
    std::string condition;
    std::vector<const ParamBase*> deciders;
    std::function<bool()> effective;
  };
  /// Declares a condition. Without a declaration, the value always has an effect.
  void matters_only(std::string condition, std::vector<const ParamBase*> deciders,
                    std::function<bool()> effective) {
    effects_.push_back({std::move(condition), std::move(deciders), std::move(effective)});
  }
  const std::vector<Effect>& effects() const { return effects_; }

  virtual std::string text() const = 0;  ///< the value with its unit, which set() accepts again
  virtual std::string default_text() const = 0;
  virtual std::string unit() const = 0;
  virtual std::string allowed() const = 0;  ///< the allowed range or the list of words

 protected:
  virtual void parse(std::string_view text) = 0;
  /// Orders the values: numbers by size, words by their position in the list.
  virtual double rank() const = 0;
  /// To be called at the end of each constructor. Checks that a belief interval exists exactly if
  /// the origin requires one, that its ends are allowed values, and that the default lies between
  /// them.
  void check_belief();

 private:
  std::string key_, sentence_, source_;
  Belief belief_;
  Origin origin_;
  std::vector<Effect> effects_;
  bool user_set_ = false;
};

/// An integer with a unit. Times are stored in picoseconds, sizes in bytes, frequencies in hertz.
class IntParam : public ParamBase {
 public:
  enum class Unit { kCount, kCycles, kBytes, kTime, kHertz };
  IntParam(ParamGroup& group, std::string name, Unit unit, std::uint64_t def, std::uint64_t min,
           std::uint64_t max, std::string sentence, Origin origin, std::string source,
           Belief belief = {});
  std::uint64_t operator()() const { return value_; }
  operator std::uint64_t() const { return value_; }
  std::string text() const override { return format(value_); }
  std::string default_text() const override { return format(default_); }
  std::string unit() const override;
  std::string allowed() const override;

 protected:
  void parse(std::string_view text) override;
  double rank() const override { return static_cast<double>(value_); }

 private:
  std::string format(std::uint64_t v) const;
  Unit unit_;
  std::uint64_t value_, default_, min_, max_;
};

/// A real number. Its unit ("deg", "px", or "" for none) is written directly after the number.
class RealParam : public ParamBase {
 public:
  RealParam(ParamGroup& group, std::string name, std::string unit, double def, double min,
            double max, std::string sentence, Origin origin, std::string source,
            Belief belief = {});
  double operator()() const { return value_; }
  std::string text() const override;
  std::string default_text() const override;
  std::string unit() const override { return unit_; }
  std::string allowed() const override;

 protected:
  void parse(std::string_view text) override;
  double rank() const override { return value_; }

 private:
  std::string unit_;
  double value_, default_, min_, max_;
};

/// A list of numbers without unit, written `[a, b, c]`; its length must be one of `sizes`.
class ListParam : public ParamBase {
 public:
  ListParam(ParamGroup& group, std::string name, std::vector<double> def,
            std::vector<std::size_t> sizes, std::string sentence, Origin origin,
            std::string source);
  const std::vector<double>& operator()() const { return value_; }
  std::string text() const override;
  std::string default_text() const override;
  std::string unit() const override { return "list"; }
  std::string allowed() const override;

 protected:
  void parse(std::string_view text) override;
  double rank() const override { return 0; }

 private:
  std::vector<double> value_, default_;
  std::vector<std::size_t> sizes_;
};

class BoolParam : public ParamBase {
 public:
  BoolParam(ParamGroup& group, std::string name, bool def, std::string sentence, Origin origin,
            std::string source, Belief belief = {});
  bool operator()() const { return value_; }
  std::string text() const override { return value_ ? "true" : "false"; }
  std::string default_text() const override { return default_ ? "true" : "false"; }
  std::string unit() const override { return "bool"; }
  std::string allowed() const override { return "true, false"; }

 protected:
  void parse(std::string_view text) override;
  double rank() const override { return value_; }

 private:
  bool value_, default_;
};

/// One word out of a list.
class EnumParam : public ParamBase {
 public:
  EnumParam(ParamGroup& group, std::string name, std::string def, std::vector<std::string> words,
            std::string sentence, Origin origin, std::string source, Belief belief = {});
  const std::string& operator()() const { return value_; }
  bool is(std::string_view word) const { return value_ == word; }
  std::size_t index() const;
  std::string text() const override { return value_; }
  std::string default_text() const override { return default_; }
  std::string unit() const override { return "word"; }
  std::string allowed() const override;

 protected:
  void parse(std::string_view text) override;
  double rank() const override { return static_cast<double>(index()); }

 private:
  std::string value_, default_;
  std::vector<std::string> words_;
};

/// Free text, for example a file name.
class TextParam : public ParamBase {
 public:
  TextParam(ParamGroup& group, std::string name, std::string def, std::string sentence,
            std::string allowed = "text");
  const std::string& operator()() const { return value_; }
  std::string text() const override { return value_; }
  std::string default_text() const override { return default_; }
  std::string unit() const override { return "text"; }
  std::string allowed() const override { return allowed_; }

 protected:
  void parse(std::string_view text) override { value_ = text; }
  double rank() const override { return 0; }

 private:
  std::string value_, default_, allowed_;
};

/// The parameters of a block; `prefix` is the block's dotted name ("ddr", "cpu.dcache").
class ParamGroup : public Census<ParamGroup> {
 public:
  explicit ParamGroup(std::string prefix) : prefix_(std::move(prefix)) {}
  ParamGroup(const ParamGroup&) = delete;
  ParamGroup& operator=(const ParamGroup&) = delete;
  const std::string& prefix() const { return prefix_; }
  const std::vector<ParamBase*>& params() const { return params_; }
  const std::vector<ParamGroup*>& parts() const { return parts_; }

 protected:
  /// A group of parts of the block, such as the caches of a core; declared with this one.
  void add_part(ParamGroup& part) { parts_.push_back(&part); }

 private:
  friend class ParamBase;
  std::string prefix_;
  std::vector<ParamBase*> params_;
  std::vector<ParamGroup*> parts_;
};

/// The groups of a chip or a board, in the order in which users see them. A member declares its group
/// by its type: `Declared<UartParams> uart{*this};`.
class ParamTree {
 public:
  ParamTree() = default;
  ParamTree(const ParamTree&) = delete;
  ParamTree& operator=(const ParamTree&) = delete;
  void add(ParamGroup& group) { groups_.push_back(&group); }
  void add(const ParamTree& part) {
    groups_.insert(groups_.end(), part.groups_.begin(), part.groups_.end());
  }
  const std::vector<ParamGroup*>& groups() const { return groups_; }
  inline void declare(class ParamSet& set) const;

 private:
  std::vector<ParamGroup*> groups_;
};

/// A member of a ParamTree: a group, or the tree of a part.
template <class Group>
struct Declared : Group {
  template <class... Args>
  Declared(ParamTree& tree, Args&&... args) : Group(std::forward<Args>(args)...) {
    tree.add(static_cast<Group&>(*this));
  }
};

/// All parameters of a run, found by their keys.
class ParamSet {
 public:
  void add(ParamGroup& group);
  /// Adds this group, but none of the groups of its parts.
  void add_alone(ParamGroup& group);
  /// Removes a parameter that has no effect in this command, so that setting it is an error.
  void remove(std::string_view key) {
    std::erase_if(all_, [&](const ParamBase* p) { return p->key() == key; });
  }
  const std::vector<ParamBase*>& all() const { return all_; }
  ParamBase* find(std::string_view key) const;
  /// Declares a key that belongs to another command. If a user sets it here, or a similar key
  /// that is unknown, the error message says so with `hint` ("is a key of ...").
  void add_foreign(std::string key, std::string hint) { foreign_.emplace(std::move(key), hint); }
  /// The known or foreign key that is nearest to `key` by edit distance; empty if none is similar.
  /// A common prefix that ends with a dot is not compared.
  std::string nearest(std::string_view key) const;
  /// Sets a parameter from text. @throws UserError that names the key and what is allowed, or
  /// suggests a similar key
  void set(std::string_view key, std::string_view text);

 private:
  std::vector<ParamBase*> all_;
  std::map<std::string, std::string, std::less<>> foreign_;
};

void ParamTree::declare(ParamSet& set) const {
  for (ParamGroup* g : groups_) set.add(*g);
}

}  // namespace fovea
