// SPDX-License-Identifier: Apache-2.0
// What an SVG file shows is cut, and what it does not show is named.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "common/vision/vector/colour_names.h"
#include "common/vision/vector/svg/document.h"

namespace telekerf::vision {
namespace {

using geometry::length_m;

/// On a page of 100 x 80 mm, a unit a millimetre.
tl::expected<VectorDrawing, std::string> read(const std::string& body, const VectorRequest& request = {}) {
  return read_svg(
      "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='80mm' viewBox='0 0 100 80'>" + body +
          "</svg>",
      {}, request);
}

double length_mm(const VectorDrawing& d) {
  double sum = 0.0;
  for (const auto& line : d.contours) sum += 1e3 * length_m(line);
  return sum;
}

const std::string kSeen = "<rect x='1' y='1' width='10' height='5' stroke='red' fill='none'/>";  // 30 mm

TEST(Shown, WhatAStyleSheetHidesIsLeftOutWithItsReason) {
  for (const auto& [sheet, body] : {
           std::pair(".a{display:none}", "<g class='a'><circle r='9'/></g>"),
           {".b{} .x .a{display:none}", "<g class='x'><g><circle class='a' r='9'/></g></g>"},
           {"g > circle{visibility:hidden}", "<g><circle r='9'/></g>"},
           {"#i, #k{opacity:0}", "<circle id='k' r='9'/>"},
           {"circle[r='9']{fill:none}", "<circle r='9'/>"},
           {"circle:not(.b){fill:transparent}", "<circle r='9'/>"},
           {"@media screen{circle{display:none}}", "<circle r='9'/>"},
           {"/* .a{} */circle{display:none!important}", "<circle style='display:inline' r='9'/>"},
           {"circle.a{display:none} .a{display:inline}", "<circle class='a' r='9'/>"},
           {"line{stroke:none}", "<line x2='9' stroke='red'/>"},
       }) {
    for (const bool last : {false, true}) {
      const std::string style = fmt::format("<defs><style><![CDATA[{}]]></style></defs>", sheet);
      const auto d = read(last ? body + kSeen + style : style + body + kSeen);
      ASSERT_TRUE(d) << sheet << ": " << d.error();
      EXPECT_EQ(d->contours.size(), 1u) << sheet;
      ASSERT_EQ(d->left_out.size(), 1u) << sheet;
      EXPECT_FALSE(d->left_out[0].why.empty());
    }
  }
}

TEST(Shown, ABranchOfASwitchThatIsNotChosenIsNamed) {
  const std::string other = "<g><circle r='9'/><g><line x2='9' stroke='red'/></g></g>";
  const std::string text = "<text y='9'>not chosen either</text>";
  for (const std::string& body : {
           "<switch>" + kSeen + other + text + "</switch>",
           "<switch><g systemLanguage='de, fr-CA'>" + other + "</g>" + kSeen + text + "</switch>",
           "<switch><g requiredExtensions='urn:x'>" + other + "</g><g systemLanguage='fr,EN-gb'>" + kSeen +
               "</g></switch>",
           "<switch><title>one of two</title>" + kSeen + other + "</switch>",
           "<g systemLanguage='kitchen'>" + other + "</g>" + kSeen,
           "<g requiredExtensions='urn:x'>" + other + text + "</g>" + kSeen,
           "<switch><foreignObject requiredExtensions='urn:x'/>" + kSeen + other + "</switch>",
       }) {
    const auto d = read(body);
    ASSERT_TRUE(d) << body << ": " << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-6) << body;
    ASSERT_EQ(d->left_out.size(), 2u) << body;
    EXPECT_TRUE(d->unsupported.empty()) << body << d->unsupported.sentence();
    for (const LeftOut& line : d->left_out)
      EXPECT_NE(line.why.find("another language or program"), std::string::npos) << line.why;
  }
}

TEST(Shown, DamageInABranchThatIsNotChosenIsCountedAndDoesNoHarm) {
  for (const char* damaged : {"<g transform='oops'><circle r='9'/></g>", "<use href='other.svg#a'/>",
                              "<g><line x2='9' stroke='red' transform='rotate()'/></g>"}) {
    const auto d = read("<switch>" + kSeen + damaged + "</switch>");
    ASSERT_TRUE(d) << damaged << ": " << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-6) << damaged;
    EXPECT_EQ(d->unsupported.sentence(), "1 damaged and not shown") << damaged;
    EXPECT_FALSE(read("<switch>" + std::string(damaged) + kSeen + "</switch>")) << damaged;
  }
}

TEST(Shown, AnAreaWithoutAnySizeShowsNothing) {
  const std::string two = "<circle r='9'/><g><circle r='2'/></g>";
  for (const std::string& body : {
           "<svg width='0' height='9'>" + two + "</svg>",
           "<svg width='9' height='0' overflow='visible'>" + two + "</svg>",
           "<symbol id='s'>" + two + "</symbol><use href='#s' width='0'/>",
       }) {
    const auto d = read(body + kSeen);
    ASSERT_TRUE(d) << body << ": " << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-6) << body;
    ASSERT_EQ(d->left_out.size(), 2u) << body;
    EXPECT_EQ(d->left_out[0].why, "in an area without any size") << body;
  }
}

TEST(Shown, WhatAttributesHideIsLeftOut) {
  for (const char* hidden :
       {"<circle r='9' display='none'/>", "<g visibility='hidden'><circle r='9'/></g>",
        "<circle r='9' fill='none'/>", "<g opacity='0'><circle r='9'/></g>",
        "<circle r='9' fill='#12345600'/>", "<circle r='9' fill-opacity='0%'/>",
        "<circle r='9' fill='none' stroke='red' stroke-width='0'/>", "<circle r='9' fill='rgba(1,2,3,0)'/>",
        "<circle r='9' fill='url(#no)'/>", "<path d='M0 0H9' fill='red'/>", "<line x2='9'/>",
        "<rect width='100%' height='100%' fill='white'/>", "<path d='M0 0h100v80H0z' style='fill:#fff'/>",
        "<rect width='100' height='80' fill='rgb(255,255,255)'/>"}) {
    const auto d = read(hidden + kSeen);
    ASSERT_TRUE(d) << hidden << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-6) << hidden;
    EXPECT_EQ(d->left_out.size(), 1u) << hidden;
  }
}

TEST(Shown, WhatIsShownIsCut) {
  for (const char* shown :
       {"<g visibility='hidden'><rect width='10' height='5' visibility='visible'/></g>",
        "<style>rect{stroke:none;fill:red}</style><rect width='10' height='5'/>",
        "<style>.a{display:none}</style><rect class='a' style='display:inline' width='10' height='5'/>",
        "<style>.a{display:none}.b .a,#q{display:inline}</style><rect id='q' class='a' width='10' "
        "height='5'/>",
        "<style>@media print{rect{display:none}}rect:hover{display:none}</style><rect width='10' "
        "height='5'/>",
        "<rect style='width:10px;height:5px'/>", "<rect fill='white' width='10' height='5'/>",
        "<style>rect{width:10px}</style><rect width='3' height='5'/>", "<path fill='red' d='M0 0H10V5H0'/>",
        "<polyline points='0 0 10 0 10 5 0 5'/>", "<rect fill='url(#no) red' width='10' height='5'/>",
        "<s:rect xmlns:s='http://www.w3.org/2000/svg' width='10' height='5'/>"}) {
    const auto d = read(shown);
    ASSERT_TRUE(d) << shown << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-6) << shown;
    EXPECT_TRUE(d->contours.at(0).closed) << shown;
  }
  // A stroke alone stays open.
  const auto open = read("<path fill='none' stroke='red' d='M0 0H10V5H0'/>");
  EXPECT_NEAR(length_mm(*open), 25.0, 1e-6);
}

TEST(Shown, SheetsForOthersHideNothing) {
  const std::string hides = ".x{display:none}</style>";
  const std::string rect = "<rect class='x' width='9' height='9'/>";
  const auto cut = [&](const std::string& body) {
    const auto d = read(body + kSeen);
    EXPECT_TRUE(d) << body;
    return d->left_out.empty();
  };
  for (const char* style : {"<style media='print'>", "<style type='text/less'>"})
    EXPECT_TRUE(cut(style + hides + rect)) << style;
  for (const char* style :
       {"<style>", "<style media='screen'>", "<style media='all' type='text/css'>", "<style type=''>"})
    EXPECT_FALSE(cut(style + hides + rect)) << style;
  EXPECT_TRUE(cut("<rect style='display:none;display:inline' width='9' height='9'/>"));
  EXPECT_FALSE(cut("<rect style='display:none;display:foo bar' width='9' height='9'/>"));
  const auto elsewhere = read_svg(
      "<?xml version='1.0'?><?xml-stylesheet href='a.css'?><svg width='9mm' height='9mm'>" + rect + "</svg>");
  ASSERT_FALSE(elsewhere);
  EXPECT_NE(elsewhere.error().find("xml-stylesheet"), std::string::npos);
}

TEST(Shown, AWindowShowsWhatLiesWithinIt) {
  // A shape that fills its symbol, one beside it, one that is let out.
  const auto left_out = [&](const std::string& body) {
    const auto d = read(body + kSeen);
    EXPECT_TRUE(d) << body << d.error();
    return d ? d->left_out.size() : 99;
  };
  EXPECT_EQ(left_out("<symbol id='s' viewBox='0 0 4 4'><rect width='4' height='4'/></symbol><use href='#s' "
                     "width='9' height='9'/>"),
            0u);
  EXPECT_EQ(left_out("<symbol id='s' viewBox='0 0 4 4'><rect x='5' width='4' height='4'/></symbol><use "
                     "href='#s' width='9' height='9'/>"),
            1u);
  EXPECT_EQ(left_out("<svg width='9' height='9' overflow='visible'><circle cx='9' cy='3' r='2'/></svg>"), 0u);
  EXPECT_EQ(
      left_out("<svg width='9' height='9' style='overflow:visible'><circle cx='20' cy='3' r='2'/></svg>"),
      0u);
}

TEST(Shown, ThePagesSizeInAStyleIsNotPassedOver) {
  const std::string rest = "viewBox='0 0 90 90'><rect width='9' height='9'/></svg>";
  for (const char* style : {"style='width:90mm' ", "width='90mm' style='height:50mm' "}) {
    const auto d = read_svg(std::string("<svg ") + style + rest);
    ASSERT_FALSE(d) << style;
    EXPECT_NE(d.error().find("in a style"), std::string::npos) << d.error();
  }
  for (const char* same : {"width='90mm' style='width:90mm' ", "width='90mm' style='width:100%' ",
                           "width='90mm' style='enable-background:new' "})
    EXPECT_TRUE(read_svg(std::string("<svg ") + same + rest)) << same;
}

TEST(Shown, WhiteIsWhiteInEveryNotation) {
  for (const char* white : {"white", "#fff", "rgb(255,255,255)", "rgb(100%,100%,100%)", "hsl(0,0%,100%)",
                            "hsl(77deg 20% 100%)"}) {
    const auto d =
        read_svg(fmt::format("<svg width='90mm' height='90mm' viewBox='0 0 90 90'><rect width='90' "
                             "height='90' fill='{}'/><circle cx='40' cy='40' r='9'/></svg>",
                             white));
    ASSERT_TRUE(d) << white;
    EXPECT_EQ(d->left_out.size(), 1u) << white;
  }
  const auto red = read_svg(
      "<svg width='90mm' height='90mm' viewBox='0 0 90 90'><rect width='90' height='90' "
      "fill='hsl(0,100%,50%)'/></svg>");
  ASSERT_TRUE(red);
  EXPECT_EQ(red->pens.at(0).colour, "#ff0000");
}

TEST(Shown, WhatCannotBeFollowedAndMattersIsRefusedByName) {
  for (const auto& [body, word] : {
           std::pair("<style>rect:nth-last-child(2){display:none}</style>", "nth-last-child"),
           {"<style>@import url(a.css);</style>", "@import"},
           {"<style>@media (min-width: 9px){rect{display:none}}</style>", "min-width"},
           {"<style>g{ & circle{display:none} }</style>", "\"g\""},
           {"<style>@supports (x:y){rect{transform:none}}</style>", "supports"},
           {"<rect style='translate: 3px' width='9' height='9'/>", "translate"},
           {"<rect style='fill: var(--a)' width='9' height='9'/>", "var("},
           {"<rect style='transform-origin:50% 50%;transform-box:fill-box;transform:rotate(9deg)' width='9' "
            "height='9'/>",
            "transform-origin"},
           {"<rect style='transform-box:fill-box' transform='rotate(9)' width='9' height='9'/>", "fill-box"},
           {"<rect width='9' height='9' clip-path='circle(3px)'/>", "clip-path"},
           {"<symbol id='s' refX='3'><circle r='5'/></symbol><use href='#s'/>", "refX"},
           {"<symbol id='s'><circle r='5'/></symbol><use href='#s' width='9' height='9'/>", "<symbol>"},
           {"<svg width='9' height='9'><circle cx='9' cy='3' r='2'/></svg>", "<svg>"},
           {"<clipPath id='c'><path clip-rule='evenodd' d='M0 0H90V90H0ZM20 20H60V60H20Z'/></clipPath><rect "
            "width='9' "
            "height='9' clip-path='url(#c)'/>",
            "evenodd"},
           {"<link xmlns='http://www.w3.org/1999/xhtml' rel='stylesheet' href='a.css'/>", "another file"},
           {"<clipPath id='c'><circle r='5'/></clipPath><rect width='9' height='9' clip-path='url(#c)'/>",
            "#c"},
           {"<mask id='m'><rect fill='gray' width='99' height='99'/></mask><rect width='9' height='9' "
            "mask='url(#m)'/>",
            "mask"},
       }) {
    const auto d = read(body + kSeen);
    ASSERT_FALSE(d) << body;
    EXPECT_NE(d.error().find(word), std::string::npos) << d.error();
  }
  // What does not decide what is cut may say what it likes.
  EXPECT_TRUE(read(
      "<style>@font-face{src:url(a)} rect:nth-last-child(2){cursor:help} @keyframes k{to{left:0}}</style>" +
      kSeen));
}

TEST(Shown, ClipsThatCutNothingAwayAreFollowed) {
  const std::string clip = "<clipPath id='c'><rect width='50' height='50'/></clipPath>";
  const auto d = read(clip + "<g clip-path='url(#c)'>" + kSeen + "<circle cx='70' cy='70' r='3'/></g>");
  ASSERT_TRUE(d) << d.error();
  EXPECT_EQ(d->contours.size(), 1u);
  ASSERT_EQ(d->left_out.size(), 1u);
  EXPECT_EQ(d->left_out[0].why, "outside its clip-path");
}

TEST(Shown, TransformsOfAStyleAndOriginsAreHonoured) {
  const std::string rect = "<rect x='40' y='30' width='30' height='20' ";
  for (const char* how :
       {"transform-origin='55 40' transform='rotate(90)'/>",
        "style='transform:rotate(90deg);transform-origin:55px 40px'/>",
        "style='transform-origin:55% 50%;transform:rotate(0.25turn)'/>", "transform='rotate(90 55 40)'/>"}) {
    const auto d = read(rect + how);
    ASSERT_TRUE(d) << how << d.error();
    const auto box = geometry::bounding_box(d->contours.at(0).points_m);
    EXPECT_NEAR((box.min - 1e-3 * Vec2(45, -55)).norm() + (box.max - 1e-3 * Vec2(65, -25)).norm(), 0.0, 1e-12)
        << how;
  }
}

TEST(Shown, PixelsHaveTheSizeOfTheProgramThatWroteThem) {
  const auto side_mm = [](const std::string& before, const std::string& root,
                          const VectorRequest& request = {}) {
    const auto d = read_svg(before + "<svg " + root + "><rect width='72' height='72'/></svg>", {}, request);
    EXPECT_TRUE(d) << d.error();
    EXPECT_FALSE(d->size_from.empty());
    return 1e3 * length_m(d->contours.at(0)) / 4.0;
  };
  EXPECT_NEAR(side_mm("<!-- Generator: Adobe Illustrator 25.0.1 -->", "viewBox='0 0 99 99'"), 25.4, 1e-9);
  EXPECT_NEAR(side_mm("<!-- Generator: Adobe Illustrator 25.0.1 -->", "width='99px' height='99px'"), 25.4,
              1e-9);
  EXPECT_NEAR(side_mm("<!-- Generator: Adobe Illustrator -->", "width='72mm' viewBox='0 0 72 72'"), 72.0,
              1e-9);
  EXPECT_NEAR(side_mm("", "inkscape:version='0.48.4 r9939'"), 25.4 * 72 / 90, 1e-9);
  EXPECT_NEAR(side_mm("", "inkscape:version='1.2'"), 25.4 * 72 / 96, 1e-9);
  EXPECT_NEAR(side_mm("", "", {.dpi = 72.0}), 25.4, 1e-9);
  EXPECT_NEAR(side_mm("", "width='5in' viewBox='0 0 9 9'", {.unit_m = 1e-3}), 72.0, 1e-9);
}

TEST(Shown, EntitiesPrefixesAndEncodingsAreRead) {
  const std::string plain =
      "<!DOCTYPE svg [<!ENTITY ns 'http://www.w3.org/2000/svg'> <!ENTITY w \"10\">]>"
      "<a:svg xmlns:a='&ns;'><a:rect width='&w;mm' height='5mm'/><rect width='3' height='3'/></a:svg>";
  std::string wide = "\xFF\xFE";
  for (const char c : plain) wide += {c, '\0'};
  for (const std::string& text : {plain, "\xEF\xBB\xBF" + plain, wide}) {
    const auto d = read_svg(text);
    ASSERT_TRUE(d) << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-9);
  }
  const auto bomb = read_svg("<!DOCTYPE svg [<!ENTITY a '" + std::string(1000, 'x') + "'>]><svg id='" +
                                 std::string(3000, '&') + "'/>",
                             {.max_bytes = 5000});
  EXPECT_FALSE(bomb);
}

TEST(Shown, LayersAndColoursAreChosen) {
  const std::string body =
      "<g id='cut'><rect width='10' height='5' stroke='#f00' fill='none'/></g>"
      "<g id='engrave'><circle cx='50' cy='50' r='9' stroke='blue' fill='none'/></g>";
  for (const VectorRequest& request :
       {VectorRequest{.layers = {"cut"}}, VectorRequest{.colours = {"#FF0000"}}}) {
    const auto d = read(body, request);
    ASSERT_TRUE(d) << d.error();
    EXPECT_NEAR(length_mm(*d), 30.0, 1e-9);
    EXPECT_EQ(d->pens.at(0).layer, "cut");
    EXPECT_EQ(d->left_out.size(), 1u);
  }
  // A slip of the hand is told what there is.
  for (const auto& [request, there] :
       {std::pair(VectorRequest{.layers = {"none such"}}, "\"cut\", \"engrave\""),
        {VectorRequest{.layers = {"cut", "bend"}}, "--layers bend"},
        {VectorRequest{.colours = {"green"}}, "\"#0000ff\", \"#ff0000\""}}) {
    const auto d = read(body, request);
    ASSERT_FALSE(d);
    EXPECT_NE(d.error().find(there), std::string::npos) << d.error();
  }
}

TEST(Shown, ALayerHoldsThoseWithinIt) {
  const std::string layer = "inkscape:groupmode='layer' inkscape:label=";
  const std::string body = "<g xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' " + layer +
                           "'part'>" + kSeen + "<g " + layer + "'holes'><g id='no-layer'>" +
                           kSeen.substr(0, 6) +
                           "y='30' width='10' height='10' stroke='red' fill='none'/></g></g></g>";
  for (const auto& [asked, mm] : {std::pair("part", 70.0), {"holes", 40.0}, {"Part/Holes", 40.0}}) {
    const auto d = read(body, {.layers = {asked}});
    ASSERT_TRUE(d) << d.error();
    EXPECT_NEAR(length_mm(*d), mm, 1e-9) << asked;
  }
  const auto all = read(body);
  ASSERT_TRUE(all) << all.error();
  EXPECT_EQ(all->pens.at(1).layer, "part/holes");
  // A layer within a hidden one is hidden, whatever it says of itself.
  const auto hidden = read("<g style='display:none'>" + body + "</g>" +
                           "<g><circle cx='50' cy='50' r='5' stroke='red' fill='none'/></g>");
  ASSERT_TRUE(hidden) << hidden.error();
  EXPECT_EQ(hidden->contours.size(), 1u);
  EXPECT_EQ(hidden->left_out.size(), 2u);
}

TEST(Shown, ColoursAreMeantByNameOrNumber) {
  const std::string body =
      "<rect width='10' height='5' stroke='Crimson' fill='none'/>"
      "<circle cx='50' cy='50' r='9' stroke='#00F' fill='none'/>";
  for (const char* asked : {"crimson", "#dc143c", "#DC143C", "rgb"}) {
    const auto d = read(body, {.colours = {asked}});
    EXPECT_EQ(d.has_value(), std::string(asked) != "rgb") << asked;
    if (d) {
      EXPECT_NEAR(length_mm(*d), 30.0, 1e-9) << asked;
    }
  }
  EXPECT_EQ(named_colour("rebeccaPurple"), "#663399");
  EXPECT_EQ(named_colour("aliceblue"), "#f0f8ff");
  EXPECT_EQ(named_colour("yellowgreen"), "#9acd32");
  EXPECT_FALSE(named_colour("zinc"));
}

TEST(Shown, DamageIsShownWithWhatStandsAroundIt) {
  const auto d = read("<path stroke='red' d='M20 20h40v30h-40z M10 70 X'/>");
  ASSERT_FALSE(d);
  EXPECT_NE(d.error().find("near \"h40v30h-40z M10 70 X"), std::string::npos) << d.error();
  // Nobody sees it.
  EXPECT_TRUE(read("<path display='none' d='M20 20 X'/>" + kSeen));
}

}  // namespace
}  // namespace telekerf::vision
