#include "core/project/site_picture.h"

#include <complex>

#include <nlohmann/json.hpp>

#include "core/project/photographs.h"
#include "core/project/project_edit.h"

namespace tiltmap {

namespace {

using Complex = std::complex<double>;

Complex upright(const Eigen::Vector2d& picture_px) {
  return {picture_px.x(), -picture_px.y()};
}
Complex of(const Eigen::Vector2d& v) {
  return {v.x(), v.y()};
}

constexpr double kNearest_px = 1.0;  // two points closer than this tell no direction
constexpr double kNearest_m = 0.01;

ProjectEdit editOf(std::string title, std::optional<NewSitePicture> picture) {
  ProjectEdit edit;
  edit.title = std::move(title);
  edit.steps.emplace_back(SetSitePicture{std::move(picture)});
  return edit;
}

Error nothingThere(const ProjectSnapshot& snapshot) {
  return {"the project has no picture of the site", snapshot.path().string(), "add one first"};
}

}  // namespace

Result<SitePicturePlacement> SitePicturePlacement::make(const SitePicturePoints& points) {
  const auto refuse = [](const char* what) {
    return fail(what, "points of the site picture", "choose two points far from each other");
  };
  for (const SitePicturePoint& point : points)
    if (!point.picture_px.allFinite() || !point.world_m.allFinite()) return refuse("a point is not a number");
  const Complex in_picture = upright(points[1].picture_px) - upright(points[0].picture_px);
  const Complex in_world = of(points[1].world_m) - of(points[0].world_m);
  if (std::abs(in_picture) < kNearest_px) return refuse("the two points are the same in the picture");
  if (std::abs(in_world) < kNearest_m) return refuse("the two points are the same in the world");
  const Complex turn = in_world / in_picture;
  const Complex shift = of(points[0].world_m) - turn * upright(points[0].picture_px);
  SitePicturePlacement placement;
  placement.turn_ = {turn.real(), turn.imag()};
  placement.shift_ = {shift.real(), shift.imag()};
  return placement;
}

Eigen::Vector2d SitePicturePlacement::worldOf(const Eigen::Vector2d& picture_px) const {
  const Complex world = of(turn_) * upright(picture_px) + of(shift_);
  return {world.real(), world.imag()};
}

Eigen::Vector2d SitePicturePlacement::pictureOf(const Eigen::Vector2d& world_m) const {
  const Complex picture = (of(world_m) - of(shift_)) / of(turn_);
  return {picture.real(), -picture.imag()};
}

Result<ProjectEdit> sitePictureEdit(const std::filesystem::path& file, const SitePicturePoints& points) {
  if (auto placed = SitePicturePlacement::make(points); !placed) return fail(placed.error());
  auto read = photographFromFile(file, {}, true);
  if (!read) return fail(read.error());
  return editOf("picture of the site", NewSitePicture{file.filename().string(), read->media_type,
                                                      std::move(read->bytes), 0, points});
}

Result<ProjectEdit> placeSitePictureEdit(const ProjectSnapshot& snapshot, const SitePicturePoints& points) {
  const auto& picture = snapshot.sitePicture();
  if (!picture) return fail(nothingThere(snapshot));
  if (auto placed = SitePicturePlacement::make(points); !placed) return fail(placed.error());
  return editOf("place the picture of the site",
                NewSitePicture{picture->name, picture->media_type, {}, picture->attachment, points});
}

Result<ProjectEdit> removeSitePictureEdit(const ProjectSnapshot& snapshot) {
  if (!snapshot.sitePicture()) return fail(nothingThere(snapshot));
  return editOf("remove the picture of the site", std::nullopt);
}

std::string sitePictureText(const SitePicture& picture) {
  nlohmann::json points = nlohmann::json::array();
  for (const SitePicturePoint& p : picture.points)
    points.push_back({p.picture_px.x(), p.picture_px.y(), p.world_m.x(), p.world_m.y()});
  const nlohmann::json json = {
      {"name", picture.name}, {"media_type", picture.media_type}, {"points", points}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<SitePicture> parseSitePicture(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto points = json.find("points");
  if (points == json.end() || !points->is_array() || points->size() != 2) return std::nullopt;
  SitePicture picture;
  const auto word = [&json](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  picture.name = word("name");
  picture.media_type = word("media_type");
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& from = (*points)[i];
    if (!from.is_array() || from.size() != 4) return std::nullopt;
    for (const auto& number : from)
      if (!number.is_number()) return std::nullopt;
    picture.points[i] = {{from[0].get<double>(), from[1].get<double>()},
                         {from[2].get<double>(), from[3].get<double>()}};
  }
  return SitePicturePlacement::make(picture.points) ? std::optional(picture) : std::nullopt;
}

}  // namespace tiltmap
