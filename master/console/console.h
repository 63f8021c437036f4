// SPDX-License-Identifier: Apache-2.0
// The console between pages and cell, without socket and bus: what pages say goes to hand, events and stops;
// what the cell tells goes to the pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/protocol/messages.h"
#include "common/recording/run_record.h"
#include "master/console/cell_view.h"
#include "master/console/depth_plan.h"
#include "master/console/driver_seat.h"
#include "master/console/page_protocol.h"
#include "master/console/stop_call.h"

namespace telekerf::master {

struct ConsoleSettings {
  std::string cell;
  std::string source = "operator";    ///< who stops
  std::string token;                  ///< a page that drives must know it
  std::vector<std::string> profiles;  ///< networks that may be asked for
  std::uint32_t epoch = 1;            ///< of this process
  CutPower cut = {};                  ///< as the slave's
};

/// One message to one page.
struct PageMessage {
  bool binary = false;
  std::string bytes;
};

/// Pure: time is what it is told, and what is to be sent is returned. Of each page only the newest state
/// waits, so that a slow one slows nobody.
class Console {
 public:
  explicit Console(ConsoleSettings settings);

  /// To be sent since the last step.
  struct Outbox {
    std::vector<UdpHandFrame> hand;
    std::vector<EventMessage> events;
  };
  struct Counters {
    std::uint64_t malformed = 0;  ///< frames and commands that were none
    std::uint64_t flooded = 0;    ///< beyond what a page may send in a second
    std::uint64_t refused = 0;    ///< commands that this page may not give, or not now, or that the cell refused
  };

  std::uint32_t join(std::int64_t now_ns);
  /// A page that drove has let go by that.
  void leave(std::uint32_t page, std::int64_t now_ns);
  void hear_frame(std::uint32_t page, std::span<const std::byte> bytes, std::int64_t now_ns);
  void hear_command(std::uint32_t page, std::string_view json, std::int64_t now_ns);
  /// The master's answer to the hand.
  void hear(const UdpHandAnswer& answer) noexcept;
  /// What became of an event: who drives is told of a refusal of this console's own, once; and which network the cell is
  /// told to emulate.
  void hear(const EventMessage& event, std::int64_t now_ns);
  CellView& cell() noexcept { return cell_; }
  StopCall& stop() noexcept { return stop_; }

  /// Every pause_ns() at least.
  void step(std::int64_t now_ns);
  std::int64_t pause_ns() const noexcept;
  Outbox take_outbox();
  /// What this page is to get next; none: nothing now. The page must be able to take it.
  std::optional<PageMessage> next(std::uint32_t page, std::int64_t now_ns);

  /// The contour with this id, once for each page and contour; {"id":0} if it is not (any more) there.
  std::string contour_json(std::uint32_t id) const;
  const Counters& counters() const noexcept { return counters_; }
  /// What is counted, under the names of docs/reference/console.md.
  void add_figures(Metrics& figures) const;

 private:
  struct Page {
    bool greeted = false;
    std::int64_t period_ns = 16'000'000;  ///< between states
    std::int64_t state_ns = 0;            ///< of the last one,
    std::int64_t due_ns = 0;              ///< and when the next one is due
    std::uint64_t answered = 0;           ///< answers of the master that it has seen
    std::uint32_t mark_generation = ~0U;
    std::size_t marks = 0;      ///< that it has got
    std::string words;          ///< that it has got
    std::int64_t words_ns = 0;  ///< when they were looked at
    std::uint64_t depths = 0;   ///< which it has got, and when
    std::int64_t depths_ns = 0;
    std::vector<std::string> said;  ///< answers to it alone; of many the newest
    std::optional<double> ping;
    std::int64_t second_ns = 0;
    int heard = 0;  ///< in this second
  };

  bool floods(Page& page, std::int64_t now_ns);
  void obey(std::uint32_t id, Page& page, const PageCommand& command, std::int64_t now_ns);
  void answer(Page& page, std::string text);
  void refuse(Page& page, const std::string& why);
  /// The same to who drives, if somebody does.
  void refuse_driver(const std::string& why);
  /// A stop takes the hand away, whoever says it.
  void vacate(std::int64_t now_ns);
  void tell(EventMessage::Kind kind, double value = 0.0, const std::string& text = {});
  /// The hand is let go of, without waiting for the lease.
  void release(std::int64_t now_ns);
  std::string words(std::uint32_t id, std::int64_t now_ns) const;
  PageMessage state(std::uint32_t id, std::int64_t now_ns);
  /// Frames go out, and the master answers none of them.
  bool deaf(std::int64_t now_ns) const noexcept;
  std::string depth_sentence() const;
  /// What became of a scale that was asked for.
  void follow_up(std::int64_t now_ns);

  ConsoleSettings settings_;
  CellView cell_;
  StopCall stop_;
  DriverSeat seat_;
  std::map<std::uint32_t, Page> pages_;
  std::uint32_t last_page_ = 0;
  std::uint32_t last_stop_;
  Outbox outbox_;
  UdpHandFrame last_hand_;
  std::optional<UdpHandAnswer> answer_;
  std::uint64_t answers_ = 0;
  double echo_ms_;
  double step_s_ = 0.0;
  std::string profile_;   ///< that the cell was told to emulate last; empty: not yet
  bool stopped_ = false;  ///< a stop was in force at the last step
  std::map<std::string, std::int64_t> refusals_;  ///< of the cell, and when: each is said twice on the bus
  std::int64_t sent_ns_ = 0;     ///< of the newest frame,
  std::int64_t unheard_ns_ = 0;  ///< and of the first since the master's last answer; 0: none
  double asked_beta_ = 0.0;      ///< a scale that was asked for; 0: none,
  std::int64_t asked_ns_ = 0;    ///< and when
  Counters counters_;
};

}  // namespace telekerf::master
