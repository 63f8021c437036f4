// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

namespace telekerf::reporting {
namespace {

// Distinct to colour-blind readers as well (Okabe and Ito).
constexpr std::array<const char*, 8> kPalette{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#f0e442", "#3c3c3c"};
constexpr int kTitle_px = 34;
/// A legend of more rows stands beside the panel, a smaller one below it: neither hides a line.
constexpr int kRowsBelow = 6;

/// A string of gnuplot's language.
std::string quoted(const std::string& words) {
  std::string out = "'";
  for (const char c : words) {
    if (c == '\'') out += '\'';
    out += c == '\n' ? ' ' : c;
  }
  return out + "'";
}

int rows_of(const Figure& figure) {
  return std::max(1, (static_cast<int>(figure.panels.size()) + figure.columns - 1) / figure.columns);
}
int head_px(const Figure& figure) { return figure.title.empty() ? 0 : kTitle_px; }
int width_px(const Figure& figure) { return figure.columns * figure.panel_width_px; }
int height_px(const Figure& figure) { return head_px(figure) + rows_of(figure) * figure.panel_height_px; }

void add_data(std::string& script, const Figure& figure) {
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const Panel& panel = figure.panels[p];
    for (std::size_t n = 0; n < panel.lines.size(); ++n) {
      const Line& line = panel.lines[n];
      script += fmt::format("$p{}l{} << END\n", p, n);
      for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        const bool there = std::isfinite(line.x[i]) && std::isfinite(line.y[i]);
        script += there ? fmt::format("{:.7g} {:.7g}\n", line.x[i], line.y[i]) : std::string("NaN NaN\n");
      }
      script += "END\n";
    }
  }
}

/// gnuplot draws no panel whose lines show no point: a line beyond the axes stands in for them.
bool shows_something(const Panel& panel) {
  return std::any_of(panel.lines.begin(), panel.lines.end(), [&](const Line& line) {
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
      const double x = line.x[i], y = line.y[i];
      const bool drawn =
          std::isfinite(x) && std::isfinite(y) && (!panel.log_x || x > 0) && (!panel.log_y || y > 0);
      if (drawn && (!panel.x_range || (x >= (*panel.x_range)[0] && x <= (*panel.x_range)[1])) &&
          (!panel.y_range || (y >= (*panel.y_range)[0] && y <= (*panel.y_range)[1])))
        return true;
    }
    return false;
  });
}

std::string range_of(const char* axis, const std::optional<std::array<double, 2>>& asked, bool logarithmic,
                     bool shown) {
  if (asked) return fmt::format("set {}range [{:.9g}:{:.9g}]\n", axis, (*asked)[0], (*asked)[1]);
  if (!shown) return fmt::format("set {}range [{}:1]\n", axis, logarithmic ? "0.1" : "0");
  return fmt::format("set {}range [*:*] {}\n", axis, *axis == 'x' ? "noextend" : "extend");
}

std::string drawing_of(const Line& line, std::size_t panel, std::size_t place) {
  const char* colour =
      kPalette[(line.colour >= 0 ? static_cast<std::size_t>(line.colour) : place) % kPalette.size()];
  const std::string style =
      line.style == Line::Style::kPoints || line.x.size() < 2  // a single place is no line
          ? std::string("points pt 7 ps 0.6")
          : fmt::format("lines lw 1.5 dt {}", line.style == Line::Style::kDashed ? 2 : 1);
  return fmt::format("$p{}l{} using 1:2 with {} lc rgb '{}' {}", panel, place, style, colour,
                     line.label.empty() ? std::string("notitle") : "title " + quoted(line.label));
}

void add_panel(std::string& script, const Figure& figure, std::size_t index) {
  const Panel& panel = figure.panels[index];
  const double height = height_px(figure);
  const int row = static_cast<int>(index) / figure.columns, column = static_cast<int>(index) % figure.columns;
  script += fmt::format("set size {:.6f},{:.6f}\nset origin {:.6f},{:.6f}\n", 1.0 / figure.columns,
                        figure.panel_height_px / height, static_cast<double>(column) / figure.columns,
                        1.0 - (head_px(figure) + (row + 1) * figure.panel_height_px) / height);
  script += "set title " + quoted(panel.title) + "\n";
  script +=
      "set xlabel " + quoted(panel.x_label) + " offset 0,0.7\nset ylabel " + quoted(panel.y_label) + "\n";
  if (!panel.picture.empty()) {
    script += "unset key\nunset tics\nunset border\nunset grid\nunset logscale\nset size ratio -1\n";
    script += "set xrange [*:*] noextend\nset yrange [*:*] noextend\n";
    script += "plot " + quoted(panel.picture.string()) + " binary filetype=png with rgbimage notitle\n";
    script += "set tics\nset border\nset grid lc rgb '#e4e4e4' lt 1\n";
    return;
  }
  const auto labels = std::count_if(panel.lines.begin(), panel.lines.end(),
                                    [](const Line& line) { return !line.label.empty(); });
  script +=
      labels > kRowsBelow ? "set key outside right top vertical\n" : "set key below center horizontal\n";
  script += panel.equal_axes ? "set size ratio -1\n" : "set size noratio\n";
  script += "unset logscale\n";
  if (panel.log_x) script += "set logscale x\n";
  if (panel.log_y) script += "set logscale y\n";
  const bool shown = shows_something(panel);
  script +=
      range_of("x", panel.x_range, panel.log_x, shown) + range_of("y", panel.y_range, panel.log_y, shown);
  script += "plot ";
  for (std::size_t n = 0; n < panel.lines.size(); ++n)
    script += drawing_of(panel.lines[n], index, n) + ", \\\n  ";
  script += "NaN notitle\n";
}

/// While it is there, what this thread writes to a program that has ended is lost without ending this one.
class BrokenPipeIgnored {
 public:
  BrokenPipeIgnored() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~BrokenPipeIgnored() {
    const timespec at_once{};
    while (sigtimedwait(&pipe_, nullptr, &at_once) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  BrokenPipeIgnored(const BrokenPipeIgnored&) = delete;
  BrokenPipeIgnored& operator=(const BrokenPipeIgnored&) = delete;

 private:
  sigset_t pipe_, before_;
};

void run_gnuplot(const std::string& script, const std::filesystem::path& file) {
  const auto close = [](std::FILE* pipe) { return pclose(pipe); };
  std::unique_ptr<std::FILE, decltype(close)> pipe(popen("gnuplot -d 2>/dev/null", "w"), close);
  const BrokenPipeIgnored ignored;  // where there is no gnuplot the shell may be gone before it has read all
  if (pipe) std::fwrite(script.data(), 1, script.size(), pipe.get());
  const int status = pipe ? pclose(pipe.release()) : -1;
  constexpr int kNotFound = 127;
  if (WEXITSTATUS(status) == kNotFound)
    throw environment_error(
        "gnuplot is missing, which draws the figures: install gnuplot-nox (./telekerf setup does)");
  if (status != 0) throw environment_error(file.string() + ": cannot be written");
}

/// A field of CSV.
std::string field(const std::string& words) {
  std::string out = "\"";
  for (const char c : words) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string gnuplot_script(const Figure& figure) {
  std::string script = "set encoding utf8\nset grid lc rgb '#e4e4e4' lt 1\n";
  add_data(script, figure);
  script += "set multiplot\n";
  if (!figure.title.empty())
    script += fmt::format("set label 1 {} at screen 0.5,{:.6f} center font ',12'\n", quoted(figure.title),
                          1.0 - 0.5 * kTitle_px / height_px(figure));
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    add_panel(script, figure, i);
    if (i == 0) script += "unset label 1\n";
  }
  return script + "unset multiplot\n";
}

std::string figure_csv(const Figure& figure) {
  std::string text = "panel,x_axis,y_axis,line,x,y\n";
  for (const Panel& panel : figure.panels) {
    for (std::size_t n = 0; n < panel.lines.size(); ++n) {
      const Line& line = panel.lines[n];
      const std::string name = line.label.empty() ? fmt::format("line {}", n + 1) : line.label;
      const std::string head =
          field(panel.title) + "," + field(panel.x_label) + "," + field(panel.y_label) + "," + field(name);
      for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i)
        text += fmt::format("{},{:.7g},{:.7g}\n", head, line.x[i], line.y[i]);
    }
  }
  return text;
}

void draw_figure(const Figure& figure, const std::filesystem::path& png) {
  Figure drawn = figure;
  drawn.columns = std::max(1, figure.columns);
  const auto beside = [&](const char* extension) {
    return std::filesystem::path(png).replace_extension(extension);
  };
  const std::string script = gnuplot_script(drawn);
  for (const auto& [terminal, file] :
       {std::pair{"pngcairo font 'sans,9'", png}, std::pair{"svg dynamic font 'sans,12'", beside(".svg")}}) {
    run_gnuplot(
        fmt::format(
            "set terminal {} noenhanced size {},{} background rgb 'white'\nset output {}\n{}unset output\n",
            terminal, width_px(drawn), height_px(drawn), quoted(file.string()), script),
        file);
  }
  write_atomically(beside(".csv"), figure_csv(drawn));
}

}  // namespace telekerf::reporting
