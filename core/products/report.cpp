#include "core/products/report.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/products/png.h"
#include "core/products/report_style.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

namespace {

// Also right inside an attribute. What no XML may hold (control characters, broken UTF-8) becomes U+FFFD.
std::string escaped(std::string_view text) {
  std::string safe;
  for (const char32_t c : codePointsOf(text)) {
    switch (c) {
      case U'&':
        safe += "&amp;";
        break;
      case U'<':
        safe += "&lt;";
        break;
      case U'>':
        safe += "&gt;";
        break;
      case U'"':
        safe += "&quot;";
        break;
      case U'\'':
        safe += "&#39;";
        break;
      default: {
        const bool allowed = (c >= 0x20 || c == U'\n' || c == U'\t') && c != 0xfffe && c != 0xffff;
        safe += utf8Of(allowed ? c : U'\ufffd');
      }
    }
  }
  return safe;
}

// A path as the address of a link: bytes that mean something in an address are written as %XX.
std::string addressOf(std::string_view path) {
  constexpr std::string_view kPlain = "-._~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string address;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || kPlain.find(c) != std::string_view::npos)
      address += c;
    else
      address += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return address;
}

// RFC 4648.
std::string base64Of(std::string_view bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    unsigned triple = 0;
    for (std::size_t k = 0; k < 3; ++k)
      triple = (triple << 8U) | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += at + k <= bytes.size() ? kLetters[(triple >> (18U - 6U * k)) & 63U] : '=';
  }
  return text;
}

// A true minus, which is as wide as the digits. A value that is not a number stays visible as such.
std::string number(double value, int places) {
  if (!std::isfinite(value)) return "–";
  std::string text = fixedReal(value, places);
  if (text.front() == '-') text.replace(0, 1, "−");
  return text;
}

struct Column {
  std::string name;
  std::string unit;  // may be empty
  bool numeric = true;
};

// Cells are HTML already.
class HtmlTable {
 public:
  explicit HtmlTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void add(const std::vector<std::string>& cells) {
    rows_ += "<tr>";
    for (std::size_t c = 0; c < cells.size(); ++c)
      rows_ += (columns_[c].numeric ? "<td class=\"n\">" : "<td>") + cells[c] + "</td>";
    rows_ += "</tr>\n";
  }
  std::string html() const {
    std::string text = "<div class=\"scroll\"><table>\n<thead><tr>";
    for (const Column& column : columns_) {
      text += column.numeric ? "<th scope=\"col\" class=\"n\">" : "<th scope=\"col\">";
      text += escaped(column.name);
      if (!column.unit.empty()) text += " <small>[" + escaped(column.unit) + "]</small>";
      text += "</th>";
    }
    return text + "</tr></thead>\n<tbody>\n" + rows_ + "</tbody></table></div>\n";
  }

 private:
  std::vector<Column> columns_;
  std::string rows_;
};

std::string figure(const std::string& name, const std::string& value, const std::string& unit) {
  return "<div class=\"card\"><dt>" + escaped(name) + "</dt><dd>" + value +
         (unit.empty() ? "" : " <small>" + escaped(unit) + "</small>") + "</dd></div>\n";
}

std::string keyFigures(const ReportData& data) {
  std::string text = "<dl class=\"figures\">\n" + figure("Stops", std::to_string(data.scan_count), "");
  if (data.point_count > 0)
    text += figure("Points in the map", groupedInteger(static_cast<long long>(data.point_count)), "");
  if (!data.pairs.empty()) {
    const auto good =
        std::count_if(data.pairs.begin(), data.pairs.end(), [](const auto& p) { return p.succeeded; });
    text += figure("Pairs registered", std::to_string(good), "of " + std::to_string(data.pairs.size()));
    double milliseconds = 0.0;
    for (const ReportPair& pair : data.pairs) milliseconds += pair.milliseconds;
    text += figure("Registration", number(milliseconds / 1000.0, 2), "s");
  }
  // The last stage with known errors is what the reader gets.
  for (auto stage = data.stages.rbegin(); stage != data.stages.rend(); ++stage)
    if (stage->evaluation && stage->table.stage != "truth") {
      text += figure("Position error, RMSE", number(1000.0 * stage->evaluation->rmse_translation_m, 1), "mm");
      text += figure("Rotation error, RMSE", number(stage->evaluation->rmse_rotation_deg, 3), "deg");
      break;
    }
  return text + "</dl>\n";
}

std::string warningsHtml(const std::vector<std::string>& warnings) {
  if (warnings.empty()) return "";
  std::string text =
      "<section class=\"warnings\"><h2>" +
      (warnings.size() == 1 ? std::string("One warning") : std::to_string(warnings.size()) + " warnings") +
      "</h2>\n<ul>\n";
  for (const std::string& warning : warnings) text += "<li>" + escaped(warning) + "</li>\n";
  return text + "</ul></section>\n";
}

Result<std::string> pictureHtml(const ReportData& data) {
  if (!data.picture) return std::string();
  const Result<std::string> png = encodePng(*data.picture);
  if (!png) return fail(png.error());
  std::string text = "<figure class=\"card\"><img alt=\"The map from above\" width=\"" +
                     std::to_string(data.picture->width) + "\" height=\"" +
                     std::to_string(data.picture->height) + "\" src=\"data:image/png;base64," +
                     base64Of(*png) + "\" />\n";
  if (!data.picture_caption.empty())
    text += "<figcaption>" + escaped(data.picture_caption) + "</figcaption>\n";
  return text + "</figure>\n";
}

std::string filesHtml(const std::vector<ReportLink>& files) {
  if (files.empty()) return "";
  std::string text = "<section><h2>Files</h2>\n<ul class=\"card files\">\n";
  for (const ReportLink& file : files)
    text += "<li><a href=\"" + addressOf(file.path) + "\">" +
            escaped(file.text.empty() ? file.path : file.text) + "</a></li>\n";
  return text + "</ul></section>\n";
}

std::string accuracyHtml(const std::vector<ReportStage>& stages) {
  HtmlTable table({{"Stage", "", false},
                   {"Position, RMSE", "mm"},
                   {"Position, worst", "mm"},
                   {"Rotation, RMSE", "deg"},
                   {"Rotation, worst", "deg"}});
  bool any = false;
  for (const ReportStage& stage : stages) {
    if (!stage.evaluation || stage.table.stage == "truth") continue;
    any = true;
    double worst_m = 0.0;
    double worst_deg = 0.0;
    for (const StopError& stop : stage.evaluation->stops) {
      worst_m = std::max(worst_m, stop.translation_error_m);
      worst_deg = std::max(worst_deg, stop.rotation_error_deg);
    }
    table.add({escaped(stage.table.stage), number(1000.0 * stage.evaluation->rmse_translation_m, 1),
               number(1000.0 * worst_m, 1), number(stage.evaluation->rmse_rotation_deg, 3),
               number(worst_deg, 3)});
  }
  if (!any) return "";
  return "<section><h2>Accuracy</h2>\n<p class=\"dim\">Against the known truth, both relative to the first "
         "stop, which "
         "is therefore exact and not counted.</p>\n<div class=\"card\">" +
         table.html() + "</div></section>\n";
}

std::string pairsHtml(const std::vector<ReportPair>& pairs) {
  if (pairs.empty()) return "";
  HtmlTable table({{"Fixed", ""},
                   {"Moving", ""},
                   {"Matched", "%"},
                   {"RMS distance", "mm"},
                   {"Correspondences", ""},
                   {"Iterations", ""},
                   {"Stopped because", "", false},
                   {"Time", "ms"}});
  for (const ReportPair& pair : pairs) {
    const std::string reason = escaped(pair.stop_reason);
    table.add({std::to_string(pair.fixed), std::to_string(pair.moving), number(100.0 * pair.overlap, 0),
               number(1000.0 * pair.rms_m, 1), groupedInteger(pair.correspondences),
               std::to_string(pair.iterations),
               pair.succeeded ? reason : "<span class=\"bad\">failed: " + reason + "</span>",
               number(pair.milliseconds, 1)});
  }
  return "<section><h2>Registered pairs</h2>\n<div class=\"card\">" + table.html() + "</div></section>\n";
}

// Every link with what its verdict rests on; dashes where its scans were not held against each other.
std::string trustHtml(const std::vector<ReportTrust>& links) {
  if (links.empty()) return "";
  HtmlTable table({{"Fixed", ""},
                   {"Moving", ""},
                   {"Verdict", "", false},
                   {"Overlap", "%"},
                   {"Fit", "%"},
                   {"Residual", "mm"},
                   {"Its noise", "mm"},
                   {"Held within", "mm"},
                   {"Moved", "mm"},
                   {"Others", "mm"},
                   {"Times", ""},
                   {"Loop", "mm"},
                   {"Why", "", false}});
  const std::string none = "–";
  for (const ReportTrust& link : links) {
    const LinkJudgement& judged = link.judgement;
    const PairJudgement* scans = judged.by_scans.get();
    const LinkAgreement& others = judged.others;
    const auto of_scans = [&](double value, int places) { return scans ? number(value, places) : none; };
    const std::string verdict = linkQualityName(judged.quality);
    const bool bad = judged.quality == LinkQuality::Bad || judged.quality == LinkQuality::Failed;
    table.add({std::to_string(link.fixed), std::to_string(link.moving),
               bad ? "<span class=\"bad\">" + verdict + "</span>" : verdict,
               of_scans(scans ? 100.0 * scans->overlap() : 0.0, 0),
               of_scans(scans ? 100.0 * scans->fit : 0.0, 0),
               of_scans(scans ? 1000.0 * scans->residual_m : 0.0, 1),
               of_scans(scans ? 1000.0 * scans->expected_m : 0.0, 1),
               of_scans(scans ? 2000.0 * scans->strength.weakest_m : 0.0, 1),
               of_scans(scans ? 1000.0 * scans->moved.translation_m : 0.0, 1),
               others.supported ? number(1000.0 * others.off.translation_m, 1) : none,
               others.supported ? number(others.deviations, 1) : none,
               others.loop > 0 ? number(1000.0 * others.misclosure.translation_m, 1) : none,
               escaped(judged.reason)});
  }
  return "<section><h2>Can the links be trusted?</h2>\n<p class=\"dim\">Each link's two scans held against "
         "each "
         "other, and the links against each other. Held within: two deviations in the weakest direction. "
         "Others: "
         "how far from the link the other links together put its scans, and times what both are uncertain "
         "by. "
         "Loop: how far the shortest loop of links through it is from closing.</p>\n<div class=\"card\">" +
         table.html() + "</div></section>\n";
}

std::string movementsHtml(const ReportData& data) {
  if (data.movements.empty()) return "";
  HtmlTable table({{"Stop", ""}, {"Moved", "mm"}, {"Turned", "deg"}});
  for (const ReportMovement& moved : data.movements)
    table.add(
        {std::to_string(moved.stop), number(1000.0 * moved.translation_m, 2), number(moved.rotation_deg, 4)});
  std::string text =
      "<section><h2>Relaxation</h2>\n<p class=\"dim\">How far each stop moved from its pairwise pose.";
  if (data.relaxed_links > 0)
    text += " Beyond the registered pairs, " + groupedInteger(static_cast<long long>(data.relaxed_links)) +
            (data.relaxed_links == 1 ? " more overlapping pair of scans was used."
                                     : " more overlapping pairs of scans were used.");
  return text + "</p>\n<div class=\"card\">" + table.html() + "</div></section>\n";
}

std::string stagesHtml(const std::vector<ReportStage>& stages) {
  if (stages.empty()) return "";
  std::string text =
      "<section><h2>Localisation</h2>\n<p class=\"dim\">The first stop is the world: x right, y forward, "
      "z up. The heading is a unit vector.</p>\n";
  for (const ReportStage& stage : stages) {
    std::vector<Column> columns = {{"Stop", ""},      {"x", "m"},        {"y", "m"},       {"z", "m"},
                                   {"Heading x", ""}, {"Heading y", ""}, {"Heading z", ""}};
    const bool errors = stage.evaluation && stage.table.stage != "truth" &&
                        stage.evaluation->stops.size() == stage.table.rows.size();
    if (errors) {
      columns.push_back({"Position error", "mm"});
      columns.push_back({"Rotation error", "deg"});
    }
    HtmlTable table(columns);
    for (std::size_t i = 0; i < stage.table.rows.size(); ++i) {
      const LocalisationRow& row = stage.table.rows[i];
      std::vector<std::string> cells = {std::to_string(row.stop)};
      for (int axis = 0; axis < 3; ++axis) cells.push_back(number(row.position_m(axis), 3));
      for (int axis = 0; axis < 3; ++axis) cells.push_back(number(row.heading(axis), 4));
      if (errors) {
        cells.push_back(number(1000.0 * stage.evaluation->stops[i].translation_error_m, 1));
        cells.push_back(number(stage.evaluation->stops[i].rotation_error_deg, 3));
      }
      table.add(cells);
    }
    text += "<h3>" + escaped(stage.table.caption) + "</h3>\n<div class=\"card\">" + table.html() + "</div>\n";
  }
  return text + "</section>\n";
}

std::string parametersHtml(const std::vector<ReportParameters>& all) {
  std::string text;
  for (const ReportParameters& used : all) {
    HtmlTable table({{"Parameter", "", false}, {"Value", ""}, {"Unit", "", false}, {"Meaning", "", false}});
    for (const auto& [name, value] : used.values) {
      const auto info = std::find_if(used.infos.begin(), used.infos.end(),
                                     [&name = name](const ParameterInfo& i) { return i.name == name; });
      const bool known = info != used.infos.end();
      table.add({"<code>" + escaped(name) + "</code>", escaped(parameterText(value)),
                 known ? escaped(info->unit) : "", known ? escaped(info->help) : ""});
    }
    text += "<details class=\"card\" open=\"open\"><summary>" + escaped(used.operation) +
            (used.preset.empty() ? "" : ", preset " + escaped(used.preset)) + "</summary>\n" + table.html() +
            "</details>\n";
  }
  return text.empty() ? "" : "<section><h2>Parameters</h2>\n" + text + "</section>\n";
}

}  // namespace

Result<std::string> reportHtml(const ReportData& data) {
  const Result<std::string> picture = pictureHtml(data);
  if (!picture) return fail(picture.error());
  const std::string survey = escaped(data.survey);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n<meta "
      "charset=\"utf-8\" />\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n<title>" +
      survey + "</title>\n<style>" + kReportStyle + "</style>\n</head>\n<body><main>\n<header><h1>" + survey +
      "</h1>\n<div class=\"dim\">" + escaped(data.date) + "</div></header>\n";
  page += warningsHtml(data.warnings);
  page += keyFigures(data);
  page += *picture;
  page += filesHtml(data.files);
  page += accuracyHtml(data.stages);
  page += pairsHtml(data.pairs);
  page += trustHtml(data.trust);
  page += movementsHtml(data);
  page += stagesHtml(data.stages);
  page += parametersHtml(data.parameters);
  page +=
      "<footer>Written by Tiltmap " + escaped(data.program_version) + "</footer>\n</main></body>\n</html>\n";
  return page;
}

}  // namespace tiltmap
