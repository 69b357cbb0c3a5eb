// Memory-mapped registers: each is declared once, with offset, fields, access modes and reset
// value.
#pragma once
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "model/common/census.h"

namespace fovea {

class Reg;
class RegBank;

enum class Mode : std::uint8_t {
  kRw,   ///< read and write
  kRo,   ///< read only: writes have no effect
  kW1c,  ///< writing 1 clears the bit
  kWo,   ///< write only: reads as 0; the written value is passed to on_write
};

/// The values of a field (or of a register without fields) that the model implements. Other values
/// would act on the chip and have no effect here: the first write over the bus that leaves one of
/// them in the field gives a warning with the field's name. Written `Modelled{0}` or `Modelled{0,
/// 3}`. List the reset value too, unless even that should give a warning.
struct Modelled {
  Modelled(std::initializer_list<std::uint32_t> list) : values(list) {}
  std::vector<std::uint32_t> values;
};

class Field {
 public:
  Field(Reg& reg, std::string name, unsigned lsb, unsigned width, Mode mode, std::string sentence,
        std::optional<Modelled> modelled = {});
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;
  std::uint32_t get() const;
  void set(std::uint32_t value);  ///< sets the field from the hardware side, whatever its mode
  explicit operator bool() const { return get() != 0; }
  const std::string& name() const { return name_; }
  const std::string& sentence() const { return sentence_; }
  unsigned lsb() const { return lsb_; }
  unsigned width() const { return width_; }
  Mode mode() const { return mode_; }
  std::uint32_t mask() const { return mask_; }

 private:
  Reg& reg_;
  std::string name_, sentence_;
  unsigned lsb_, width_;
  Mode mode_;
  std::uint32_t mask_;
};

class Reg {
 public:
  /// Declares a register whose bits are described by Field members.
  Reg(RegBank& bank, std::string name, std::uint32_t offset, std::string sentence,
      std::uint32_t reset = 0);
  /// Declares a register that is a single 32-bit field with the given mode.
  Reg(RegBank& bank, std::string name, std::uint32_t offset, Mode mode, std::string sentence,
      std::uint32_t reset = 0, std::optional<Modelled> modelled = {});
  Reg(const Reg&) = delete;
  Reg& operator=(const Reg&) = delete;

  std::uint32_t get() const { return value_; }
  void set(std::uint32_t value) { value_ = value; }  ///< sets the value from the hardware side
  /// Called before each read; may set() the value (counters, for example).
  void on_read(std::function<void()> f) { on_read_ = std::move(f); }
  /// Called after each write has taken effect, with the word as written (byte lanes that were not
  /// written are 0).
  void on_write(std::function<void(std::uint32_t)> f) { on_write_ = std::move(f); }
  /// Bits in the byte lanes of the latest write; of interest to on_write.
  std::uint32_t written_lanes() const { return lanes_; }

  const std::string& name() const { return name_; }
  const std::string& sentence() const { return sentence_; }
  std::uint32_t offset() const { return offset_; }
  std::uint32_t reset_value() const { return reset_; }
  const std::vector<Field*>& fields() const { return fields_; }
  /// Bits that keep what is written.
  std::uint32_t writable() const { return rw_; }
  /// Reserved bits, where software should write 0: those that belong to no field and reset to 0.
  std::uint32_t reserved() const { return ~(covered_ | reset_); }
  /// Bits of which only some values are modelled.
  std::uint32_t limited() const { return limited_; }
  /// One sentence for each field in the bits `lanes` that holds a value which is not modelled, such
  /// as "MODESET.HLPF (low-pass filter): only 0 is modelled".
  std::vector<std::string> not_modelled(std::uint32_t lanes) const;

 private:
  friend class Field;
  friend class RegBank;
  struct Limit {
    std::string name, sentence;
    unsigned lsb;
    std::uint32_t mask;
    std::vector<std::uint32_t> values;
  };
  void add(Field& field);
  void add(Limit limit);
  std::string name_, sentence_;
  std::uint32_t offset_, reset_, value_;
  std::uint32_t rw_ = 0, w1c_ = 0, wo_ = 0, covered_ = 0, limited_ = 0, lanes_ = 0;
  std::vector<Field*> fields_;
  std::vector<Limit> limits_;
  std::function<void()> on_read_;
  std::function<void(std::uint32_t)> on_write_;
};

enum class Access { kOk, kNoRegister, kMisaligned };

/// The registers of a block. Reads and writes take 1, 2 or 4 bytes; a write changes only the byte
/// lanes that it covers. Writes to bits that are read-only or belong to no field have no effect;
/// bits without a field read as their reset value.
class RegBank : public Census<RegBank> {
 public:
  explicit RegBank(std::string name) : name_(std::move(name)) {}
  RegBank(const RegBank&) = delete;
  RegBank& operator=(const RegBank&) = delete;

  Access read(std::uint32_t offset, unsigned bytes, std::uint32_t& value) {
    return read(register_at(offset), offset, bytes, value);
  }
  Access write(std::uint32_t offset, unsigned bytes, std::uint32_t value) {
    return write(register_at(offset), offset, bytes, value);
  }
  /// The same for a caller that has found the register already: `reg` is register_at(offset).
  static Access read(Reg* reg, std::uint32_t offset, unsigned bytes, std::uint32_t& value);
  static Access write(Reg* reg, std::uint32_t offset, unsigned bytes, std::uint32_t value);
  /// Reads a word without side effects, for debuggers and tests.
  Access peek(std::uint32_t offset, std::uint32_t& value) const;
  void reset();
  const std::string& name() const { return name_; }
  const std::vector<Reg*>& regs() const { return regs_; }
  /// The register at an offset in the block, or null.
  Reg* register_at(std::uint32_t offset) {
    const std::size_t word = offset / 4;
    return word < by_word_.size() ? by_word_[word] : nullptr;
  }
  const Reg* register_at(std::uint32_t offset) const {
    const std::size_t word = offset / 4;
    return word < by_word_.size() ? by_word_[word] : nullptr;
  }

 private:
  friend class Reg;
  void add(Reg& reg);
  std::string name_;
  std::vector<Reg*> regs_;
  std::vector<Reg*> by_word_;
};

}  // namespace fovea
