// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/report_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <sstream>

#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"
#include "experiments/report/page_figures.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;

constexpr int kPictureWidth_px = 1000;

std::string text_of(const fs::path& file, const std::string& remedy) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw environment_error(file.string() + ": cannot be read" + remedy);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A part of Dygraphs as Debian installs it.
std::string dygraphs(const char* file) {
  return text_of(fs::path("/usr/share/javascript/dygraphs") / file,
                 ": install libjs-dygraphs (./telekerf setup does)");
}

void put(std::string& page, const std::string& place, const std::string& text) {
  const std::string mark = "{{" + place + "}}";
  const std::size_t at = page.find(mark);
  if (at == page.npos) throw environment_error("report page: its template has no " + mark);
  page.replace(at, mark.size(), text);
}

std::string class_of(Verdict verdict) {
  std::string word = verdict_text(verdict);
  std::replace(word.begin(), word.end(), ' ', '-');
  return word;
}

std::string cell(const char* label, const std::string& html, const std::string& kind = "") {
  return fmt::format("<td data-label=\"{}\"{}>{}</td>", label, kind.empty() ? "" : " class=\"" + kind + "\"",
                     html);
}

std::string claim_row(const Judged& row, const ReportPage& page) {
  const Claim& claim = row.claim;
  const std::string unit = claim.unit.empty() || !row.value ? "" : " " + claim.unit;
  std::string verdict = verdict_text(row.verdict);
  if (const std::string remark = remark_of(row); !remark.empty()) verdict += " (" + remark + ")";
  if (!row.why.empty()) verdict += ": " + row.why;
  return fmt::format(
      "<tr id=\"{}\">{}{}{}{}{}{}{}</tr>\n", html_text(claim.id), cell("thesis", html_text(claim.reference)),
      cell("statement", html_text(claim.statement)), cell("printed", html_text(printed_text(claim))),
      cell("ours",
           fmt::format("{}: <b>{}{}</b>", html_text(claim.quantity), value_text(row), html_text(unit)),
           "figure"),
      cell(
          "may be",
          html_text(bound_text(claim)) +
              (claim.reason.empty() ? "" : "<br><span class=\"soft\">" + html_text(claim.reason) + "</span>"),
          "figure"),
      cell("verdict", html_text(verdict), "verdict " + class_of(row.verdict)),
      cell("command",
           fmt::format(
               "<a href=\"#x-{}\">{}</a>: <code>{}</code>", claim.experiment, claim.experiment,
               html_text(command_line(page.manifest.experiment(claim.experiment), page.seed, page.quick))),
           "command"));
}

std::string claim_table(ClaimSection section, const ReportPage& page) {
  std::string rows;
  for (const Judged& row : page.judged)
    if (row.claim.section == section) rows += claim_row(row, page);
  return "<table><thead><tr><th>thesis</th><th>statement</th><th>printed there</th><th>our "
         "figure</th><th>may be</th>"
         "<th>verdict</th><th>command</th></tr></thead><tbody>\n" +
         rows + "</tbody></table>\n";
}

std::string summary(const ReportPage& page) {
  std::string out = "<ul class=\"counts\">";
  for (const Verdict verdict : {Verdict::kHeld, Verdict::kNotHeld, Verdict::kNotAssessed}) {
    const auto count = std::count_if(page.judged.begin(), page.judged.end(),
                                     [&](const Judged& row) { return row.verdict == verdict; });
    out += fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", class_of(verdict), count, verdict_text(verdict));
  }
  return out + "</ul>" +
         fmt::format(
             "<p class=\"soft\">Telekerf {}, commit {}, {} run, seed {}; compiled by GCC {}, OpenCV {}.</p>",
             kVersion, html_text(page.commit), page.quick ? "quick" : "full", page.seed, __VERSION__,
             CV_VERSION);
}

std::string difference_list(const ReportPage& page) {
  if (page.against.empty()) return "";
  std::string out = "<h3>Against " + html_text(page.against) + "</h3>";
  if (!page.other_conditions.empty())
    out += "<p><b>Made otherwise</b> (" + html_text(page.other_conditions) +
           "): what differs need not be the code's doing.</p>";
  if (page.differences.empty()) return out + "<p>No claim has another figure or verdict.</p>";
  out += "<ul>";
  for (const std::string& line : page.differences) out += "<li>" + html_text(line) + "</li>";
  return out + "</ul>";
}

std::string experiment_part(const ManifestExperiment& experiment, const ReportPage& page) {
  const std::string chapter = experiment.reference == "-" ? "" : experiment.reference + ": ";
  std::string out =
      fmt::format("<h2 id=\"x-{}\">{}{}</h2>\n<p><code>{}</code></p>\n", experiment.name, html_text(chapter),
                  html_text(experiment.title), html_text(command_line(experiment, page.seed, page.quick)));
  const auto one = std::find_if(page.finished.begin(), page.finished.end(),
                                [&](const Finished& f) { return f.name == experiment.name; });
  if (one == page.finished.end()) return out + "<p>It was not run.</p>\n";
  if (one->code > 1) return out + "<p>It could not be run: " + html_text(one->complaint) + "</p>\n";
  if (one->code == 1) out += "<p>It says itself that a bar was missed (exit code 1).</p>\n";
  for (const ManifestFigure& figure : page.manifest.figures) {
    if (figure.experiment != experiment.name) continue;
    if (page.quick && !figure.quick) continue;
    const fs::path png = one->folder / figure.file;
    out += fmt::format(
        "<figure><div class=\"pan\" tabindex=\"0\"><img loading=\"lazy\" alt=\"{0}\" "
        "src=\"{1}\"></div><figcaption>{0}</figcaption>\n{2}</figure>\n",
        html_text(figure.caption), picture_address(png, kPictureWidth_px), zoomable_panels(png));
  }
  return out;
}

}  // namespace

std::string report_page(const ReportPage& page) {
  std::string text = text_of(find_resource("report", "page", ".html"), "");
  std::string contents, experiments;
  for (const ManifestExperiment& experiment : page.manifest.experiments) {
    contents +=
        fmt::format("<li><a href=\"#x-{}\">{}</a>{}</li>", experiment.name, html_text(experiment.title),
                    experiment.reference == "-" ? "" : " (" + html_text(experiment.reference) + ")");
    experiments += experiment_part(experiment, page);
  }
  const std::string quick = page.quick ? " --quick" : "";
  const std::string again = fmt::format(
      "<p>All of it: <code>./telekerf experiment all{0} --seed {1} --out out/all</code>. Beside this page it "
      "leaves "
      "<code>claims.json</code> and everything that the experiments left, as JSON, CSV, SVG and PNG. What "
      "changed since another "
      "run: <code>--against DIR</code>. One experiment alone: the command above its figures.</p>",
      quick, page.seed);
  for (const auto& [place, html] : std::initializer_list<std::pair<const char*, std::string>>{
           {"dygraph_css", dygraphs("dygraph.min.css")},
           {"made", page.made.empty() ? "" : "<p class=\"made\">" + html_text(page.made) + "</p>"},
           {"summary", summary(page)},
           {"differences", difference_list(page)},
           {"contents", contents},
           {"thesis", claim_table(ClaimSection::kThesis, page)},
           {"rivals", claim_table(ClaimSection::kRivals, page)},
           {"beyond", claim_table(ClaimSection::kBeyond, page)},
           {"experiments", experiments},
           {"again", again},
           {"dygraph_js", dygraphs("dygraph.min.js")}})
    put(text, place, html);
  return text;
}

std::string made_line(const std::vector<Finished>& finished) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  std::ifstream info("/proc/cpuinfo");
  std::string processor = "unknown processor";
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) {
      processor = line.substr(line.find(':') + 2);
      break;
    }
  std::string took;
  for (const Finished& one : finished) {
    if (!one.resumed)
      took += fmt::format("{}{} {:.1f} s", took.empty() ? " By the clock: " : ", ", one.name, one.seconds);
  }
  return fmt::format("Made {:%Y-%m-%d %H:%M} UTC on {} ({}, {} processors).{}{}",
                     fmt::gmtime(std::time(nullptr)), host.data(), processor, sysconf(_SC_NPROCESSORS_ONLN),
                     took, took.empty() ? "" : ".");
}

}  // namespace telekerf::experiments
