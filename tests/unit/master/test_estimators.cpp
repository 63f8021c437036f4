// SPDX-License-Identifier: Apache-2.0
// What holds for every estimator, whatever its idea of the slave.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "common/runtime/startup_error.h"
#include "master/observer/network_observer.h"

namespace telekerf::master {
namespace {

/// The smallest thing that may be called an estimator: it believes the commands.
class Believer {
 public:
  explicit Believer(const EstimatorSettings& settings) noexcept : period_s_(settings.period_s) {}
  void reset(std::int64_t /*index*/, const KinematicState& state) noexcept { state_ = state; }
  void predict(const CommandHistory& history, std::int64_t index) noexcept {
    state_.acceleration_m_per_s2 = history.acceleration(index);
    state_ = advanced(state_, period_s_);
  }
  void correct(const CommandHistory& /*history*/, const SlaveSample& /*sample*/,
               std::int64_t /*next*/) noexcept {}
  KinematicState predicted_state(const CommandHistory& /*history*/, std::int64_t /*next*/) const noexcept {
    return state_;
  }

 private:
  double period_s_;
  KinematicState state_;
};
static_assert(Estimator<Believer>);
static_assert(!RevisesCommands<Believer> && !EstimatesDisturbance<Believer> && !HasInnovation<Believer> &&
              !CorrectsModel<Believer>);
struct Mute : Believer {
  using Believer::Believer;
  void correct(const CommandHistory&, const SlaveSample&, std::int64_t) = delete;
};
static_assert(!Estimator<Mute>);

TEST(Estimators, TheirNamesAreDistinctAndAnUnknownOneIsRefusedWithTheList) {
  std::set<std::string_view> words;
  for (const auto& row : kEstimators) {
    EXPECT_TRUE(words.insert(row.word).second) << row.word;
    EXPECT_EQ(estimator_named(std::string(row.word)), row.value);
    EXPECT_FALSE(row.sentence.empty()) << row.word;
  }
  try {
    (void)estimator_named("guess");
    FAIL() << "accepted";
  } catch (const StartupError& error) {
    for (const std::string_view word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word;
    }
  }
}

/// A slave that does exactly as it is told, 40 samples later, is predicted exactly, or seen as late as it is.
TEST(Estimators, EachFindsASlaveThatDoesAsItIsTold) {
  constexpr double kH = 1e-3;
  constexpr int kDelay = 40;
  for (const auto& row : kEstimators) {
    for (const Law law : {Law::kAnchored, Law::kRemoteAcceleration}) {
      ObserverSettings settings;
      settings.period_s = kH;
      settings.estimator = row.value;
      NetworkObserver observer(law, settings);
      const KinematicState start{.position_m = Vec3(1e-3, 0.0, 0.0)};
      observer.reset(0, start);
      std::vector<KinematicState> truth{start};
      double worst_m = 0.0;
      for (std::int64_t k = 0; k < 4000; ++k) {
        if (k >= kDelay) {
          const KinematicState& then = truth[static_cast<std::size_t>(k - kDelay)];
          const SlaveSample sample{k - kDelay, k, true, then.position_m, then.velocity_m_per_s};
          observer.correct({&sample, 1});
        }
        const KinematicState predicted = observer.predicted_state(truth.back());
        worst_m = std::max(worst_m, (predicted.position_m - truth.back().position_m).norm());
        const Vec3 u(0.4 * std::sin(0.01 * static_cast<double>(k)), 0.0, 0.0);
        observer.predict(k, truth.back(), u);
        KinematicState now = truth.back();
        now.acceleration_m_per_s2 = u;
        truth.push_back(advanced(now, kH));
      }
      const double moved_m = 0.08 * kH * kDelay;  // at the fastest, within the delay
      if (row.word == "none") {
        EXPECT_GT(worst_m, 0.5 * moved_m) << "it lags by the delay";
        EXPECT_LT(worst_m, 2.0 * moved_m);
      } else {
        EXPECT_LT(worst_m, row.word == "thesis" || row.word == "thesis-convergent" ? 0.5 * moved_m : 1e-9)
            << row.word;
      }
    }
  }
}

}  // namespace
}  // namespace telekerf::master
