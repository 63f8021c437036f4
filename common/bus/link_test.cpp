// SPDX-License-Identifier: Apache-2.0
#include "common/bus/link_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <type_traits>
#include <vector>

#include "common/bus/endpoints.h"
#include "common/bus/link_quality.h"
#include "common/bus/lookout.h"
#include "common/runtime/clock.h"
#include "common/runtime/loop.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

/// Of the samples of a packet, which also says at which rate it was sent.
constexpr std::array<std::uint32_t, LinkWay::kRates> kSamplePeriod_ns{1'000'000, 100'000};
constexpr std::int64_t kTestSamples = 16;
constexpr std::uint16_t kPayloadBytes = 60;  // what the default codec makes of a block
constexpr std::chrono::seconds kFound{20};
constexpr std::int64_t kLinger_ns = 4'000'000'000;
constexpr std::int64_t kTell_ns = 100'000'000;

/// One side; `Out` and `In`: the blocks that it sends and receives.
template <class Out, class In>
class Side {
 public:
  Side(BusSettings settings, const LinkTestFlags& flags, double beam_age_s)
      : master_(std::is_same_v<Out, CommandBlock>),
        flags_(flags),
        bus_(std::move(settings)),
        status_(master_ ? "master" : "slave"),
        writer_(bus_),
        reader_(bus_, 4096),
        say_(bus_),
        hear_(bus_),
        meter_(flags.link_test_s) {
    report_.beam_age_s = beam_age_s;
  }

  int run() {
    find();
    status_.say(fmt::format("testing the link for {:g} s", flags_.link_test_s));
    start_ns_ = monotonic_ns();
    const auto send_ns = static_cast<std::int64_t>(1e9 * flags_.link_test_s);
    std::int64_t next_ns = start_ns_, tell_ns = start_ns_ + send_ns;
    bool told = false;
    for (std::int64_t now_ns = start_ns_; now_ns < start_ns_ + send_ns + kLinger_ns && !stop_requested();
         now_ns = monotonic_ns()) {
      receive();
      const std::int64_t passed_ns = now_ns - start_ns_;
      if (passed_ns < send_ns && now_ns >= next_ns) {
        const std::size_t rate = passed_ns < send_ns / 2 ? 0 : 1;
        send(rate, now_ns);
        next_ns = std::max(next_ns + kTestSamples * kSamplePeriod_ns[rate],
                           now_ns - kTestSamples * kSamplePeriod_ns[rate]);
      }
      // Half a second after the last packet everything is there that will ever come.
      if (now_ns >= tell_ns + 5 * kTell_ns) {
        tell();
        tell_ns += kTell_ns;
        told = hear() || told;
        if (told && now_ns > start_ns_ + send_ns + 15 * kTell_ns) break;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
    if (stop_requested()) throw environment_error("the link test was interrupted");
    if (!told)
      throw environment_error(
          fmt::format("the {} does not answer to the link test: start it with --link-test, too", other()));
    return print();
  }

 private:
  const char* other() const { return master_ ? "slave" : "master"; }

  void find() {
    const auto end = std::chrono::steady_clock::now() + kFound;
    auto say = std::chrono::steady_clock::now() + std::chrono::seconds(3);
    while (reader_.writers() == 0 || writer_.readers() == 0) {
      if (stop_requested()) throw environment_error("the link test was interrupted");
      const auto now = std::chrono::steady_clock::now();
      const std::string sentence =
          waiting_sentence(bus_, fmt::format("telekerf-{} --link-test", other()), other());
      if (now > end) throw environment_error(sentence);
      if (now > say) {
        status_.say(sentence);
        say = now + std::chrono::seconds(5);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  void send(std::size_t rate, std::int64_t now_ns) {
    Out block;
    block.sequence = ++sequence_;
    block.epoch = bus_.settings().epoch;
    block.sample_period_ns = kSamplePeriod_ns[rate];
    block.payload.size = kPayloadBytes;
    if constexpr (std::is_same_v<Out, StateBlock>) {
      block.echo_sequence = echo_sequence_;
      block.echo_sent_ns = echo_sent_ns_;
      block.echo_received_ns = echo_received_ns_;
    }
    block.sent_ns = now_ns;
    (void)writer_.write(block);
  }

  void receive() {
    while (const auto received = reader_.take()) {
      const In& block = received->value;
      const auto rate = std::find(kSamplePeriod_ns.begin(), kSamplePeriod_ns.end(), block.sample_period_ns);
      if (rate == kSamplePeriod_ns.end()) continue;
      meter_.add(static_cast<std::size_t>(rate - kSamplePeriod_ns.begin()), block.sequence, block.sent_ns,
                 received->received_ns);
      if constexpr (std::is_same_v<In, CommandBlock>) {
        echo_sequence_ = block.sequence;
        echo_sent_ns_ = block.sent_ns;
        echo_received_ns_ = received->received_ns;
      } else if (block.echo_sequence > echo_sequence_) {
        echo_sequence_ = block.echo_sequence;
        const std::int64_t held_ns = block.sent_ns - block.echo_received_ns;
        rtt_ms_.push_back(static_cast<double>(received->received_ns - block.echo_sent_ns - held_ns) * 1e-6);
      }
    }
  }

  void tell() {
    TelemetryMessage message{.role = std::string("link-test ") + (master_ ? "master" : "slave"),
                             .tick = 0,
                             .values = numbers_of(meter_.result())};
    if (master_) {
      message.values.emplace_back("rtt_p50_ms", quantile(0.5));
      message.values.emplace_back("rtt_p99_ms", quantile(0.99));
    } else {
      message.values.emplace_back("beam_age_s", report_.beam_age_s);
    }
    (void)say_.write(message);
  }

  bool hear() {
    bool heard = false;
    while (const auto received = hear_.take()) {
      if (received->value.role != std::string("link-test ") + other()) continue;
      heard = true;
      read_numbers(received->value.values, master_ ? report_.forward : report_.backward);
      for (const auto& [name, value] : received->value.values) {
        if (name == "rtt_p50_ms") report_.rtt_p50_ms = value;
        if (name == "rtt_p99_ms") report_.rtt_p99_ms = value;
        if (name == "beam_age_s") report_.beam_age_s = value;
      }
    }
    return heard;
  }

  double quantile(double fraction) const {
    if (rtt_ms_.empty()) return 1e4;
    std::vector<double> sorted = rtt_ms_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))];
  }

  int print() {
    (master_ ? report_.backward : report_.forward) = meter_.result();
    if (master_) {
      report_.rtt_p50_ms = quantile(0.5);
      report_.rtt_p99_ms = quantile(0.99);
    }
    const std::vector<LinkVerdict> verdicts = judged(report_);
    const LinkWord word = worst(verdicts);
    if (flags_.json) {
      nlohmann::ordered_json json{{"verdict", text_of(word)},
                                  {"rtt_p50_ms", report_.rtt_p50_ms},
                                  {"rtt_p99_ms", report_.rtt_p99_ms},
                                  {"expected_age_ms", expected_age_ms(report_)},
                                  {"beam_age_ms", 1e3 * report_.beam_age_s}};
      for (const auto& [name, way] :
           {std::pair{"forward", report_.forward}, std::pair{"backward", report_.backward}})
        for (const auto& [figure, value] : numbers_of(way)) json[name][figure] = value;
      for (const LinkVerdict& verdict : verdicts)
        json["verdicts"].push_back(
            {{"what", verdict.what}, {"value", verdict.value}, {"word", text_of(verdict.word)}});
      for (const std::string& note : bus_.notes()) json["notes"].push_back(note);
      fmt::print("{}\n", json.dump(2));
    } else {
      for (const LinkVerdict& verdict : verdicts)
        fmt::print("  {:<56} {:<34} {}{}\n", verdict.what, verdict.value, text_of(verdict.word),
                   verdict.word == LinkWord::kGood ? "" : ": " + verdict.remedy);
      for (const std::string& note : bus_.notes()) fmt::print("  {}\n", note);
      fmt::print("{}: the link is {}{}\n", master_ ? "master" : "slave", text_of(word),
                 word == LinkWord::kBad ? " for this work" : "");
    }
    return word == LinkWord::kBad ? 1 : 0;
  }

  bool master_;
  LinkTestFlags flags_;
  Bus bus_;
  StatusReporter status_;
  Writer<Out> writer_;
  Reader<In> reader_;
  Writer<TelemetryMessage> say_;
  Reader<TelemetryMessage> hear_;
  LinkMeter meter_;
  LinkReport report_;
  std::int64_t start_ns_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint32_t echo_sequence_ = 0;
  std::int64_t echo_sent_ns_ = 0, echo_received_ns_ = 0;
  std::vector<double> rtt_ms_;
};

}  // namespace

void LinkTestFlags::add_parameters(Settings& settings) {
  settings.add(
      "link_test", link_test,
      "tries the link with the other side's --link-test, says what it is worth, and ends; nothing moves");
  settings.add("link_test_s", link_test_s, {.min = 1, .max = 600, .unit = "s"}, "how long the link is tried");
  settings.add("peer", peer,
               TextForm{.form = "HOST",
                        .complaint =
                            [](const std::string& text) {
                              return text.empty() ? std::string() : complaint_about_peer(text);
                            }},
               "the other side's host, where multicast does not reach it; as one of peers");
  settings.add("json", json, "link_test says its figures as JSON");
}

int run_link_test(BusSettings settings, const LinkTestFlags& flags, double beam_age_s) {
  catch_stop_signals();
  if (settings.role == "master")
    return Side<CommandBlock, StateBlock>(std::move(settings), flags, beam_age_s).run();
  return Side<StateBlock, CommandBlock>(std::move(settings), flags, beam_age_s).run();
}

}  // namespace telekerf
