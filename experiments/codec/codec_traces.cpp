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

/// A joint that goes from place to place with least jerk, 1 s each, and rests in between.
struct Joint {
  explicit Joint(Random& random) {
    for (auto& place : places) place = 0.8 * (2.0 * random.uniform() - 1.0);
  }
  double operator()(double t) const {
    const double phase = t / 1.6;
    const auto n = static_cast<std::size_t>(phase) % (places.size() - 1);
    const double s = std::min((phase - std::floor(phase)) * 1.6, 1.0);
    return places[n] + (places[n + 1] - places[n]) * s * s * s * (10.0 + s * (6.0 * s - 15.0));
  }
  std::array<double, 64> places{};
};

/// Heart beats as sums of bells (P, Q, R, S, T; after McSharry et al., 2003) over a wandering base line, mV.
struct Heart {
  explicit Heart(Random& random) : rate(random, 0.05, 0.3, 0.06, 0), base(random, 0.05, 0.4, 0.05, 1) {}
  double operator()(std::size_t lead, double t) const {
    constexpr std::array<std::array<double, 3>, 5> kBells{{{-0.20, 0.12, 0.025},
                                                           {-0.035, -0.10, 0.010},
                                                           {0.0, 1.10, 0.011},
                                                           {0.035, -0.22, 0.012},
                                                           {0.28, 0.30, 0.045}}};
    const double phase = (t + rate(t)) / 0.85;
    const double since_s = (phase - std::floor(phase) - 0.4) * 0.85;
    double sum = base(t);
    for (const auto& [at, height, width] : kBells)
      sum += height * std::exp(-0.5 * std::pow((since_s - at) / width, 2));
    return sum * (lead == 0 ? 1.0 : lead == 1 ? 0.6 : -0.4);
  }
  Band rate, base;
};

/// A push that begins and ends hard, and rings, N.
double contact(double t) {
  const double since = std::fmod(t, 2.5);
  if (since > 1.3) return 0.0;
  return 4.0 * (1.0 - std::exp(-since / 0.01)) +
         2.5 * std::exp(-since / 0.04) * std::sin(2 * pi * 70.0 * since);
}

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
  const auto add_at = [&](const char* name, double rate, const char* unit, double fine,
                          const Signal& signal) {
    all.push_back({sample(name, 3.0 * seconds, rate, signal), unit, fine, false});
  };
  const std::array<Joint, 3> joints{Joint(random), Joint(random), Joint(random)};
  add_at("joints", 100.0, "rad", 1e-4, [&](std::size_t a, double t) { return rounded(joints[a](t), 1e-4); });
  const std::array<Band, 3> strokes{Band(random, 0.5, 6, 3e-3, 1), Band(random, 0.5, 6, 3e-3, 1),
                                    Band(random, 0.1, 1, 1e-3, 1)};
  add_at("pen", 125.0, "m", 5e-6, [&](std::size_t a, double t) {
    const double along = a == 0 ? 0.02 * std::fmod(t, 8.0) : 0.0;  // line after line
    return rounded(along + strokes[a](t), 5e-6);
  });
  const Heart heart(random);
  add_at("ecg", 360.0, "mV", 0.005,
         [&](std::size_t a, double t) { return rounded(heart(a, t) + 4e-3 * random.normal(), 0.005); });
  const std::array<Band, 3> load{Band(random, 0.2, 8, 0.8, 1), Band(random, 0.2, 8, 0.8, 1),
                                 Band(random, 0.2, 8, 0.5, 1)};
  add_at("current", 1000.0, "A", 0.02, [&](std::size_t a, double t) {
    const double friction = load[a](t + 0.1) > 0.0 ? 0.3 : -0.3;  // turns round at once
    return load[a](t) + friction + 0.02 * std::sin(2 * pi * 300.0 * t) + 0.01 * random.normal();
  });
  add_at("contact", 1000.0, "N", 0.02, [&](std::size_t a, double t) {
    return contact(t + 0.3 * static_cast<double>(a)) + 0.01 * random.normal();
  });
  return all;
}

}  // namespace telekerf::experiments
