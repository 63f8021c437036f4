// SPDX-License-Identifier: Apache-2.0
// Files that are brought and cannot be read are named for what they are, whatever their names say, with what
// to do.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/vision/files/foreign_file.h"
#include "common/vision/load.h"

namespace telekerf::vision {
namespace {

using namespace std::string_literals;

/// What is said of a file with these bytes.
std::string complaint(const std::string& bytes, const std::string& extension) {
  const auto file = std::filesystem::temp_directory_path() / ("telekerf-foreign" + extension);
  std::ofstream(file, std::ios::binary) << bytes;
  const auto found = load_contours(file.string(), {});
  std::filesystem::remove(file);
  return found ? "read" : found.error();
}

const std::vector<std::pair<std::string, std::string>> kForeign = {
    {"GIF89a......", "GIF picture"},
    {"%PDF-1.7 ...", "PDF document"},
    {"%!PS-Adobe-3.0", "PostScript"},
    {"\xC5\xD0\xD3\xC6....", "PostScript"},
    {"\0\0\0\x18"
     "ftypheic...."s,
     "HEIC picture"},
    {"\0\0\0\x18"
     "ftypavif...."s,
     "AVIF picture"},
    {"\0\0\0\x18"
     "ftypcrx ...."s,
     "raw file"},
    {"\0\0\0\x18"
     "ftypisom...."s,
     "video"},
    {"AC1027......", "DWG drawing"},
    {"8BPS\0\1"s, "Photoshop"},
    {"gimp xcf file", "GIMP"},
    {"\xFF\x0A....", "JPEG XL"},
    {"RIFF....CDR9vrsn", "CorelDRAW"},
    {"RIFF....AVI LIST", "video"},
    {"II*\0\x10\0\0\0CR\2\0......"s, "raw file"},
    {"PK\x03\x04.......", "ZIP archive"},
    {"ISO-10303-21;\n", "STEP"},
    {"solid part\n facet normal", "STL"},
    {"IN;SP1;PU0,0;PD10,10;", "HPGL"},
    {"\xEF\xBB\xBF\n<!DOCTYPE html>\n<html>", "web page"},
    {"<HTML><body>", "web page"},
    {"\xFF\xFE\0\0<\0\0\0s\0\0\0"s, "UTF-32"},
    {"", "empty file"},
    {" \n\n", "empty file"},
};

TEST(ForeignFiles, AreNamedUnderAnyName) {
  for (const auto& [bytes, word] : kForeign) {
    EXPECT_NE(what_a_file_is(bytes).find(word), std::string::npos) << word;
    for (const char* extension : {".png", ".jpg", ".svg", ".dxf"}) {
      const std::string said = complaint(bytes, extension);
      EXPECT_NE(said.find(word), std::string::npos) << extension << ": " << said;
      for (const char c : said) EXPECT_TRUE(c >= ' ' && c <= '~') << said;
    }
  }
}

TEST(ForeignFiles, ADrawingOrPictureWithAnothersNameIsToldItsOwn) {
  const std::string svg = "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0h9v9z'/></svg>";
  const std::string dxf =
      "999\r\nby hand\r\n  0\r\nSECTION\r\n  2\r\nENTITIES\r\n  0\r\nENDSEC\r\n  0\r\nEOF\r\n";
  EXPECT_NE(complaint(svg, ".png").find("name it .svg"), std::string::npos) << complaint(svg, ".png");
  EXPECT_NE(complaint(svg, ".dxf").find("name it .svg"), std::string::npos) << complaint(svg, ".dxf");
  EXPECT_NE(complaint(dxf, ".png").find("name it .dxf"), std::string::npos) << complaint(dxf, ".png");
  EXPECT_NE(complaint(dxf, ".svg").find("name it .dxf"), std::string::npos) << complaint(dxf, ".svg");
  EXPECT_NE(complaint("\x89PNG\r\n\x1A\n", ".svg").find("name it .png"), std::string::npos);
  EXPECT_NE(complaint("\xFF\xD8\xFF\xE0", ".dxf").find("name it .jpg"), std::string::npos);
}

TEST(ForeignFiles, WhatIsNotKnownIsNotGuessed) {
  for (const std::string& bytes :
       {"hello, world"s, "<svg/>"s, "0\nSECTION\n"s, "\x89PNG\r\n\x1A\n"s, "RIFF"s, "ftyp"s})
    EXPECT_EQ(what_a_file_is(bytes), "") << bytes;
  EXPECT_FALSE(looks_like_dxf("0\nEOF\n"));
  EXPECT_FALSE(looks_like_dxf("0"));
  EXPECT_NE(complaint("hello, world", ".png").find("not a picture that can be read"), std::string::npos);
}

}  // namespace
}  // namespace telekerf::vision
