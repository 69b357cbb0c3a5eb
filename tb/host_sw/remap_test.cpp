// The encoded forms of the look-up table: decoders written from sw/remap/README.md give back every entry,
// for many lenses; each refusal at its limit and one beyond.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "sw/lens/lens.h"
#include "sw/remap/codes.h"
#include "sw/remap/deltas.h"
#include "sw/remap/offsets.h"

namespace {

constexpr std::uint8_t kUntouched = 0xC3;
constexpr std::size_t kPlenty = 4u << 20;

struct Picture {
  unsigned pairs = 0, rows = 0, pitch = 0;
  std::vector<std::uint32_t> lut;
  std::uint32_t black() const { return rows * pitch; }
};

/// What an encoder has made of a picture.
struct Encoded {
  std::vector<std::uint8_t> bytes;
  std::string refusal;  ///< empty: none

  template <class T>
  T at(std::size_t offset) const {
    if (offset + sizeof(T) > bytes.size()) throw std::out_of_range("behind the table's end");
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  }
};

Encoded encode(remap_encode_t* encoder, const Picture& p, unsigned widest, std::size_t room = kPlenty) {
  static std::vector<std::uint8_t> raw(kPlenty + 128);
  auto* const base = reinterpret_cast<std::uint8_t*>(
      (reinterpret_cast<std::uintptr_t>(raw.data()) + 31) & ~std::uintptr_t{31});
  std::memset(base, kUntouched, room + 64);
  const remap_picture_t picture{p.pairs, p.rows, p.pitch, p.lut.data(), p.rows};
  remap_memory_t memory{base, 0, room};
  const char* refusal = "not set";
  const remap_head_t* head = encoder(&picture, widest, &memory, &refusal);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(base[room + i], kUntouched) << "beyond its memory";
  EXPECT_EQ(head == nullptr, refusal != nullptr);
  Encoded e;
  if (!head) {
    e.refusal = refusal ? refusal : "";
    return e;
  }
  EXPECT_EQ(reinterpret_cast<const std::uint8_t*>(head), base);
  e.bytes.assign(base, base + head->bytes);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(base[head->bytes + i], kUntouched);
  return e;
}

/// The decoder's frame: strips, rows, padding and black runs. `row` gives a strip's next row.
std::vector<std::uint32_t> decode(
    const Encoded& e, const Picture& p, unsigned form_bytes,
    const std::function<std::vector<std::uint32_t>(std::size_t form, unsigned row, unsigned groups)>& row) {
  const auto rows = e.at<std::uint32_t>(4), strips = e.at<std::uint32_t>(8);
  EXPECT_EQ(rows, p.rows);
  const unsigned words = p.pitch / 4;
  std::vector<std::uint32_t> result(std::size_t{p.rows} * words, 0xFFFFFFFF);
  unsigned next = 0;
  for (unsigned n = 0; n < strips; ++n) {
    const std::size_t form = 16 + std::size_t{n} * form_bytes;
    const auto first = e.at<std::uint32_t>(form), groups = e.at<std::uint32_t>(form + 4);
    EXPECT_EQ(first, next) << "strips lie side by side";
    next = first + groups;
    for (unsigned v = 0; v < rows; ++v) {
      const auto entries = row(form, v, groups);
      EXPECT_EQ(entries.size(), groups * 8);
      for (unsigned i = 0; i < entries.size(); ++i) {
        EXPECT_LT(first * 8 + i, words) << "behind the pitch";
        EXPECT_LT(entries[i], p.black()) << "a load from outside of the source";
        result[std::size_t{v} * words + first * 8 + i] = entries[i];
      }
    }
  }
  EXPECT_EQ(next, (p.pairs + 7) / 8);
  std::size_t at = 0;
  for (std::size_t run = e.at<std::uint32_t>(12);; run += 4) {
    const auto skip = e.at<std::uint16_t>(run), count = e.at<std::uint16_t>(run + 2);
    if (skip == 0 && count == 0) {
      EXPECT_EQ(run + 4, e.bytes.size()) << "the runs are the table's end";
      break;
    }
    at += skip;
    for (unsigned i = 0; i < count; ++i) result.at(at++) = p.black();
  }
  std::vector<std::uint32_t> lut;
  for (unsigned v = 0; v < p.rows; ++v)
    lut.insert(lut.end(), result.begin() + v * words, result.begin() + v * words + p.pairs);
  return lut;
}

std::vector<std::uint32_t> decode_codes(const Encoded& e, const Picture& p) {
  std::uint32_t base = 0;
  return decode(e, p, 24, [&](std::size_t form, unsigned v, unsigned groups) {
    const auto count = e.at<std::uint32_t>(form + 8), patterns = e.at<std::uint32_t>(form + 12);
    const std::size_t row = e.at<std::uint32_t>(form + 16) + std::size_t{v} * (2 + 2 * groups);
    EXPECT_EQ(patterns % 32, 0u);
    EXPECT_LE(count, 256u);
    if (v == 0) base = e.at<std::uint32_t>(form + 20);
    base += static_cast<std::uint32_t>(e.at<std::int16_t>(row) * 4);
    std::vector<std::uint32_t> entries;
    std::uint32_t before = base;
    for (unsigned i = 0; i < 2 * groups; ++i) {
      const unsigned code = e.at<std::uint8_t>(row + 2 + i);
      EXPECT_LT(code, count);
      for (unsigned k = 0; k < 4; ++k)
        entries.push_back(before + e.at<std::uint32_t>(patterns + 16 * code + 4 * k));
      before = entries.back();
    }
    return entries;
  });
}

std::vector<std::uint32_t> decode_offsets(const Encoded& e, const Picture& p) {
  return decode(e, p, 12, [&](std::size_t form, unsigned v, unsigned groups) {
    const std::size_t row = e.at<std::uint32_t>(form + 8) + std::size_t{v} * (4 + 16 * groups);
    std::vector<std::uint32_t> entries;
    for (unsigned i = 0; i < 8 * groups; ++i)
      entries.push_back(e.at<std::uint32_t>(row) + e.at<std::uint16_t>(row + 4 + 2 * i));
    return entries;
  });
}

std::vector<std::uint32_t> decode_deltas(const Encoded& e, const Picture& p) {
  return decode(e, p, 80, [&](std::size_t form, unsigned v, unsigned groups) {
    const std::size_t row = e.at<std::uint32_t>(form + 76) + std::size_t{v} * (4 + 4 * groups);
    std::vector<std::uint32_t> entries;
    std::uint32_t before = e.at<std::uint32_t>(row);
    for (unsigned i = 0; i < 8 * groups; ++i) {
      const auto word = e.at<std::uint32_t>(row + 4 + i / 8 * 4);
      const std::uint32_t numbers = word >> 2 | word << 30;
      entries.push_back(before += e.at<std::uint32_t>(form + 12 + 4 * (numbers >> i % 8 * 4 & 15)));
    }
    return entries;
  });
}

struct Form {
  const char* name;
  remap_encode_t* encode;
  std::vector<std::uint32_t> (*decode)(const Encoded&, const Picture&);
};
const Form kCodes{"codes", codes_encode, decode_codes};
const Form kOffsets{"offsets", offsets_encode, decode_offsets};
const Form kDeltas{"deltas", deltas_encode, decode_deltas};
const Form* const kForms[] = {&kCodes, &kOffsets, &kDeltas};

Picture lens_picture(const lens_view_t& view, unsigned width, unsigned height, unsigned extra_pitch = 0) {
  lens_t lens;
  EXPECT_EQ(lens_init(&lens, &view, width, height), LENS_OK);
  Picture p{width / 2, height, (width * 2 + 31) / 32 * 32 + extra_pitch, {}};
  p.lut.resize(lens_lut_entries(width, height));
  lens_build_lut(&lens, p.lut.data(), p.pitch);
  return p;
}

/// Number of entries that differ.
std::size_t differing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  if (a.size() != b.size()) return a.size() + b.size();
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += a[i] != b[i];
  return n;
}

TEST(RemapTest, EveryEntryOfEveryLensComesBack) {
  const struct {
    unsigned width, height;
  } sizes[] = {{720, 576}, {716, 572}, {320, 240}, {12, 4}};
  std::map<std::string, unsigned> equal, refused;
  for (std::uint32_t mapping = LENS_NONE; mapping <= LENS_TABLE; ++mapping)
    for (const auto& size : sizes)
      for (unsigned variant = 0; variant < 3; ++variant) {
        lens_view_t view;
        lens_view_default(&view);
        view.mapping = mapping;
        view.fov_deg = mapping == LENS_RECTILINEAR ? 110 : 170;
        if (mapping == LENS_TABLE) {
          view.theta_max = 1.6;
          view.table_count = 65;
          for (unsigned i = 0; i < 65; ++i)  // R = f (theta - theta^3 / 25)
            view.table_r[i] = size.width / 3.2 * (i * 0.025 - i * i * i * 0.025 * 0.025 * 0.025 / 25);
          view.out_focal_px = size.width / 3.6;
        }
        if (variant == 1) {  // off centre; a rim at the left and below
          view.pair_method = PAIR_CENTRE;
          view.shift_x = -size.width / 6.0;
          view.shift_y = size.height / 5.0;
          view.centre_y = 10.53;
        }
        if (variant == 2) {
          if (mapping != LENS_TABLE) view.theta_max = 40 * std::numbers::pi / 180;  // a circle in black
          view.out_focal_px = size.width / 3.5;
        }
        const Picture p = lens_picture(view, size.width, size.height, variant == 1 ? 32 : 0);
        for (const Form* form : kForms)
          for (unsigned widest : {15u, 5u}) {
            SCOPED_TRACE(testing::Message() << form->name << " mapping " << mapping << " " << size.width
                                            << "x" << size.height << " variant " << variant);
            const Encoded e = encode(form->encode, p, widest);
            if (!e.refusal.empty()) {
              ++refused[form->name + (": " + e.refusal)];
              continue;
            }
            ++equal[form->name];
            ASSERT_EQ(differing(form->decode(e, p), p.lut), 0u);
          }
      }
  for (const auto& [name, n] : equal) std::printf("%-10s %u pictures come back\n", name.c_str(), n);
  for (const auto& [why, n] : refused) std::printf("%u times %s\n", n, why.c_str());
  EXPECT_GE(equal["codes"], 160u);
  EXPECT_GE(equal["deltas"], 160u);
  EXPECT_GE(equal["offsets"], 160u);
}

// A strip that is black at the top begins far below the first row.
TEST(RemapTest, BlackRowsAboveThePictureTakeNoStep) {
  Picture p{8, 200, 1440, {}};
  p.lut.assign(8 * 200, p.black());
  for (unsigned v = 100; v < 200; ++v)
    for (unsigned i = 0; i < 8; ++i) p.lut[v * 8 + i] = v * 1440 + i * 4;
  const Encoded e = encode(codes_encode, p, 1);
  ASSERT_EQ(e.refusal, "");
  EXPECT_EQ(differing(decode_codes(e, p), p.lut), 0u);
}

// A table that is all black, and one whose strips are black in the first rows only.
TEST(RemapTest, RowsWithoutAVisiblePairLoadFromTheSource) {
  for (unsigned visible : {0u, 3u}) {
    Picture p{40, 6, 160, {}};
    p.lut.assign(40 * 6, p.black());
    for (unsigned v = 6 - visible; v < 6; ++v)
      for (unsigned i = 20; i < 36; ++i) p.lut[v * 40 + i] = v * 160 + i * 4;
    for (const Form* form : kForms) {
      const Encoded e = encode(form->encode, p, 2);
      ASSERT_EQ(e.refusal, "") << form->name;
      EXPECT_EQ(differing(form->decode(e, p), p.lut), 0u) << form->name;
    }
  }
}

// The distance between two black runs has 16 bits; a longer one takes several steps.
TEST(RemapTest, BlackRunsFarApart) {
  for (unsigned distance : {65534u, 65535u, 65536u, 131070u, 131071u, 131072u}) {
    Picture p{8, 16400, 32, {}};
    for (unsigned v = 0; v < p.rows; ++v)
      for (unsigned i = 0; i < 8; ++i) p.lut.push_back(v * 32 + i * 4);
    p.lut[1] = p.lut[2] = p.black();
    p.lut[3 + distance] = p.black();
    p.lut.resize(std::size_t{p.rows} * 8);
    const Encoded e = encode(offsets_encode, p, 1);
    ASSERT_EQ(e.refusal, "");
    EXPECT_EQ(differing(decode_offsets(e, p), p.lut), 0u) << distance;
  }
}

/// Rows of one group; each row is two patterns of four distances.
Picture of_distances(const std::vector<std::vector<int>>& rows) {
  Picture p{8, static_cast<unsigned>(rows.size()), 1u << 20, {}};
  for (const auto& row : rows) {
    std::uint32_t at = 4u << 20;
    for (int d : row) p.lut.push_back(at += static_cast<std::uint32_t>(d));
  }
  return p;
}

TEST(RemapTest, TwoHundredAndFiftySixPatternsAndOneMore) {
  for (unsigned patterns : {255u, 256u, 257u}) {
    std::vector<std::vector<int>> rows;
    for (unsigned n = 0; n < patterns; ++n) {
      if (n % 2 == 0) rows.emplace_back(8, 0), rows.back()[0] = rows.back()[4] = 4;
      int* pattern = rows.back().data() + n % 2 * 4;
      pattern[1] = 4 * static_cast<int>(n % 16);
      pattern[2] = -4 * static_cast<int>(n / 16);
      if (n % 2 == 0) std::copy(pattern, pattern + 4, pattern + 4);
    }
    const Picture p = of_distances(rows);
    const Encoded e = encode(codes_encode, p, 15);
    EXPECT_EQ(e.refusal, patterns <= 256 ? "" : kCodesTooMany) << patterns;
    if (!e.refusal.empty()) continue;
    EXPECT_EQ(e.at<std::uint32_t>(16 + 8), patterns);
    EXPECT_EQ(differing(decode_codes(e, p), p.lut), 0u);
  }
}

TEST(RemapTest, AStepBetweenRowsHasSixteenBits) {
  for (const long words : {32767L, 32768L, -32768L, -32769L}) {
    Picture p{8, 2, 1u << 20, {}};
    for (unsigned v = 0; v < 2; ++v)
      for (unsigned i = 0; i < 8; ++i)
        p.lut.push_back(static_cast<std::uint32_t>((1 << 20) + (v ? words * 4 : 0) + i * 4));
    const Encoded e = encode(codes_encode, p, 15);
    EXPECT_EQ(e.refusal, words == 32767 || words == -32768 ? "" : kCodesRowStep) << words;
    if (e.refusal.empty()) {
      EXPECT_EQ(differing(decode_codes(e, p), p.lut), 0u);
    }
  }
}

TEST(RemapTest, ARowOfAStripSpansSixtyFourKibibytes) {
  for (const unsigned span : {65532u, 65536u})
    for (const bool down : {false, true}) {
      Picture p{8, 1, 1u << 20, std::vector<std::uint32_t>(8, 200'000)};
      p.lut[down ? 0 : 7] += span;
      const Encoded e = encode(offsets_encode, p, 15);
      EXPECT_EQ(e.refusal, span == 65532 ? "" : kOffsetsSpan);
      if (e.refusal.empty()) {
        EXPECT_EQ(differing(decode_offsets(e, p), p.lut), 0u);
      }
    }
}

TEST(RemapTest, SixteenDeltasAndOneMore) {
  for (unsigned deltas : {15u, 16u, 17u}) {
    std::vector<std::vector<int>> rows;
    for (unsigned n = 0; n < deltas; ++n) rows.push_back({4, 4 + 4 * static_cast<int>(n), 4, 4, 4, 4, 4, 4});
    const Picture p = of_distances(rows);
    const Encoded e = encode(deltas_encode, p, 15);
    EXPECT_EQ(e.refusal, deltas <= 16 ? "" : kDeltasTooMany) << deltas;
    if (!e.refusal.empty()) continue;
    EXPECT_EQ(e.at<std::uint32_t>(16 + 8), deltas);
    EXPECT_EQ(differing(decode_deltas(e, p), p.lut), 0u);
  }
}

// The limits hold for a strip: two strips may have more patterns than one.
TEST(RemapTest, NarrowerStripsAllowMore) {
  lens_view_t view;
  lens_view_default(&view);
  view.fov_deg = 175;
  view.out_focal_px = 100;
  const Picture p = lens_picture(view, 720, 576);
  EXPECT_EQ(encode(codes_encode, p, 15).refusal, kCodesTooMany);
  EXPECT_EQ(encode(offsets_encode, p, 15).refusal, kOffsetsSpan);
  EXPECT_EQ(encode(codes_encode, p, 1).refusal, "");
  EXPECT_EQ(encode(offsets_encode, p, 3).refusal, "");
}

TEST(RemapTest, MemoryThatIsOneByteTooSmallIsRefused) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = LENS_NONE;
  view.shift_x = -20;
  const Picture p = lens_picture(view, 128, 32);
  ASSERT_GT(std::count(p.lut.begin(), p.lut.end(), p.black()), 0);
  for (const Form* form : kForms) {
    const Encoded e = encode(form->encode, p, 3);
    ASSERT_EQ(e.refusal, "");
    const Encoded exact = encode(form->encode, p, 3, e.bytes.size());
    EXPECT_EQ(exact.bytes, e.bytes) << form->name;
    // In all of its parts, down to nothing.
    for (std::size_t room = 0; room < e.bytes.size(); ++room)
      ASSERT_EQ(encode(form->encode, p, 3, room).refusal, kRemapNoMemory) << form->name << " " << room;
  }
}

TEST(RemapTest, StripsDifferByOneGroupAtMost) {
  for (unsigned groups = 1; groups < 130; ++groups)
    for (unsigned widest : {1u, 5u, 9u, 15u}) {
      const unsigned count = remap_strip_count(groups, widest);
      unsigned next = 0, least = groups, most = 0;
      for (unsigned n = 0; n < count; ++n) {
        const remap_strip_t s = remap_strip_of(groups, count, n);
        EXPECT_EQ(s.first, next);
        next += s.groups;
        least = std::min(least, s.groups);
        most = std::max(most, s.groups);
      }
      EXPECT_EQ(next, groups);
      EXPECT_LE(most, widest);
      EXPECT_LE(most - least, 1u);
      EXPECT_GE(least, 1u);
    }
}

}  // namespace
