// SPDX-License-Identifier: Apache-2.0
#include "experiments/codec/codec_traces.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace telekerf::experiments {
namespace {

using std::numbers::pi;

/// Numbers that no standard library may choose differently.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double normal() {  // Box-Muller
    return std::sqrt(-2.0 * std::log(1.0 - uniform())) * std::cos(2 * pi * uniform());
  }

 private:
  std::mt19937_64 engine_;
};

/// Band-limited noise as a sum of sines: smooth, so that derivatives are exact.
class Band {
 public:
  /// Standard deviation `sd`; the amplitude falls as 1 / f^slope within the band.
  Band(Random& random, double from_hz, double to_hz, double sd, double slope) {
    double power = 0;
    for (auto& tone : tones_) {
      tone.omega = 2 * pi * (from_hz + (to_hz - from_hz) * random.uniform());
      tone.phase = 2 * pi * random.uniform();
      tone.amplitude = std::pow(tone.omega, -slope);
      power += tone.amplitude * tone.amplitude / 2;
    }
    for (auto& tone : tones_) tone.amplitude *= sd / std::sqrt(power);
  }
  double operator()(double t) const {
    double sum = 0;
    for (const auto& tone : tones_) sum += tone.amplitude * std::sin(tone.omega * t + tone.phase);
    return sum;
  }
  double acceleration(double t) const {
    double sum = 0;
    for (const auto& tone : tones_) {
      sum -= tone.omega * tone.omega * tone.amplitude * std::sin(tone.omega * t + tone.phase);
    }
    return sum;
  }

 private:
  struct Tone {
    double omega, phase, amplitude;
  };
  std::array<Tone, 40> tones_;
};

double rounded(double x, double step) { return std::round(x / step) * step; }

struct Hand {
  explicit Hand(Random& random)
      : wander{Band(random, 0.05, 0.6, 0.025, 1.5), Band(random, 0.05, 0.6, 0.02, 1.5),
               Band(random, 0.05, 0.6, 1e-3, 1.5)},
        tremor{Band(random, 8, 10, 35e-6, 0), Band(random, 8, 10, 35e-6, 0), Band(random, 8, 10, 20e-6, 0)} {}
  double operator()(std::size_t axis, double t) const { return wander[axis](t) + tremor[axis](t); }
  double acceleration(std::size_t axis, double t) const {
    return wander[axis].acceleration(t) + tremor[axis].acceleration(t);
  }
  std::array<Band, 3> wander;
  std::array<Band, 3> tremor;
};

/// A star with rounded arms, followed at about 10 mm/s with a human's unsteadiness.
struct ContourRound {
  explicit ContourRound(Random& random)
      : speed(random, 0.2, 2, 0.25, 1), off{Band(random, 1, 12, 30e-6, 1), Band(random, 1, 12, 30e-6, 1)} {}
  double operator()(std::size_t axis, double t) const {
    const double angle = 2 * pi * (t + 0.3 * speed(t)) / 20.0;
    const double radius = 0.02 * (1 + 0.25 * std::cos(5 * angle));
    if (axis == 2) return 0.1;
    return radius * (axis == 0 ? std::cos(angle) : std::sin(angle)) + off[axis](t);
  }
  Band speed;
  std::array<Band, 2> off;
};

using Signal = std::function<double(std::size_t axis, double t)>;

codec::Trace sample(const char* name, double seconds, double rate_hz, const Signal& signal) {
  codec::Trace trace{name, {"x", "y", "z"}, {}, rate_hz};
  const auto count = static_cast<std::size_t>(std::llround(seconds * rate_hz));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> column(count);
    for (std::size_t n = 0; n < count; ++n) column[n] = signal(axis, static_cast<double>(n) / rate_hz);
    trace.values.push_back(std::move(column));
  }
  return trace;
}

}  // namespace

std::vector<SeededTrace> seeded_traces(double seconds, double rate_hz, std::uint64_t seed) {
  Random random(seed);
  const Hand hand(random);
  const ContourRound contour(random);
  const std::array<Band, 3> push{Band(random, 0.1, 3, 1.5, 1), Band(random, 0.1, 3, 0.5, 1),
                                 Band(random, 0.1, 3, 0.2, 1)};
  const std::array<Band, 3> chatter{Band(random, 15, 45, 0.06, 0), Band(random, 15, 45, 0.08, 0),
                                    Band(random, 15, 45, 0.03, 0)};
  std::vector<SeededTrace> all;
  const auto add = [&](const char* name, const char* unit, double fine, bool is_position,
                       const Signal& signal) {
    all.push_back({sample(name, seconds, rate_hz, signal), unit, fine, is_position});
  };
  add("hand", "m", 5e-7, true, [&](std::size_t a, double t) { return rounded(hand(a, t), 5e-7); });
  add("contour", "m", 1e-6, true, [&](std::size_t a, double t) { return rounded(contour(a, t), 1e-6); });
  add("force", "N", 9e-3, false, [&](std::size_t a, double t) {
    return (a == 0 ? 5.0 : 0.0) + push[a](t) + chatter[a](t) + 3e-3 * random.normal();
  });
  add("acceleration", "m/s2", 2e-2, false,
      [&](std::size_t a, double t) { return hand.acceleration(a, t) + 0.01 * random.normal(); });
  add("chirp", "m", 1e-6, true, [&](std::size_t a, double t) {
    const double sweep = std::fmod(t, 10.0);
    return 1e-3 * std::sin(2 * pi * (sweep + 199.0 * sweep * sweep / 20.0) + static_cast<double>(a));
  });
  std::array<double, 3> level{};
  add("steps", "m", 1e-6, true, [&](std::size_t a, double) {
    if (random.uniform() < 0.01) level[a] = rounded(5e-3 * random.normal(), 1e-6);
    return level[a];
  });
  add("held", "m", 1e-6, true,
      [&](std::size_t a, double t) { return rounded(hand(a, std::floor(t * 50.0) / 50.0), 1e-6); });
  add("noise", "1", 0.1, false, [&](std::size_t, double) { return random.normal(); });
  return all;
}

}  // namespace telekerf::experiments
