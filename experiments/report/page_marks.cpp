// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/page_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>

#include "common/reporting/page_tables.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;

/// As the tables have it, so that a page does not know more digits than they do. With commas between
/// thousands if the old one may have had them.
std::string figure_like(const std::string& old, const Judged& judged) {
  const double value = std::stod(value_text(judged));
  const std::size_t point = old.find('.');
  const std::string text = fmt::format("{:.{}f}", value, point == old.npos ? 0 : old.size() - point - 1);
  if (std::abs(value) < 1000.0 || old.find(',') == old.npos) return text;
  const std::size_t whole = std::min(text.find('.'), text.size());
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i > 0 && i < whole && (whole - i) % 3 == 0) out += ',';
    out += text[i];
  }
  return out;
}

}  // namespace

std::string with_figures(const std::string& page, const std::vector<Judged>& judged) {
  static const std::regex kMark(R"((\d[\d,]*(?:\.\d+)?)(<!-- claim ([^ >]+) -->))");
  std::string out;
  auto from = page.begin();
  for (std::sregex_iterator at(page.begin(), page.end(), kMark), end; at != end; ++at) {
    const auto row = std::find_if(judged.begin(), judged.end(),
                                  [&](const Judged& one) { return one.claim.id == (*at)[3].str(); });
    out.append(from, (*at)[1].first);
    const bool known = row != judged.end() && row->value;
    out += known ? figure_like((*at)[1], *row) : (*at)[1].str();
    out += (*at)[2];
    from = (*at)[0].second;
  }
  return out.append(from, page.end());
}

void require_pages(const fs::path& source) {
  if (!fs::exists(source / "README.md") || !fs::exists(source / "docs/results/claims.md"))
    throw input_error("--source " + source.string() +
                      ": has no README.md and docs/results/claims.md; name the top folder of the source");
}

void write_pages(const fs::path& source, const std::vector<Judged>& judged) {
  const fs::path readme = source / "README.md", results = source / "docs/results";
  reporting::write_tables(readme, {headline_table(judged)});
  reporting::write_tables(results / "claims.md", {claims_table(judged)});
  std::vector<fs::path> pages{readme};
  for (const auto& entry : fs::directory_iterator(results))
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  for (const fs::path& page : pages) {
    std::ifstream in(page, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string fresh = with_figures(text, judged);
    if (fresh != text) write_atomically(page, fresh);
  }
}

}  // namespace telekerf::experiments
