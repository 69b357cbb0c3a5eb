#include "model/trace/core/bounds.h"

#include <cstdio>

namespace fovea::trace {

std::string Bounds::refusal(std::uint64_t address, std::uint64_t bytes) const {
  char text[160];
  const bool mebibytes = size >= (1u << 20);
  std::snprintf(text, sizeof text,
                "%llu bytes at 0x%08llx are outside the memory of %llu %s; --wrap takes addresses "
                "modulo its size",
                static_cast<unsigned long long>(bytes), static_cast<unsigned long long>(address),
                static_cast<unsigned long long>(size >> (mebibytes ? 20 : 10)),
                mebibytes ? "MiB" : "KiB");
  return text;
}

bool BoundedSource::next(unsigned stream, Record& record) {
  if (!source_.next(stream, record)) return false;
  if (record.kind != Kind::kRequest) return true;
  if (bounds_.wrap) record.address &= static_cast<std::uint32_t>(bounds_.size - 1);
  if (!bounds_.holds(record.address, record.bytes)) {
    std::string place = source_.place(stream);
    if (!place.empty()) place += ": ";
    throw UserError("trace '" + name_ + "': " + place +
                    bounds_.refusal(record.address, record.bytes));
  }
  return true;
}

}  // namespace fovea::trace
