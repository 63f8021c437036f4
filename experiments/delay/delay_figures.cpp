// SPDX-License-Identifier: Apache-2.0
#include "experiments/delay/delay_figures.h"

#include <algorithm>
#include <cmath>

#include "common/reporting/plot.h"
#include "experiments/delay/delay_ideal.h"

namespace telekerf::experiments {
namespace {

using reporting::Figure;
using reporting::Line;
using reporting::Panel;

/// Of the figure's axis.
constexpr double kLeast_um = 0.1;
constexpr double kMost_um = 1e5;

}  // namespace

void draw_rtt(const std::vector<Run>& runs, const std::filesystem::path& png) {
  Figure figure;
  figure.title =
      "SDCT, jitter 10 % of the round trip, loss 0.01, each rival at its best tuning; a line ends where it "
      "is "
      "unstable";
  for (const auto& [title, what] :
       {std::pair{"slave to master (um rms)", &DelayResult::tracking_rmse_um},
        std::pair{"slave to its prediction (um rms)", &DelayResult::prediction_rmse_um}}) {
    Panel panel{.title = title, .x_label = "round trip (ms)", .y_label = "um", .log_y = true};
    panel.y_range = {{kLeast_um, kMost_um}};
    int colour = 0;
    for (const Rival& rival : rivals()) {
      Line line{.label = law_of(rival) + " + " + word_of(rival.estimator), .colour = colour++ % 8};
      if (colour > 8) line.style = Line::Style::kDashed;
      for (const double rtt_ms : kRttMs) {
        const Run* run = find_run(runs, rival, rtt_ms, rtt_ms > 0.0 ? 0.1 : 0.0, 0.01);
        if (run == nullptr) continue;
        line.x.push_back(rtt_ms);
        line.y.push_back(run->result.stable ? run->result.*what : NAN);
      }
      panel.lines.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  figure.panel_width_px = 960;
  figure.panel_height_px = 420;
  draw_figure(figure, png);
}

/// How far the largest stable w D is from theory, measured on a grid of 4 % steps.
void draw_stability(const std::filesystem::path& png) {
  Figure figure;
  figure.title = "u = -2 w v - w^2 x on a double integrator behind a delay D";
  figure.columns = 2;
  for (const char* word : {"none", "predictor"}) {
    const master::MakeEstimator estimator = master::estimator_named(word);
    Panel panel{.title = "estimator " + word_of(estimator),
                .x_label = "D (ms)",
                .y_label = "w (rad/s)",
                .log_x = true,
                .log_y = true};
    Line stable{.label = "stable", .style = Line::Style::kPoints, .colour = 2};
    Line unstable{.label = "unstable", .style = Line::Style::kPoints, .colour = 3};
    Line theory{.label = "w D = 0.6475", .colour = 0};
    for (double delay_s = 0.01; delay_s < 1.05; delay_s *= 1.35) {
      for (double w = 0.4; w < 110.0; w *= 1.35) {
        Line& line = law_is_stable(estimator, w, delay_s) ? stable : unstable;
        line.x.push_back(delay_s * 1e3);
        line.y.push_back(w);
      }
      theory.x.push_back(delay_s * 1e3);
      theory.y.push_back(0.6475 / delay_s);
    }
    panel.lines = {stable, unstable, theory};
    figure.panels.push_back(panel);
  }
  draw_figure(figure, png);
}

void draw_start(const std::filesystem::path& png) {
  Figure figure;
  figure.title = "Prediction error on an exact double integrator, round trip 100 ms";
  figure.columns = 2;
  for (const auto& [title, start] : {std::pair{"exact start, nothing disturbs", IdealStart{}},
                                     std::pair{"10 mm and 50 mm/s wrong at the start",
                                               IdealStart{.position_m = 0.01, .velocity_m_per_s = 0.05}}}) {
    Panel panel{.title = title, .x_label = "t (s)", .y_label = "um", .log_y = true};
    panel.y_range = {{1e-3, 2e6}};
    int colour = 0;
    for (const auto& row : master::kEstimators) {
      Line line{.label = std::string(row.word), .colour = colour++};
      const auto errors = prediction_error(row.value, 0.1, 10.0, start);
      for (std::size_t i = 0; i < errors.size(); i += 10) {
        line.x.push_back(static_cast<double>(i) * 1e-3);
        line.y.push_back(std::max(errors[i] * 1e6, 1e-3));
      }
      panel.lines.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  draw_figure(figure, png);
}

}  // namespace telekerf::experiments
