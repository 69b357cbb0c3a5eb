// GDB's framing and packets with a fake target; malformed input in all parts.
#include <gtest/gtest.h>

#include <random>

#include "tb/unit/gdb_fake_target.h"

namespace fovea::app {
namespace {

using Kind = GdbFramer::Event::Kind;

std::vector<GdbFramer::Event> events(std::string_view bytes, std::size_t piece = ~std::size_t{0}) {
  GdbFramer f;
  std::vector<GdbFramer::Event> out;
  for (std::size_t i = 0; i < bytes.size(); i += std::min(piece, bytes.size())) {
    f.feed(bytes.substr(i, piece));
    while (auto e = f.next()) out.push_back(*e);
  }
  return out;
}

TEST(GdbFramerTest, PacketsComeBackInAnyPieces) {
  std::string payload;
  for (int c = 0; c < 256; ++c) payload += static_cast<char>(c);
  const std::string bytes = "+" + gdb_frame(payload) + "\x03" + gdb_frame("") + "-";
  for (const std::size_t piece : {1u, 2u, 7u, 1000u}) {
    const auto e = events(bytes, piece);
    ASSERT_EQ(e.size(), 5u);
    EXPECT_EQ(e[0].kind, Kind::kAck);
    EXPECT_EQ(e[1].payload, payload);
    EXPECT_EQ(e[2].kind, Kind::kInterrupt);
    EXPECT_EQ(e[3].payload, "");
    EXPECT_EQ(e[4].kind, Kind::kNak);
  }
}

TEST(GdbFramerTest, KnownFrames) {
  EXPECT_EQ(gdb_frame("OK"), "$OK#9a");
  EXPECT_EQ(gdb_frame(""), "$#00");
  EXPECT_EQ(gdb_frame("a#b"), "$a}\x03" "b#43");
}

TEST(GdbFramerTest, ChecksumsMayHaveCapitalDigits) {
  const auto e = events("$OK#9A$Dk#AF$~q#EF");  // the sums of ASCII codes: 0x9a, 0xaf, 0xef
  ASSERT_EQ(e.size(), 3u);
  for (const auto& one : e) EXPECT_EQ(one.kind, Kind::kPacket);
}

TEST(GdbFramerTest, DamageIsBrokenAndTheNextPacketIsNot) {
  const std::string damaged[] = {"$OK#9b", "$OK#zz", "$O#K#9a", "$a}#7d#de", "$}#7d"};
  for (const auto& d : damaged) {
    const auto e = events(d + "+" + gdb_frame("after"));
    ASSERT_FALSE(e.empty()) << d;
    EXPECT_EQ(e.front().kind, Kind::kBroken) << d;
    EXPECT_EQ(e.back().kind, Kind::kPacket) << d;
    EXPECT_EQ(e.back().payload, "after") << d;
  }
  const auto cut = events("$half" + gdb_frame("whole"));
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_EQ(cut[0].payload, "whole");
}

TEST(GdbFramerTest, LongestPacketIsTakenAndALongerOneIsNot) {
  EXPECT_EQ(events(gdb_frame(std::string(kGdbPacketBytes, 'x')))[0].kind, Kind::kPacket);
  const auto e = events(gdb_frame(std::string(kGdbPacketBytes + 1, 'x')) + gdb_frame("after"));
  ASSERT_EQ(e.size(), 2u);
  EXPECT_EQ(e[0].kind, Kind::kBroken);
  EXPECT_EQ(e[1].payload, "after");
}

/// The sum as GDB counts it, over the bytes as they travel.
std::string framed(const std::string& bytes) {
  unsigned sum = 0;
  for (const char c : bytes) sum += static_cast<unsigned char>(c);
  char end[4];
  std::snprintf(end, sizeof end, "#%02x", sum & 0xFFu);
  return "$" + bytes + end;
}

TEST(GdbFramerTest, OneSumOf256IsRight) {
  unsigned good = 0;
  for (unsigned sum = 0; sum < 256; ++sum) {
    char packet[16];
    std::snprintf(packet, sizeof packet, "$m0,4#%02x", sum);
    const auto e = events(packet);
    ASSERT_EQ(e.size(), 1u) << packet;
    good += e[0].kind == Kind::kPacket;
    EXPECT_EQ(e[0].kind == Kind::kPacket, framed("m0,4") == packet) << packet;
  }
  EXPECT_EQ(good, 1u);
  EXPECT_EQ(events("$OK#9A")[0].kind, Kind::kPacket) << "capital digits";
  for (const char* sum : {"#9g", "#g9", "# 9", "#+9", "#-1", "#0x"})
    EXPECT_EQ(events(std::string("$OK") + sum)[0].kind, Kind::kBroken) << sum;
}

TEST(GdbFramerTest, EscapesOfEscapes) {
  const std::pair<std::string, std::string> cases[] = {{"a}}b", "a]b"},
                                                       {"}}}}", "]]"},
                                                       {"}}}\x03", "]#"},
                                                       {"}]", "}"},
                                                       {"}\x04", "$"},
                                                       {"}\x0a", "*"},
                                                       {std::string("}") + '\0', " "}};
  for (const auto& [bytes, payload] : cases) {
    const auto e = events(framed(bytes));
    ASSERT_EQ(e.size(), 1u);
    EXPECT_EQ(e[0].kind, Kind::kPacket);
    EXPECT_EQ(e[0].payload, payload);
  }
  for (const char* bytes : {"}", "a}", "}}}"})
    EXPECT_EQ(events(framed(bytes))[0].kind, Kind::kBroken);
}

/// Runs are the target's right only: from GDB a star is a star. Ours never send one bare.
TEST(GdbFramerTest, RunLengthsAreNotExpandedNorMadeByAccident) {
  EXPECT_EQ(events(framed("0* "))[0].payload, "0* ");
  EXPECT_EQ(gdb_frame("0*!"), framed("0}\x0a!"));
}

TEST(GdbFramerTest, AnInterruptIsOneBetweenPacketsOnly) {
  const auto e = events(framed("X1000,1:\x03") + "\x03" + framed("?"));
  ASSERT_EQ(e.size(), 3u);
  EXPECT_EQ(e[0].payload, "X1000,1:\x03");
  EXPECT_EQ(e[1].kind, Kind::kInterrupt);
  EXPECT_EQ(e[2].payload, "?");
}

TEST(GdbFramerTest, WhatIsCutOffIsForgottenWithTheConnection) {
  const std::string packet = framed("X1000,3:a}]b");
  for (std::size_t n = 0; n < packet.size(); ++n) {
    GdbFramer f;
    f.feed(packet.substr(0, n));
    EXPECT_FALSE(f.next().has_value()) << n;
    f.clear();
    f.feed(framed("?"));
    const auto e = f.next();
    ASSERT_TRUE(e && e->kind == Kind::kPacket) << n;
    EXPECT_EQ(e->payload, "?");
  }
}

TEST(GdbFramerTest, EndlessPacketsAreDroppedToTheirEnd) {
  for (const char* filler : {"x", "}]", "}}", "*"}) {
    std::string bytes;
    while (bytes.size() < (1u << 20)) bytes += filler;
    const auto e = events("$" + bytes + "#00+" + framed("?"), 4096);
    ASSERT_EQ(e.size(), 3u) << filler;
    EXPECT_EQ(e[0].kind, Kind::kBroken) << filler;
    EXPECT_EQ(e[1].kind, Kind::kAck) << filler;
    EXPECT_EQ(e[2].payload, "?") << filler;
  }
  const auto e = events(framed(std::string(2 * kGdbPacketBytes, 'x')));
  ASSERT_EQ(e.size(), 1u);
  EXPECT_EQ(e[0].kind, Kind::kBroken) << "its sum is right, and it is too long";
}

struct GdbProtocolTest : testing::Test {
  test::FakeGdbTarget target;
  GdbProtocol protocol{target};
  std::string ask(std::string_view packet) {
    const auto a = protocol.handle(packet);
    return a.payload.value_or("(none)");
  }
};

TEST_F(GdbProtocolTest, Registers) {
  EXPECT_EQ(ask("g"), "443322110100000000800000d3000000");
  EXPECT_EQ(ask("p0"), "44332211");
  EXPECT_EQ(ask("p2"), "E16");
  EXPECT_EQ(ask("P1=efbeadde"), "OK");
  EXPECT_EQ(target.values[1], 0xDEADBEEFu);
  EXPECT_EQ(ask("P19=00000000"), "E16");  // 25 cannot be written here
  EXPECT_EQ(ask("G" + ask("g")), "OK");   // what does not change is not written
  EXPECT_EQ(ask("G00"), "E16");
}

TEST_F(GdbProtocolTest, Memory) {
  EXPECT_EQ(ask("M1004,3:a1b2c3"), "OK");
  EXPECT_EQ(ask("m1003,5"), "00a1b2c300");
  EXPECT_EQ(ask("X1000,2:#}"), "OK");
  EXPECT_EQ(ask("m1000,2"), "237d");
  EXPECT_EQ(ask("m10fe,8"), "0000");  // up to the end
  EXPECT_EQ(ask("m1100,4"), "E0e");
  EXPECT_EQ(ask("M10ff,2:0000"), "E0e");
  EXPECT_EQ(ask("M1000,2:00"), "E16");
  EXPECT_EQ(ask("X1000,2:0"), "E16");
  EXPECT_EQ(ask("X1000,0:"), "OK");
  EXPECT_EQ(ask("mffffffff,ffffffff"), "E0e");
}

/// Binary data through frame and packet: every byte value, in the order in which they are hardest.
TEST_F(GdbProtocolTest, BinaryWritesCarryEveryByte) {
  std::string data;
  for (unsigned k = 0; k < 256; ++k) data += static_cast<char>(k * 167 + 0x23);
  const auto e = events(gdb_frame("X1000,100:" + data), 3);
  ASSERT_EQ(e.size(), 1u);
  EXPECT_EQ(ask(e[0].payload), "OK");
  EXPECT_TRUE(std::equal(data.begin(), data.end(), target.memory.begin(),
                         [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }));
  const auto before = target.memory;
  for (const char* packet : {"X1000,3:ab", "X1000,1:ab", "X1000:ab", "X1000,2", "X,2:ab", "X1000,:",
                             "X1000,ffffffff:ab", "X100000000,2:ab", "X-1,1:a", "X1000,2 :ab"})
    EXPECT_EQ(ask(packet), "E16") << packet;
  EXPECT_EQ(ask("Xffffffff,2:ab"), "E0e") << "beyond the end of the addresses";
  EXPECT_EQ(target.memory, before);
}

TEST_F(GdbProtocolTest, ThreadsAreOne) {
  EXPECT_EQ(ask("T1"), "OK");
  for (const char* packet : {"T2", "T", "T0", "T-1", "Tp1.1"})
    EXPECT_EQ(ask(packet), "E16") << packet;
  EXPECT_EQ(ask("Hg0"), "OK");
}

TEST_F(GdbProtocolTest, PointsAndResumption) {
  EXPECT_EQ(ask("Z0,8000,4"), "OK");
  EXPECT_EQ(ask("Z3,1000,8;X1,00"), "OK");
  EXPECT_EQ(target.points, (std::vector<std::string>{"0:32768:4", "3:4096:8"}));
  EXPECT_EQ(ask("z3,1000,8"), "OK");
  EXPECT_EQ(ask("Z5,0,0"), "");
  EXPECT_EQ(ask("Z0,8000"), "E16");
  EXPECT_EQ(protocol.handle("c").resume->kind, GdbResume::Kind::kContinue);
  EXPECT_EQ(protocol.handle("vCont;c").resume->kind, GdbResume::Kind::kContinue);
  EXPECT_EQ(protocol.handle("vCont;s:1;c").resume->kind, GdbResume::Kind::kStep);
  const auto r = protocol.handle("vCont;r8000,8010:1");
  EXPECT_EQ(r.resume->from, 0x8000u);
  EXPECT_EQ(r.resume->to, 0x8010u);
  EXPECT_EQ(protocol.handle("s9000").resume->kind, GdbResume::Kind::kStep);
  EXPECT_EQ(target.values[15], 0x9000u);
  EXPECT_EQ(ask("cxyz"), "E16");
  EXPECT_EQ(ask("vCont;"), "E16");
  EXPECT_EQ(protocol.handle("k").resume->kind, GdbResume::Kind::kKill);
  const auto d = protocol.handle("D");
  EXPECT_TRUE(d.detached);
  EXPECT_EQ(d.payload, "OK");
  EXPECT_TRUE(target.points.empty());
}

TEST_F(GdbProtocolTest, StopsSayWhy) {
  protocol.stopped({GdbStop::Reason::kWrite, 0x1234});
  EXPECT_EQ(ask("?"), "T05watch:1234;thread:1;");
  protocol.stopped({GdbStop::Reason::kSoftware, 0});
  EXPECT_EQ(ask("?"), "T05thread:1;");  // not before GDB says that it knows
  protocol.stopped({GdbStop::Reason::kHardware, 0});
  EXPECT_EQ(ask("?"), "T05thread:1;");
  EXPECT_NE(ask("qSupported:multiprocess+;hwbreak+").find("PacketSize=4000"), std::string::npos);
  EXPECT_EQ(ask("?"), "T05hwbreak:;thread:1;");
  protocol.stopped({GdbStop::Reason::kSoftware, 0});
  EXPECT_EQ(ask("?"), "T05thread:1;");
  EXPECT_NE(ask("qSupported:multiprocess+;swbreak+;hwbreak+").find("PacketSize=4000"),
            std::string::npos);
  EXPECT_EQ(ask("?"), "T05swbreak:;thread:1;");
  protocol.stopped({GdbStop::Reason::kRead, 0x20});
  EXPECT_EQ(ask("?"), "T05rwatch:20;thread:1;");
  protocol.stopped({GdbStop::Reason::kAccess, 0x30});
  EXPECT_EQ(ask("?"), "T05awatch:30;thread:1;");
  protocol.stopped({});
  EXPECT_EQ(ask("?"), "T02thread:1;");
  protocol.stopped({GdbStop::Reason::kFailed, 0});
  EXPECT_EQ(ask("?"), "T06thread:1;");
}

TEST_F(GdbProtocolTest, FeaturesAreWholeWords) {
  protocol.stopped({GdbStop::Reason::kSoftware, 0});
  for (const auto& [features, known] : {std::pair{"swbreak+", true}, {"xml=arm;swbreak+", true}, {"swbreak-", false},
                                        {"swbreak", false}, {"noswbreak+", false}, {"wbreak+", false}}) {
    ask("qSupported:" + std::string(features));
    EXPECT_EQ(ask("?"), known ? "T05swbreak:;thread:1;" : "T05thread:1;") << features;
  }
  ask("qSupported:");
  EXPECT_EQ(ask("?"), "T05thread:1;");
}

TEST_F(GdbProtocolTest, DescriptionsComeInPieces) {
  std::string text;
  for (bool more = true; more;) {
    char packet[80];
    std::snprintf(packet, sizeof packet, "qXfer:features:read:target.xml:%zx,1000", text.size());
    const std::string piece = ask(packet);
    more = piece.at(0) == 'm';
    text += piece.substr(1);
  }
  EXPECT_EQ(text, target.target_xml());
  // Each character may need an escape: a piece and its mark fill half of a packet and no more.
  ASSERT_GT(text.size(), kGdbPacketBytes / 2);
  EXPECT_EQ(ask("qXfer:features:read:target.xml:0,ffff").size(), kGdbPacketBytes / 2);
  EXPECT_EQ(ask("qXfer:memory-map:read::0,fff"), "lmap");
  EXPECT_EQ(ask("qXfer:memory-map:read::3,fff"), "l");
  EXPECT_EQ(ask("qXfer:memory-map:read::4,fff"), "E16");
  EXPECT_EQ(ask("qXfer:features:read:other.xml:0,fff"), "E00");
  EXPECT_EQ(ask("qXfer:auxv:read::0,fff"), "");
}

TEST_F(GdbProtocolTest, MonitorTextComesInPackets) {
  const auto a = protocol.handle("qRcmd,68656c70");
  EXPECT_EQ(target.asked, "help");
  ASSERT_EQ(a.output.size(), 3u);
  EXPECT_EQ(a.output[2].size(), 1u + 2 * 500);
  EXPECT_EQ(a.payload, "OK");
  EXPECT_EQ(ask("qRcmd,6"), "E16");
}

TEST_F(GdbProtocolTest, UnknownIsEmpty) {
  for (const char* packet : {"", "!", "vMustReplyEmpty", "qTStatus", "QNonStop:1", "~", "R00"})
    EXPECT_EQ(ask(packet), "") << packet;
}

/// Every packet of a session, cut off and changed at every place, and random bytes: an answer or none.
TEST_F(GdbProtocolTest, MalformedPacketsNeverCrash) {
  const std::vector<std::string> corpus = {
      "g", "G44332211", "p19", "P1=efbeadde", "m1000,100", "M1004,3:a1b2c3", "X1000,2:#}",
      "Z0,8000,4", "z4,1000,ffffffff", "Z2,,", "c8000", "C05;8000", "s", "S05", "D;1", "k", "H g-1",
      "T1", "?", "vCont?", "vCont;r8000,8010:1;c", "vKill;1", "qSupported:swbreak+;hwbreak+;xml=arm",
      "qXfer:features:read:target.xml:0,ffffffff", "qXfer:memory-map:read::ffffffff,1",
      "qRcmd,73746174", "qC", "QStartNoAckMode", "qfThreadInfo", "mffffffff,ffffffff"};
  std::mt19937 rng(7);
  unsigned answered = 0;
  const auto try_one = [&](const std::string& packet) {
    const auto a = protocol.handle(packet);
    answered += a.payload.has_value() || a.resume.has_value();
    for (const auto& e : events(gdb_frame(packet))) EXPECT_EQ(e.payload, packet);
    GdbFramer f;
    f.feed(packet + "#" + packet + "$" + packet);
    while (f.next()) {
    }
  };
  unsigned tried = 0;
  for (const auto& p : corpus) {
    for (std::size_t n = 0; n <= p.size(); ++n, ++tried) try_one(p.substr(0, n));
    for (std::size_t n = 0; n < p.size(); ++n)
      for (const char c : {'\0', ',', ':', ';', '=', '-', 'f', 'g', '\x7f', '\xff'}) {
        std::string changed = p;
        changed[n] = c;
        try_one(changed);
        ++tried;
      }
  }
  for (unsigned k = 0; k < 20'000; ++k, ++tried) {
    std::string noise(rng() % 40, ' ');
    for (char& c : noise) c = static_cast<char>(rng());
    if (k % 2 && !noise.empty()) noise[0] = "gGpPmMXZzcsvqQ"[rng() % 14];
    try_one(noise);
  }
  EXPECT_EQ(answered, tried);
  EXPECT_EQ(ask("m1000,1").size(), 2u);  // it still works
}

TEST(GdbPortTest, TakesPortsOnly) {
  EXPECT_EQ(parse_gdb_port(":1234"), 1234);
  EXPECT_EQ(parse_gdb_port("0"), 0);
  for (const char* text : {"", ":", ":65536", "host:1", ":-1", ":1x"})
    EXPECT_THROW(parse_gdb_port(text), std::runtime_error) << text;
}

}  // namespace
}  // namespace fovea::app
