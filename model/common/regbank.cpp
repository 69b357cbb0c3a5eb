#include "model/common/regbank.h"

#include <algorithm>
#include <cstdio>

#include "model/common/check.h"

namespace fovea {

Field::Field(Reg& reg, std::string name, unsigned lsb, unsigned width, Mode mode,
             std::string sentence, std::optional<Modelled> modelled)
    : reg_(reg),
      name_(std::move(name)),
      sentence_(std::move(sentence)),
      lsb_(lsb),
      width_(width),
      mode_(mode),
      mask_((width == 32 ? ~0u : (1u << width) - 1u) << lsb) {
  reg.add(*this);
  if (modelled)
    reg.add({reg.name() + "." + name_, sentence_, lsb_, mask_, std::move(modelled->values)});
}
std::uint32_t Field::get() const { return (reg_.value_ & mask_) >> lsb_; }
void Field::set(std::uint32_t value) {
  reg_.value_ = (reg_.value_ & ~mask_) | ((value << lsb_) & mask_);
}

Reg::Reg(RegBank& bank, std::string name, std::uint32_t offset, std::string sentence,
         std::uint32_t reset)
    : name_(std::move(name)),
      sentence_(std::move(sentence)),
      offset_(offset),
      reset_(reset),
      value_(reset) {
  bank.add(*this);
}

Reg::Reg(RegBank& bank, std::string name, std::uint32_t offset, Mode mode, std::string sentence,
         std::uint32_t reset, std::optional<Modelled> modelled)
    : Reg(bank, std::move(name), offset, std::move(sentence), reset) {
  covered_ = ~0u;
  (mode == Mode::kRw ? rw_ : mode == Mode::kW1c ? w1c_ : mode == Mode::kWo ? wo_ : covered_) = ~0u;
  if (modelled) add({name_, sentence_, 0, ~0u, std::move(modelled->values)});
}

void Reg::add(Field& field) {
  FOVEA_CHECK((covered_ & field.mask()) == 0, "fields overlap: " + name_ + "." + field.name());
  covered_ |= field.mask();
  if (field.mode() == Mode::kRw) rw_ |= field.mask();
  if (field.mode() == Mode::kW1c) w1c_ |= field.mask();
  if (field.mode() == Mode::kWo) wo_ |= field.mask();
  fields_.push_back(&field);
}

void Reg::add(Limit limit) {
  limited_ |= limit.mask;
  limits_.push_back(std::move(limit));
}

std::vector<std::string> Reg::not_modelled(std::uint32_t lanes) const {
  std::vector<std::string> out;
  for (const Limit& l : limits_) {
    const std::uint32_t value = (value_ & l.mask) >> l.lsb;
    if (!(l.mask & lanes) || std::find(l.values.begin(), l.values.end(), value) != l.values.end())
      continue;
    std::string text = l.name + " (" + l.sentence + "): ";
    if (l.values.empty()) text += "not modelled";
    for (std::size_t i = 0; i < l.values.size(); ++i) {
      char number[16];
      std::snprintf(number, sizeof number, l.values[i] < 10 ? "%u" : "0x%x", l.values[i]);
      text += (i == 0 ? "only " : i + 1 < l.values.size() ? ", " : " and ") + std::string(number);
    }
    if (!l.values.empty()) text += l.values.size() == 1 ? " is modelled" : " are modelled";
    out.push_back(std::move(text));
  }
  return out;
}

void RegBank::add(Reg& reg) {
  FOVEA_CHECK(reg.offset() % 4 == 0, "register offset not a multiple of 4: " + reg.name());
  const std::size_t word = reg.offset() / 4;
  if (word >= by_word_.size()) by_word_.resize(word + 1);
  FOVEA_CHECK(by_word_[word] == nullptr, "registers overlap: " + name_ + "." + reg.name());
  by_word_[word] = &reg;
  regs_.push_back(&reg);
}

Access RegBank::read(Reg* r, std::uint32_t offset, unsigned bytes, std::uint32_t& value) {
  if (bytes > 4 || bytes == 3 || bytes == 0 || offset % bytes) return Access::kMisaligned;
  if (!r) return Access::kNoRegister;
  if (r->on_read_) r->on_read_();
  const std::uint32_t lanes = bytes == 4 ? ~0u : (1u << 8 * bytes) - 1u;
  value = ((r->value_ & ~r->wo_) >> 8 * (offset & 3u)) & lanes;
  return Access::kOk;
}

Access RegBank::write(Reg* r, std::uint32_t offset, unsigned bytes, std::uint32_t value) {
  if (bytes > 4 || bytes == 3 || bytes == 0 || offset % bytes) return Access::kMisaligned;
  if (!r) return Access::kNoRegister;
  const unsigned shift = 8 * (offset & 3u);
  const std::uint32_t lanes = (bytes == 4 ? ~0u : (1u << 8 * bytes) - 1u) << shift;
  const std::uint32_t word = (value << shift) & lanes;
  const std::uint32_t keep = (r->rw_ | r->wo_) & lanes;
  r->value_ = (r->value_ & ~keep) | (word & keep);
  r->value_ &= ~(word & r->w1c_);
  r->lanes_ = lanes;
  if (r->on_write_) r->on_write_(word);
  return Access::kOk;
}

Access RegBank::peek(std::uint32_t offset, std::uint32_t& value) const {
  const Reg* r = register_at(offset);
  if (!r) return Access::kNoRegister;
  value = r->value_ & ~r->wo_;
  return Access::kOk;
}

void RegBank::reset() {
  for (Reg* r : regs_) r->value_ = r->reset_;
}

}  // namespace fovea
