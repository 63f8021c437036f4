// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/run_playback.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/reporting/run_lookup.h"

namespace telekerf::reporting {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are little endian");

using Moment = std::array<float, kPlaybackFields.size()>;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// A speed is that over so many ticks before and after.
constexpr std::size_t kSpeedTicks = 5;

/// Of rows in order of time, the last one that is not after it.
template <typename Row>
const Row* row_at_time(const std::vector<Row>& rows, double t_s) {
  const auto later =
      std::upper_bound(rows.begin(), rows.end(), t_s, [](double t, const Row& row) { return t < row.t_s; });
  return later == rows.begin() ? nullptr : &*(later - 1);
}

template <typename Row>
double speed(const std::vector<Row>& rows, std::size_t n) {
  const Row& before = rows[n - std::min(n, kSpeedTicks)];
  const Row& after = rows[std::min(n + kSpeedTicks, rows.size() - 1)];
  const double passed_s = after.t_s - before.t_s;
  return passed_s > 0.0 ? in_plane(after.tool_m - before.tool_m).norm() / passed_s : 0.0;
}

/// Length of the master's tick.
double step_s(const RunRecord& record) {
  const auto& rows = record.master;
  return rows.size() < 2 ? 0.0 : (rows.back().t_s - rows.front().t_s) / static_cast<double>(rows.size() - 1);
}

/// Fills a moment in the order of the fields.
class Cells {
 public:
  explicit Cells(Moment& moment) : moment_(moment) {}
  Cells& operator<<(double value) {
    moment_[next_++] = static_cast<float>(value);
    return *this;
  }
  Cells& operator<<(const Vec2& value) { return *this << value.x() << value.y(); }

 private:
  Moment& moment_;
  std::size_t next_ = 0;
};

class Playback {
 public:
  explicit Playback(const RunRecord& record)
      : record_(record), contours_(record), clock_offset_s_(1e-6 * metric(record.master_figures, "clock_offset_us")) {}

  /// Of the master's row n.
  Moment moment(std::size_t n) const {
    const MasterRow& master = record_.master[n];
    Moment moment;
    moment.fill(static_cast<float>(kUnknown));
    Cells cells(moment);
    const Vec2 tool_m = master.beta * in_plane(master.tool_m);
    cells << master.t_s - record_.master.front().t_s << master.engaged << master.button << master.beta << tool_m
          << master.beta * speed(record_.master, n) << in_plane(master.hand_n) << master.constraint_n
          << contours_.at(static_cast<double>(master.tick)).find(tool_m).signed_distance_m;
    const SlaveRow* slave = row_at_time(record_.slave, master.t_s + clock_offset_s_);
    if (slave != nullptr) add(*slave, master, cells);
    return moment;
  }

 private:
  void add(const SlaveRow& slave, const MasterRow& master, Cells& cells) const {
    const auto n = static_cast<std::size_t>(&slave - record_.slave.data());
    cells << in_plane(slave.tool_m) << slave.tool_m.z() << speed(record_.slave, n) << slave.laser_w
          << slave.interlock << slave.applied;
    const auto source_m =
        slave.applied >= 0.0 ? master_at(record_, slave.applied, &MasterRow::tool_m) : std::nullopt;
    if (source_m) {
      const Vec3 scaled_m = beta_at(record_, slave.applied) * *source_m;
      cells << (static_cast<double>(master.tick) - slave.applied) * step_s(record_)
            << (slave.tool_m - scaled_m).norm();
    } else {
      cells << kUnknown << kUnknown;
    }
    cells << in_plane(master.predicted_m)
          << (source_m ? (slave.tool_m - *master_at(record_, slave.applied, &MasterRow::predicted_m)).norm()
                       : kUnknown)
          << slave.force_n.norm();
  }

  const RunRecord& record_;
  Contours contours_;
  double clock_offset_s_;
};

nlohmann::ordered_json contours_json(const RunRecord& record, std::size_t every) {
  auto list = nlohmann::ordered_json::array();
  std::uint64_t from_tick = record.master.empty() ? 0 : record.master.front().tick;
  const std::uint64_t first_tick = from_tick;
  const auto add = [&](bool closed, const std::vector<Vec2>& points_m) {
    auto points = nlohmann::ordered_json::array();
    for (const Vec2& point : points_m) {
      for (const double m : {point.x(), point.y()}) points.push_back(std::round(m * 1e8) / 1e8);
    }
    list.push_back({{"from_row", (from_tick - first_tick) / every}, {"closed", closed}, {"points", points}});
  };
  for (const EarlierContour& earlier : record.earlier) {
    add(earlier.closed, earlier.points_m);
    from_tick = std::max(earlier.until_tick, first_tick);
  }
  if (!record.contour_m.empty()) add(record.contour_closed, record.contour_m);
  return list;
}

}  // namespace

std::string playback_of(const RunRecord& record, const PlaybackHead& head) {
  const std::size_t every = 1 + (record.master.empty() ? 0 : (record.master.size() - 1) / kMostPlaybackRows);
  const std::size_t rows = (record.master.size() + every - 1) / every;
  nlohmann::ordered_json json{{"name", head.name},
                              {"created", head.created},
                              {"state", head.state},
                              {"fields", kPlaybackFields},
                              {"rows", rows},
                              {"every", every},
                              {"step_s", static_cast<double>(every) * step_s(record)},
                              {"contours", contours_json(record, every)},
                              {"words", record.words}};
  std::string text = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes;
  bytes.reserve(4 + text.size() + rows * sizeof(Moment));
  const auto append = [&bytes](const auto& value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    bytes.append(raw.data(), raw.size());
  };
  append(static_cast<std::uint32_t>(text.size()));
  bytes += text;
  const Playback playback(record);
  for (std::size_t n = 0; n < record.master.size(); n += every) append(playback.moment(n));
  return bytes;
}

}  // namespace telekerf::reporting
