// SPDX-License-Identifier: Apache-2.0
// A reference selector and what a stream brings it, sample by sample.
#pragma once

#include <gtest/gtest.h>

#include "slave/reference_selector.h"

namespace telekerf::slave {

inline constexpr double kDt_s = 1e-3;
inline constexpr double kCoast_s = 0.1;

class Selector : public testing::Test {
 protected:
  Selector() { selector_.rest_at(Vec3::Zero()); }

  static robot::RobotModel model() {
    robot::RobotModel model;
    model.workspace.radius_m = 0.01;
    model.workspace.height_m = 0.01;
    model.limits.velocity_m_per_s = 0.3;
    return model;
  }
  static streaming::StreamSample sample(Law law = Law::kLocal) {
    streaming::StreamSample sample;
    sample.engaged = true;
    sample.generation = 1;
    sample.block = 1;
    sample.law = law;
    sample.engage = 1;
    return sample;
  }
  /// The stream goes on by one sample.
  Selected play(const streaming::StreamSample& sample, const KinematicState& state,
                bool discontinuity = false) {
    streaming::Played played;
    played.fresh = true;
    played.index = ++index_;
    played.cursor = static_cast<double>(index_);
    played.tick = 2.0 * static_cast<double>(index_);
    played.sample = &sample;
    played.state = state;
    played.discontinuity = discontinuity;
    played.age_s = age_s_;
    return out_ = selector_.step(played, now_);
  }
  Selected miss(bool fresh = true) {
    streaming::Played played;
    played.fresh = fresh;
    played.index = ++index_;
    if (fresh) played.cursor = static_cast<double>(index_);
    return out_ = selector_.step(played, now_);
  }
  /// Nothing has come for a while, and the stream's time stands.
  Selected wait() {
    streaming::Played played;
    played.fresh = played.waits = true;
    played.index = index_ + 1;
    played.cursor = static_cast<double>(index_ + 1);
    return out_ = selector_.step(played, now_);
  }
  static KinematicState at(double x_m, double m_per_s = 0.0, double m_per_s2 = 0.0) {
    return {.position_m = Vec3(x_m, 0, 0),
            .velocity_m_per_s = Vec3(m_per_s, 0, 0),
            .acceleration_m_per_s2 = Vec3(m_per_s2, 0, 0)};
  }

  ReferenceSelector selector_{model(), {}, kDt_s};
  Selected out_;
  Circumstances now_{.heard = true};
  std::optional<double> age_s_ = 0.1;
  std::int64_t index_ = 0;
};

}  // namespace telekerf::slave
