// SPDX-License-Identifier: Apache-2.0
#include "common/bus/link_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace telekerf {
namespace {

constexpr double kBlock_ms = 16.0;    // between two blocks
constexpr double kFilling_ms = 15.0;  // of a block, before it is sent
constexpr double kMargin_ms = 2.0;    // of the play-out
constexpr double kMostPerSecond = 700.0;

struct Limits {
  double good;
  double fair;
};
constexpr Limits kJitter_ms{5.0, 20.0}, kLoss{0.001, 0.02}, kRtt_ms{100.0, 350.0}, kGap_ms{75.0, 150.0},
    kSkew_ppm{50.0, 200.0}, kAgeOfGate{0.8, 1.0};

LinkWord word_of(double value, Limits limits) {
  // What is no number is no good link.
  return value < limits.good ? LinkWord::kGood : value < limits.fair ? LinkWord::kFair : LinkWord::kBad;
}

double late_ms(const LinkWay& way) {
  double most = 0.0;
  for (const LinkFigures& rate : way.rates) most = std::max(most, rate.jitter_p999_ms);
  return most;
}

void judge_way(const LinkWay& way, const char* name, std::vector<LinkVerdict>& out) {
  static constexpr std::array<const char*, LinkWay::kRates> kRates{"block rate", "10 times block rate"};
  for (std::size_t n = 0; n < LinkWay::kRates; ++n) {
    const LinkFigures& f = way.rates[n];
    const std::string where = fmt::format(", {}, {}", name, kRates[n]);
    if (f.packets < 10.0) {
      out.push_back({"packets" + where, fmt::format("{:.0f}", f.packets), LinkWord::kBad,
                     "hardly anything arrives: does a firewall block UDP?"});
      continue;
    }
    out.push_back({"loss" + where, fmt::format("{:.2f} %", 100.0 * f.loss), word_of(f.loss, kLoss),
                   "a cable instead of radio, or --redundancy"});
    out.push_back({"jitter (p99.9)" + where, fmt::format("{:.1f} ms", f.jitter_p999_ms),
                   word_of(f.jitter_p999_ms, kJitter_ms),
                   "something else fills the link, or the computer is busy"});
    out.push_back({"longest gap" + where, fmt::format("{:.0f} ms", f.longest_gap_ms),
                   word_of(f.longest_gap_ms, kGap_ms), "the slave holds after --stale-s without commands"});
  }
  out.push_back({fmt::format("clock skew, {}", name), fmt::format("{:.0f} ppm", way.skew_ppm),
                 word_of(std::abs(way.skew_ppm), kSkew_ppm), "one of the computers has a bad clock"});
}

}  // namespace

const char* text_of(LinkWord word) noexcept {
  return word == LinkWord::kGood ? "good" : word == LinkWord::kFair ? "fair" : "bad";
}

LinkMeter::LinkMeter(double seconds) {
  for (auto& packets : packets_) packets.reserve(static_cast<std::size_t>(seconds * kMostPerSecond) + 1000);
}

void LinkMeter::add(std::size_t rate, std::uint32_t number, std::int64_t sent_ns, std::int64_t received_ns) {
  if (rate < packets_.size() && packets_[rate].size() < packets_[rate].capacity())
    packets_[rate].push_back({number, sent_ns, received_ns});
}

LinkWay LinkMeter::result() const {
  LinkWay way;
  for (std::size_t n = 0; n < packets_.size(); ++n) {
    const auto& packets = packets_[n];
    LinkFigures& f = way.rates[n];
    f.packets = static_cast<double>(packets.size());
    if (packets.size() < 2) continue;
    std::vector<std::uint32_t> numbers;
    std::vector<double> transit_ms;
    for (std::size_t i = 0; i < packets.size(); ++i) {
      numbers.push_back(packets[i].number);
      transit_ms.push_back(static_cast<double>(packets[i].received_ns - packets[i].sent_ns) * 1e-6);
      if (i > 0)
        f.longest_gap_ms =
            std::max(f.longest_gap_ms,
                     static_cast<double>(packets[i].received_ns - packets[i - 1].received_ns) * 1e-6);
    }
    std::sort(numbers.begin(), numbers.end());
    const auto different = std::unique(numbers.begin(), numbers.end()) - numbers.begin();
    const double sent =
        static_cast<double>(numbers[static_cast<std::size_t>(different - 1)] - numbers.front()) + 1.0;
    f.loss = 1.0 - static_cast<double>(different) / sent;
    const double fastest = *std::min_element(transit_ms.begin(), transit_ms.end());
    const auto rank = std::min(transit_ms.size() - 1,
                               static_cast<std::size_t>(0.999 * static_cast<double>(transit_ms.size())));
    std::nth_element(transit_ms.begin(), transit_ms.begin() + static_cast<std::ptrdiff_t>(rank),
                     transit_ms.end());
    f.jitter_p999_ms = transit_ms[rank] - fastest;
  }
  // The fastest of the first and of the last third of the quicker rate: delay can only add to either.
  const auto& packets = packets_[1];
  if (packets.size() >= 30) {
    const std::size_t third = packets.size() / 3;
    const auto fastest = [&](std::size_t from) {
      return *std::min_element(packets.begin() + static_cast<std::ptrdiff_t>(from),
                               packets.begin() + static_cast<std::ptrdiff_t>(from + third),
                               [](const Packet& a, const Packet& b) {
                                 return a.received_ns - a.sent_ns < b.received_ns - b.sent_ns;
                               });
    };
    const Packet first = fastest(0), last = fastest(packets.size() - third);
    const auto apart_ns = static_cast<double>(last.sent_ns - first.sent_ns);
    if (apart_ns > 0.0)
      way.skew_ppm = 1e6 * static_cast<double>(last.received_ns - first.received_ns) / apart_ns - 1e6;
  }
  return way;
}

double expected_age_ms(const LinkReport& report) {
  return report.rtt_p99_ms + kBlock_ms + kFilling_ms + kMargin_ms + late_ms(report.forward);
}

std::vector<LinkVerdict> judged(const LinkReport& report) {
  std::vector<LinkVerdict> out;
  judge_way(report.forward, "operator to slave", out);
  judge_way(report.backward, "slave to operator", out);
  out.push_back(
      {"round trip (p99)", fmt::format("{:.1f} ms, median {:.1f} ms", report.rtt_p99_ms, report.rtt_p50_ms),
       word_of(report.rtt_p99_ms, kRtt_ms), "a shorter way, or patience: delay costs time, not accuracy"});
  const double age_ms = expected_age_ms(report);
  out.push_back(
      {"age of commands",
       fmt::format("about {:.0f} ms, light up to {:.0f} ms", age_ms, 1e3 * report.beam_age_s),
       word_of(age_ms / (1e3 * report.beam_age_s), kAgeOfGate),
       fmt::format("start the slave with --beam-age-s {:.2g} or more, at most 2", 1.3e-3 * age_ms)});
  return out;
}

LinkWord worst(const std::vector<LinkVerdict>& verdicts) {
  LinkWord word = LinkWord::kGood;
  for (const LinkVerdict& verdict : verdicts) word = std::max(word, verdict.word);
  return word;
}

NamedNumbers numbers_of(const LinkWay& way) {
  NamedNumbers numbers{{"skew_ppm", way.skew_ppm}};
  for (std::size_t n = 0; n < LinkWay::kRates; ++n) {
    const std::string name = LinkWay::kNames[n];
    numbers.emplace_back(name + ".packets", way.rates[n].packets);
    numbers.emplace_back(name + ".loss", way.rates[n].loss);
    numbers.emplace_back(name + ".jitter_p999_ms", way.rates[n].jitter_p999_ms);
    numbers.emplace_back(name + ".longest_gap_ms", way.rates[n].longest_gap_ms);
  }
  return numbers;
}

void read_numbers(const NamedNumbers& numbers, LinkWay& way) {
  for (const auto& [name, value] : numbers) {
    if (name == "skew_ppm") way.skew_ppm = value;
    for (std::size_t n = 0; n < LinkWay::kRates; ++n) {
      const std::string rate = LinkWay::kNames[n];
      if (name == rate + ".packets") way.rates[n].packets = value;
      if (name == rate + ".loss") way.rates[n].loss = value;
      if (name == rate + ".jitter_p999_ms") way.rates[n].jitter_p999_ms = value;
      if (name == rate + ".longest_gap_ms") way.rates[n].longest_gap_ms = value;
    }
  }
}

}  // namespace telekerf
