// A summary of a survey as one web page that needs nothing else.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/parameter.h"
#include "core/base/result.h"
#include "core/products/evaluation.h"
#include "core/products/localisation_table.h"
#include "core/products/rgb_image.h"
#include "core/project/link_quality.h"

namespace tiltmap {

// The poses of one stage; how good they are where the truth is known.
struct ReportStage {
  LocalisationTable table;
  std::optional<TrajectoryEvaluation> evaluation;
};

struct ReportPair {
  std::size_t fixed = 0;
  std::size_t moving = 0;
  double overlap = 0.0;  // 0 to 1
  double rms_m = 0.0;
  long long correspondences = 0;
  int iterations = 0;
  std::string stop_reason;
  double milliseconds = 0.0;
  bool succeeded = true;
};

// Whether a link can be trusted, as the window and `link list` tell it.
struct ReportTrust {
  std::size_t fixed = 0;
  std::size_t moving = 0;
  LinkJudgement judgement;
};

// How far the relaxation moved a stop from its pairwise pose.
struct ReportMovement {
  std::size_t stop = 0;
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

struct ReportParameters {
  std::string operation;  // "register"
  std::string preset;     // "default"; may be empty
  ParameterValues values;
  std::vector<ParameterInfo> infos;  // where known: units and what they mean
};

struct ReportLink {
  std::string path;  // relative to the page
  std::string text;  // "Map, 412,338 points (PLY)"
};

struct ReportData {
  std::string survey;
  std::string program_version;
  std::string date;  // as it is to be read; the page does not look at a clock
  std::size_t scan_count = 0;
  std::size_t point_count = 0;  // of the map; 0 where there is none
  std::vector<std::string> warnings;
  std::optional<RgbImage> picture;  // goes into the page
  std::string picture_caption;
  std::vector<ReportStage> stages;  // in the order of processing
  std::vector<ReportPair> pairs;
  std::vector<ReportTrust> trust;
  std::size_t relaxed_links = 0;  // pairs that the relaxation found beyond those
  std::vector<ReportMovement> movements;
  std::vector<ReportParameters> parameters;
  std::vector<ReportLink> files;
};

// HTML that is well-formed XML too. Every text is escaped; no script, no font, no request to anywhere; light
// or dark as the reader's system is, and light on paper. Parts without content are left out. Error: the
// picture cannot be encoded.
Result<std::string> reportHtml(const ReportData& data);

}  // namespace tiltmap
