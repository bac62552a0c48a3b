#include "core/products/report.h"

#include <cctype>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/registration/pair_judgement.h"

namespace tiltmap {
namespace {

// Every tag is closed in order, attributes are quoted, and every ampersand begins a reference. Returns what
// is wrong, or nothing.
std::string faultOf(const std::string& page) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < page.size(); ++at) {
    if (page[at] == '&') {
      const std::size_t end = page.find(';', at);
      if (end == std::string::npos || end - at > 7) return "bare & at " + page.substr(at, 20);
    }
    if (page[at] != '<') continue;
    const std::size_t end = page.find('>', at);
    if (end == std::string::npos) return "unclosed <";
    const std::string tag = page.substr(at + 1, end - at - 1);
    at = end;
    if (tag.find('<') != std::string::npos) return "bare < in " + tag.substr(0, 20);
    if (tag.front() == '!') continue;
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return "unexpected </" + tag.substr(1);
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return "odd quotes in " + tag;
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

ReportData example() {
  ReportData data;
  data.survey = "Car park <north> & \"yard\"";
  data.program_version = "1.2.3";
  data.date = "5 April 2031";
  data.scan_count = 3;
  data.point_count = 1234567;
  data.warnings = {"pair 1:2 failed <b>badly</b>"};
  data.picture = RgbImage(4, 3, {10, 20, 30});
  data.picture_caption = "From above";
  const std::vector<Pose> truth = {Pose(), Pose::planar(1, 2, 0), Pose::planar(-3, 4, 1)};
  const std::vector<Pose> estimated = {Pose(), Pose::planar(1.003, 2.004, 0), Pose::planar(-3, 4, 1)};
  data.stages = {{localisationTable("truth", truth), *evaluateTrajectory(truth, truth)},
                 {localisationTable("pairwise", estimated), *evaluateTrajectory(estimated, truth)}};
  data.pairs = {{0, 1, 0.734, 0.0123, 8123, 17, "small change", 91.26, true},
                {1, 2, 0.02, 0.4, 12, 1, "too few pairs", 3.0, false}};
  LinkJudgement judged;
  judged.quality = LinkQuality::Bad;
  judged.reason = "the other links put it <far> away";
  judged.others.supported = true;
  judged.others.off = {0.0321, 0.001};
  judged.others.deviations = 7.25;
  judged.others.loop = 4;
  judged.others.misclosure = {0.0543, 0.002};
  data.trust = {{1, 2, judged}};
  PairJudgement scans;
  scans.overlap_fixed = 0.37, scans.fit = 0.91;
  scans.residual_m = 0.0046, scans.expected_m = 0.0041;
  scans.strength.weakest_m = 0.0037;
  judged.by_scans = std::make_shared<const PairJudgement>(scans);
  judged.quality = LinkQuality::Good;
  judged.reason = "fits";
  data.trust.push_back({0, 1, judged});
  data.relaxed_links = 1234;
  data.movements = {{0, 0.0, 0.0}, {1, 0.01234, 0.0567}};
  ParameterInfo info;
  info.name = "max-distance";
  info.unit = "m";
  info.help = "how far & wide";
  data.parameters = {{"register", "default", {{"max-distance", 0.75}, {"threads", 2LL}}, {info}}};
  data.files = {{"my map #1.ply", "Map (PLY)"}};
  return data;
}

bool holds(const std::string& page, const std::string& text) {
  return page.find(text) != std::string::npos;
}

TEST(Report, IsWellFormedAndHoldsTheValues) {
  const auto page = reportHtml(example());
  ASSERT_TRUE(page);
  EXPECT_EQ(faultOf(*page), "");
  for (const char* text : {"5 April 2031",
                           "1.2.3",
                           "1,234,567",
                           "From above",
                           "<td class=\"n\">73</td>",
                           "<td class=\"n\">12.3</td>",
                           "<td class=\"n\">8,123</td>",
                           "<td class=\"n\">17</td>",
                           "<td>small change</td>",
                           "<td class=\"n\">91.3</td>",
                           "failed: too few pairs",
                           "<span class=\"bad\">bad</span>",
                           "the other links put it &lt;far&gt; away",
                           "<td class=\"n\">–</td>",
                           "<td class=\"n\">32.1</td>",
                           "<td class=\"n\">54.3</td>",
                           "<td>good</td>",
                           "<td class=\"n\">37</td>",
                           "<td class=\"n\">4.6</td>",
                           "<td class=\"n\">4.1</td>",
                           "<td class=\"n\">7.4</td>",
                           "1,234 more overlapping pairs",
                           "<td class=\"n\">12.34</td>",
                           "<td class=\"n\">0.0567</td>",
                           "Stops after pairwise registration",
                           "<td class=\"n\">1.003</td>",
                           "<td class=\"n\">−3.000</td>",
                           "<td class=\"n\">5.0</td>",
                           "max-distance",
                           "0.75",
                           "how far &amp; wide",
                           "register, preset default",
                           "[mm]",
                           "[deg]",
                           "[ms]"})
    EXPECT_TRUE(holds(*page, text)) << text;
  // RMSE of 5 mm and 0 over two stops.
  EXPECT_TRUE(holds(*page, "3.5 <small>mm</small>"));
  EXPECT_TRUE(holds(*page, "1 <small>of 2</small>"));
}

TEST(Report, EscapesEveryText) {
  ReportData data = example();
  const std::string nasty = "<script>alert('x')</script> & \"q\" \x01 \xff";
  data.survey = data.date = data.program_version = data.picture_caption = nasty;
  data.warnings = {nasty};
  data.pairs[0].stop_reason = data.pairs[1].stop_reason = nasty;
  data.stages[0].table.caption = data.stages[1].table.stage = nasty;
  data.parameters = {{nasty, nasty, {{nasty, nasty}}, {}}};
  data.files = {{nasty, nasty}, {"\"onclick=\"x", ""}};
  const auto page = reportHtml(data);
  ASSERT_TRUE(page);
  EXPECT_EQ(faultOf(*page), "");
  EXPECT_FALSE(holds(*page, "<script"));
  EXPECT_FALSE(holds(*page, "\x01"));
  EXPECT_FALSE(holds(*page, "\xff"));
  EXPECT_FALSE(holds(*page, "\"onclick"));
  EXPECT_TRUE(holds(*page, "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &amp; &quot;q&quot;"));
}

TEST(Report, NeedsNothingElse) {
  const auto page = reportHtml(example());
  ASSERT_TRUE(page);
  EXPECT_FALSE(holds(*page, "<script"));
  EXPECT_FALSE(holds(*page, "<link"));
  EXPECT_FALSE(holds(*page, "url("));
  EXPECT_FALSE(holds(*page, "src=\"http"));
  // The picture is inside: base64 of the PNG signature.
  EXPECT_TRUE(holds(*page, "src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_TRUE(holds(*page, "href=\"my%20map%20%231.ply\""));
}

TEST(Report, PutsWarningsBeforeEverythingElse) {
  const auto page = reportHtml(example());
  ASSERT_TRUE(page);
  EXPECT_TRUE(holds(*page, "pair 1:2 failed &lt;b&gt;badly&lt;/b&gt;"));
  EXPECT_LT(page->find("One warning"), page->find("Points in the map"));
  EXPECT_LT(page->find("One warning"), page->find("<figure"));
}

TEST(Report, LeavesOutWhatThereIsNot) {
  ReportData bare;
  bare.survey = "Empty";
  const auto page = reportHtml(bare);
  ASSERT_TRUE(page);
  EXPECT_EQ(faultOf(*page), "");
  for (const char* text : {"<figure", "<h2>", "<table", "warning\"", "RMSE", "Points in the map"})
    EXPECT_FALSE(holds(*page, text)) << text;
  // Without truth there are poses, but no errors.
  bare.stages = {{localisationTable("odometry", {Pose()}), std::nullopt}};
  EXPECT_TRUE(holds(*reportHtml(bare), "Stops as the odometry measured them"));
  EXPECT_FALSE(holds(*reportHtml(bare), "RMSE"));
  EXPECT_FALSE(holds(*reportHtml(bare), "Position error"));
}

TEST(Report, APictureThatCannotBeEncodedIsAnError) {
  ReportData data = example();
  data.picture = RgbImage();
  EXPECT_FALSE(reportHtml(data));
}

TEST(Report, BaseSixtyFourKeepsEveryLength) {
  // Pictures of different widths end in different numbers of spare bytes; decode one of each by hand.
  for (int width = 1; width <= 6; ++width) {
    ReportData data = example();
    data.picture = RgbImage(width, 1, {static_cast<std::uint8_t>(40 * width), 7, 99});
    const auto page = reportHtml(data);
    ASSERT_TRUE(page);
    const std::size_t from = page->find("base64,") + 7;
    const std::string text = page->substr(from, page->find('"', from) - from);
    EXPECT_EQ(text.size() % 4, 0U);
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (const char c : text) {
      if (c == '=') break;
      bits = (bits << 6U) | static_cast<unsigned>(letters.find(c));
      count += 6;
      if (count >= 8) bytes += static_cast<char>((bits >> static_cast<unsigned>(count -= 8)) & 0xffU);
    }
    // A PNG ends in the checksum of its IEND chunk.
    ASSERT_GT(bytes.size(), 12U);
    EXPECT_EQ(bytes.substr(bytes.size() - 8), std::string("IEND\xae\x42\x60\x82"));
  }
}

}  // namespace
}  // namespace tiltmap
