// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/plot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <system_error>

#include "common/reporting/picture_file.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

extern char** environ;

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

constexpr const char* kWithAxes = "set tics\nset border\nset grid lc rgb '#e4e4e4' lt 1\n";

void add_picture(std::string& script, const Panel& panel) {
  script += "unset key\nunset grid\nunset logscale\n";
  std::string place;
  if (panel.x_range && panel.y_range) {
    const auto &x = *panel.x_range, &y = *panel.y_range;
    const cv::Size size = cv::imread(panel.picture.string()).size();
    script += "set size noratio\n" + range_of("x", panel.x_range, false, true) +
              range_of("y", panel.y_range, false, true);
    // A pixel stands around its place.
    const double dx = (x[1] - x[0]) / std::max(1, size.width), dy = (y[1] - y[0]) / std::max(1, size.height);
    place =
        fmt::format(" origin=({:.9g},{:.9g}) dx={:.9g} dy={:.9g}", x[0] + 0.5 * dx, y[0] + 0.5 * dy, dx, dy);
  } else {
    script += "unset tics\nunset border\nset size ratio -1\n";
    script += "set xrange [*:*] noextend\nset yrange [*:*] noextend\n";
  }
  script +=
      "plot " + quoted(panel.picture.string()) + " binary filetype=png" + place + " with rgbimage notitle\n";
  script += kWithAxes;
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
    add_picture(script, panel);
    return;
  }
  const auto labels = std::count_if(panel.lines.begin(), panel.lines.end(),
                                    [](const Line& line) { return !line.label.empty(); });
  script += labels > kRowsBelow ? "set key outside right top vertical\n"
                                : "set key below center horizontal height 0.8\n";
  script += panel.equal_axes ? "set size ratio -1\n" : "set size noratio\n";
  script += "unset logscale\n";
  if (panel.log_x) script += "set logscale x\n";
  if (panel.log_y) script += "set logscale y\n";
  const bool shown = shows_something(panel);
  script +=
      range_of("x", panel.x_range, panel.log_x, shown) + range_of("y", panel.y_range, panel.log_y, shown);
  if (!panel.axes) script += "unset tics\nunset border\nunset grid\n";
  script += "plot ";
  for (std::size_t n = 0; n < panel.lines.size(); ++n)
    script += drawing_of(panel.lines[n], index, n) + ", \\\n  ";
  script += "NaN notitle\n";
  if (!panel.axes) script += kWithAxes;
}

using Scratch = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// A file without a name that holds the text, read from its beginning.
Scratch scratch_with(const std::string& text) {
  Scratch file(std::tmpfile(), &std::fclose);
  if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() ||
      std::fflush(file.get()) != 0)
    throw environment_error(
        fmt::format("no file for what gnuplot is told: {}; make room in the folder for temporary files",
                    std::system_category().message(errno)));
  std::rewind(file.get());
  return file;
}

/// What gnuplot complains of, without the command that it repeats and the mark below it.
std::string complaint_in(std::FILE* file) {
  constexpr std::size_t kMost = 300;
  std::rewind(file);
  std::string all, line;
  const auto take = [&] {
    const std::size_t from = line.find_first_not_of(' ');
    if (from != line.npos && line[from] != '^' && !line.starts_with("gnuplot>") && all.size() < kMost)
      all += (all.empty() ? "" : "; ") + line.substr(from, kMost);
    line.clear();
  };
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    if (c == '\n')
      take();
    else if (c != ' ' || !line.ends_with(' '))
      line += static_cast<char>(c);
  }
  take();
  return all;
}

/// As a PNG or an SVG ends that was drawn to its end.
bool is_whole(const std::filesystem::path& file) {
  constexpr std::streamoff kTail = 64;
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return false;
  in.seekg(-std::min<std::streamoff>(kTail, in.tellg()), std::ios::cur);
  const std::string tail{std::istreambuf_iterator<char>(in), {}};
  return tail.find(file.extension() == ".svg" ? "</svg>" : "IEND") != tail.npos;
}

void run_gnuplot(const std::string& script, const std::filesystem::path& file) {
  const Scratch in = scratch_with(script), said = scratch_with("");
  std::error_code was_none;
  std::filesystem::remove(file, was_none);  // what is there afterwards has been drawn now
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, fileno(in.get()), STDIN_FILENO);
  // Where it cannot write the file it draws to its output.
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&files, fileno(said.get()), STDERR_FILENO);
  std::string name = "gnuplot", no_settings_of_the_user = "-d";
  const std::array<char*, 3> words{name.data(), no_settings_of_the_user.data(), nullptr};
  pid_t child = 0;
  const int refused = posix_spawnp(&child, name.c_str(), &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (refused != 0)
    throw environment_error(fmt::format(
        "gnuplot, which draws the figures, does not start: {}; install gnuplot-nox (./telekerf setup does)",
        std::system_category().message(refused)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status == 0 && is_whole(file)) return;
  const std::string words_of_it = complaint_in(said.get());
  throw environment_error(fmt::format(
      "{}: gnuplot {}, and {}; is the folder writable with room in it, and does `gnuplot --version` answer?",
      file.string(),
      status == 0           ? std::string("has not drawn it to its end")
      : WIFSIGNALED(status) ? fmt::format("was ended by signal {}", WTERMSIG(status))
                            : fmt::format("ended with code {}", WEXITSTATUS(status)),
      words_of_it.empty() ? std::string("said nothing") : "said: " + words_of_it));
}

/// gnuplot leaves pixels out where a picture has more of them than its panel: those are made smaller before,
/// by their mean. The files are gone with this.
class SmallPictures {
 public:
  SmallPictures(Figure& figure, const std::filesystem::path& png) {
    constexpr double kShare = 0.75;  // of a panel is not margin
    for (Panel& panel : figure.panels) {
      if (panel.picture.empty()) continue;
      const cv::Mat picture = cv::imread(panel.picture.string());
      const double times = std::max(picture.cols / (kShare * figure.panel_width_px),
                                    picture.rows / (kShare * figure.panel_height_px));
      if (times <= 1.0) continue;  // as a picture that is not there: gnuplot says so
      cv::Mat small;
      cv::resize(picture, small, {}, 1.0 / times, 1.0 / times, cv::INTER_AREA);
      files_.push_back(
          std::filesystem::path(png).replace_extension(fmt::format("panel-{}.png", files_.size())));
      write_picture(files_.back(), small);
      panel.picture = files_.back();
    }
  }
  ~SmallPictures() {
    std::error_code was_none;
    for (const auto& file : files_) std::filesystem::remove(file, was_none);
  }
  SmallPictures(const SmallPictures&) = delete;
  SmallPictures& operator=(const SmallPictures&) = delete;

 private:
  std::vector<std::filesystem::path> files_;
};

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
      const std::string name = !line.label.empty()       ? line.label
                               : panel.lines.size() == 1 ? panel.y_label
                                                         : fmt::format("{}, {}", panel.y_label, n + 1);
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
  const SmallPictures small(drawn, png);
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
