// The table of masters: what it derives, that a new row disturbs no other, and that defects show.
#include "model/common/masters.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fovea {
namespace {

// Names and numbers that results and traces of earlier versions hold, typed in apart from the table.
TEST(MasterTableTest, NumbersAndNamesAreThoseOfTraces) {
  const std::array<std::string_view, 14> names = {
      "arm_i", "arm_d", "edma_tc0_read", "edma_tc1_read", "edma_tc2_read", "edma_tc3_read",
      "vpfe", "vpbe", "remap_engine", "load",
      "edma_tc0_write", "edma_tc1_write", "edma_tc2_write", "edma_tc3_write"};
  EXPECT_EQ(kMasterNames, names);
  const std::array<std::string_view, 10> statistics = {
      "arm_i", "arm_d", "edma_tc0", "edma_tc1", "edma_tc2", "edma_tc3",
      "vpfe", "vpbe", "remap_engine", "load"};
  EXPECT_EQ(kStatNames, statistics);
  const std::array<std::uint8_t, 14> of = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 2, 3, 4, 5};
  EXPECT_EQ(kStatIndex, of);
  for (std::size_t stat = 0; stat < kStatCount; ++stat)
    EXPECT_EQ(stat_name(master_of_stat(stat)), statistics[stat]);
}

TEST(MasterTableTest, TransferControllersAndWidePorts) {
  EXPECT_EQ(kTransferControllers, 4u);
  EXPECT_EQ(edma_read(0), Master::kEdmaTc0Read);
  EXPECT_EQ(edma_write(0), Master::kEdmaTc0Write);
  EXPECT_EQ(edma_read(3), Master::kEdmaTc3Read);
  EXPECT_EQ(edma_write(3), Master::kEdmaTc3Write);
  EXPECT_EQ(edma_read(4), Master::kCount);
  EXPECT_EQ(wide_master(0), Master::kEdmaTc0Read);
  EXPECT_EQ(wide_master(4), Master::kVpfe);
  EXPECT_EQ(wide_master(11), Master::kEdmaTc3Write);
  EXPECT_EQ(wide_master(12), Master::kCount);
  EXPECT_EQ(master_with(PrioritySource::kVideoWrite), Master::kVpfe);
  EXPECT_EQ(master_with(PrioritySource::kVideoRead), Master::kVpbe);
  EXPECT_EQ(kMasters.find("edma_tc1", false)->id, Master::kEdmaTc1Read);
  EXPECT_EQ(kMasters.find("edma_tc1", true)->id, Master::kEdmaTc1Write);
  EXPECT_EQ(kMasters.find("vpfe", true), kMasters.find("vpfe", false));
  EXPECT_EQ(kMasters.find("usb", true), nullptr);
}

TEST(MasterTableTest, TheCoreAndWhoMovesDataBesideIt) {
  std::string core, data;
  for (const MasterInfo& r : kMasters.rows) {
    if (is_core(r.id)) core += std::string(r.name) + " ";
    if (moves_data(r)) data += std::string(r.name) + " ";
  }
  EXPECT_EQ(core, "arm_i arm_d ");
  EXPECT_EQ(data, "edma_tc0_read edma_tc1_read edma_tc2_read edma_tc3_read remap_engine "
                  "edma_tc0_write edma_tc1_write edma_tc2_write edma_tc3_write ");
}

TEST(MasterTableTest, EqualsTakeTurnsInTheirOrder) {
  for (std::size_t last = 0; last < kMasterCount; ++last) {
    std::size_t m = last;
    for (unsigned turn = 0; turn < kMasterCount; ++turn) {
      m = m + 1 == kMasterCount ? 0 : m + 1;
      EXPECT_EQ(turns_after(last, m), turn);
    }
    EXPECT_EQ(m, last) << "the last of all to have another turn";
  }
}

/// The table with one more master at its end, as a new block would add it.
constexpr MasterTable<kMasterCount + 1> with(MasterInfo row) {
  MasterTable<kMasterCount + 1> t;
  for (std::size_t i = 0; i < kMasterCount; ++i) t.rows[i] = kMasters.rows[i];
  t.rows[kMasterCount] = row;
  return t;
}
constexpr MasterInfo kUsb{.id = Master::kCount, .name = "usb", .statistics = "usb",
                          .who = "the USB controller", .most_outstanding = 4, .on_chip = false};

TEST(MasterTableTest, ANewRowAtTheEndHasItsOwnStatisticsAndMovesNoOther) {
  constexpr auto table = with(kUsb);
  static_assert(table.defect() == nullptr);
  EXPECT_EQ(table.stat_count(), kStatCount + 1);
  EXPECT_EQ(table.stat_index(Master::kCount), kStatCount);
  for (const MasterInfo& m : kMasters.rows) EXPECT_EQ(table.stat_index(m.id), stat_index(m.id));
}

std::string defect_with(MasterInfo row) {
  const char* d = with(row).defect();
  return d ? d : "";
}
template <class Change>
std::string defect_after(Change change) {
  auto table = kMasters;
  change(table);
  const char* d = table.defect();
  return d ? d : "";
}

TEST(MasterTableTest, EachDefectIsNamed) {
  EXPECT_EQ(defect_with({}), "a row is missing or out of order");
  MasterInfo row = kUsb;
  row.name = "";
  EXPECT_EQ(defect_with(row), "a master without a name");
  row = kUsb;
  row.statistics = "";
  EXPECT_EQ(defect_with(row), "a master without a name");
  row = kUsb;
  row.who = "";
  EXPECT_EQ(defect_with(row), "a master without a name");
  row = kUsb;
  row.name = "vpfe";
  EXPECT_EQ(defect_with(row), "two masters with one name");
  row = kUsb;
  row.statistics = "vpfe";
  EXPECT_EQ(defect_with(row), "two masters with one name in the statistics");
  row = kUsb;
  row.most_outstanding = kMostOutstanding;
  EXPECT_EQ(defect_with(row), "");
  row.most_outstanding = kMostOutstanding + 1;
  EXPECT_EQ(defect_with(row),
            "a master with no requests, or with more than a port queues");
  row.most_outstanding = 0;
  EXPECT_EQ(defect_with(row),
            "a master with no requests, or with more than a port queues");
  row = kUsb;
  row.on_chip = true;
  EXPECT_EQ(defect_with(row), "a master of the chip without a register for its priority");
  row = kUsb;
  row.side = Side::kReads;
  EXPECT_EQ(defect_with(row), "one side of a block without the other");
  row.partner = Master::kVpfe;
  EXPECT_EQ(defect_with(row), "partners that differ in more than their side");
  row.partner = static_cast<Master>(kMasterCount + 1);
  EXPECT_EQ(defect_with(row), "a partner that does not exist");
  EXPECT_EQ(defect_after([](auto& t) { std::swap(t.rows[6], t.rows[7]); }),
            "a row is missing or out of order");
  EXPECT_EQ(defect_after([](auto& t) { t.rows[10].unit = 1; }),
            "partners that differ in more than their side");
  EXPECT_EQ(defect_after([](auto& t) { t.rows[10].side = Side::kReads; }),
            "partners that differ in more than their side");
  EXPECT_EQ(defect_after([](auto& t) { t.rows[10].priority = PrioritySource::kArm; }),
            "partners that differ in more than their side");
}

}  // namespace
}  // namespace fovea
