// SPDX-License-Identifier: Apache-2.0
// What a link is worth, by the packets that have crossed it: figures, thresholds, and words for people.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace telekerf {

enum class LinkWord : std::uint8_t { kGood, kFair, kBad };
const char* text_of(LinkWord word) noexcept;

/// Packets that were sent at one rate, one way, as their receiver counted them. Milliseconds; loss is a
/// fraction.
struct LinkFigures {
  double packets = 0.0;         ///< received
  double loss = 0.0;            ///< of those that were numbered in between
  double jitter_p999_ms = 0.0;  ///< one way: 99.9 % came at most this much later than the fastest
  double longest_gap_ms = 0.0;  ///< between two that came
};

/// One way of a link: at the rate of the blocks, and at ten times that.
struct LinkWay {
  static constexpr std::size_t kRates = 2;
  static constexpr std::array<const char*, kRates> kNames{"block_rate", "ten_times"};
  std::array<LinkFigures, kRates> rates;
  double skew_ppm = 0.0;  ///< how much faster the receiver's clock goes than the sender's
};

/// Collects one way. Fixed memory from the first packet on.
class LinkMeter {
 public:
  explicit LinkMeter(double seconds);
  /// `rate`: index into LinkWay::rates. Stamps: the sender's and the receiver's clock.
  void add(std::size_t rate, std::uint32_t number, std::int64_t sent_ns, std::int64_t received_ns);
  LinkWay result() const;

 private:
  struct Packet {
    std::uint32_t number;
    std::int64_t sent_ns;
    std::int64_t received_ns;
  };
  std::array<std::vector<Packet>, LinkWay::kRates> packets_;
};

/// Both ways and the round trip, as both sides know them after the test.
struct LinkReport {
  LinkWay forward;   ///< operator -> slave
  LinkWay backward;  ///< slave -> operator
  double rtt_p50_ms = 0.0;
  double rtt_p99_ms = 0.0;   ///< of the network alone
  double beam_age_s = 0.35;  ///< the slave's gate
};

/// How old a command will be when the slave applies it, there and back: round trip, the time between two
/// states, the filling of a block and what the play-out waits for. Blocks of 16 samples at 1 kHz.
double expected_age_ms(const LinkReport& report);

/// One figure judged.
struct LinkVerdict {
  std::string what;  ///< "loss, operator to slave"
  std::string value;
  LinkWord word = LinkWord::kGood;
  std::string remedy;  ///< of what is not good
};
/// Every figure in turn. Thresholds: jitter 5 and 20 ms, loss 0.1 and 2 %, round trip 100 and 350 ms, longest
/// gap 75 and 150 ms (half of stale_s, and stale_s), skew 50 and 200 ppm, age 80 and 100 % of the gate.
std::vector<LinkVerdict> judged(const LinkReport& report);
/// The worst of them.
LinkWord worst(const std::vector<LinkVerdict>& verdicts);

/// For the other side, and back. What is not there stays as it is.
using NamedNumbers = std::vector<std::pair<std::string, double>>;
NamedNumbers numbers_of(const LinkWay& way);
void read_numbers(const NamedNumbers& numbers, LinkWay& way);

}  // namespace telekerf
