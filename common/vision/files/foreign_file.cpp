// SPDX-License-Identifier: Apache-2.0
#include "common/vision/files/foreign_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

namespace telekerf::vision {
namespace {

using namespace std::string_view_literals;

struct Kind {
  std::string_view magic;
  std::string_view sentence;
};

constexpr std::array kKinds = {
    Kind{"GIF8"sv, "a GIF picture, which is not read; save it as PNG"},
    Kind{"%PDF"sv, "a PDF document, which is not read; export it as SVG, or as PNG"},
    Kind{"%!PS"sv, "a PostScript file (EPS, AI), which is not read; export it as SVG"},
    Kind{"\xC5\xD0\xD3\xC6"sv, "a PostScript file (EPS, AI), which is not read; export it as SVG"},
    Kind{"AC10"sv, "a DWG drawing, which is not read; save it as DXF"},
    Kind{"8BPS"sv, "a Photoshop file, which is not read; save it as PNG"},
    Kind{"gimp xcf"sv, "a GIMP file, which is not read; export it as PNG"},
    Kind{"\xFF\x0A"sv, "a JPEG XL picture, which is not read; save it as JPEG or PNG"},
    Kind{"\0\0\0\x0CJXL "sv, "a JPEG XL picture, which is not read; save it as JPEG or PNG"},
    Kind{"FUJIFILMCCD-RAW"sv, "a camera's raw file, which is not read; develop it to JPEG or PNG"},
    Kind{"IIRO"sv, "a camera's raw file, which is not read; develop it to JPEG or PNG"},
    Kind{"II*\0\x10\0\0\0CR"sv, "a camera's raw file, which is not read; develop it to JPEG or PNG"},
    Kind{"ISO-10303-21"sv, "a solid model (STEP), which is not read; draw its outline as DXF or SVG"},
    Kind{"solid "sv, "a solid model (STL), which is not read; draw its outline as DXF or SVG"},
    Kind{"\xFF\xFE\0\0"sv, "text in UTF-32, which is not read; save it as UTF-8"},
    Kind{"\0\0\xFE\xFF"sv, "text in UTF-32, which is not read; save it as UTF-8"},
    Kind{"PK\x03\x04"sv, "a ZIP archive or a document; take the picture out of it first"},
    Kind{"7z\xBC\xAF\x27\x1C"sv, "an archive; take the picture out of it first"},
    Kind{"Rar!"sv, "an archive; take the picture out of it first"},
};

std::string_view kind_of_container(std::string_view head) {
  if (head.size() < 12) return {};
  if (head.substr(4, 4) == "ftyp") {
    const std::string_view brand = head.substr(8, 4);
    if (brand == "avif" || brand == "avis")
      return "an AVIF picture, which is not read; save it as JPEG or PNG";
    if (brand.starts_with("he") || brand.starts_with("mif1") || brand.starts_with("msf1"))
      return "a HEIC picture, which is not read; save it as JPEG or PNG";
    if (brand.starts_with("crx")) return "a camera's raw file, which is not read; develop it to JPEG or PNG";
    return "a video; give telekerf-vision the video, or save one frame as PNG";
  }
  if (head.starts_with("RIFF")) {
    if (head.substr(8, 3) == "CDR") return "a CorelDRAW drawing, which is not read; export it as SVG";
    if (head.substr(8, 3) == "AVI")
      return "a video; give telekerf-vision the video, or save one frame as PNG";
  }
  return {};
}

}  // namespace

std::string what_a_file_is(std::string_view head) {
  if (head.empty()) return "an empty file";
  for (const Kind& kind : kKinds) {
    if (head.starts_with(kind.magic)) return std::string(kind.sentence);
  }
  if (const std::string_view kind = kind_of_container(head); !kind.empty()) return std::string(kind);
  // Text that is no drawing; a mark of the byte order and blanks may stand before it.
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  while (!head.empty() && std::isspace(static_cast<unsigned char>(head.front()))) head.remove_prefix(1);
  if (head.empty()) return "an empty file";
  std::string word(head.substr(0, 14));
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  if (word == "<!doctype html" || word.starts_with("<html"))
    return "a web page and no picture; save the picture itself";
  if (head.starts_with("IN;") || head.starts_with("\x1B%-12345X"))
    return "a plotter's file (HPGL), which is not read; export it as DXF or SVG";
  return {};
}

bool looks_like_dxf(std::string_view head) {
  std::istringstream lines{std::string(head)};
  std::string code;
  std::string value;
  while (std::getline(lines, code) && std::getline(lines, value)) {
    const auto trim = [](std::string& s) {
      while (!s.empty() && std::isspace(static_cast<unsigned char>(s.back()))) s.pop_back();
      s.erase(0, s.find_first_not_of(" \t"));
    };
    trim(code);
    trim(value);
    if (code != "999") return code == "0" && value == "SECTION";
  }
  return false;
}

}  // namespace telekerf::vision
